#!/usr/bin/python3
"""Projection uncertainty against mrcal's, on the corners of a real stereo camera, with the same lens model and noise.

    mrcal_test.py SLOM DATA

mrcal 2 follows the rig's frame by the mean of all boards' motions in space, this project (and mrcal from 3.0 on) by how the boards
are seen. The former is noisier, which shows in the middle of the image, where all else is small; at the border, where the lens is
extrapolated, both must be equal. Exit code 77: skipped, because mrcal is not there.
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    import mrcal
    import numpy as np
except ImportError:
    print("skipped: needs Debian's python3-mrcal")
    sys.exit(77)

SLOM, DATA = sys.argv[1], pathlib.Path(sys.argv[2]) / "opencv_stereo"
CAMERAS, SIGMA_PX, WIDTH, HEIGHT, SQUARE_M, COLUMNS, ROWS = ["left", "right"], 0.25, 640, 480, 0.025, 9, 6
LENS = ["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"]


def slom_result():
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "result.json"
        cameras = [word for name in CAMERAS for word in ["--camera", f"{name}={DATA / (name + '_corners.csv')}"]]
        subprocess.run([SLOM, "calibrate", "--quiet", *cameras, "--sigma-px", str(SIGMA_PX), "--json", str(file)], check=True)
        return json.loads(file.read_text())


def observations(images):
    """Corners as mrcal wants them: (views, rows, columns, u v weight), and the (image, camera, extrinsics) of each view."""
    views, indices = [], []
    for camera, name in enumerate(CAMERAS):
        seen = {}
        for row in csv.DictReader((DATA / (name + "_corners.csv")).open()):
            view = seen.setdefault(int(row["image"]), np.full((ROWS, COLUMNS, 3), -1.0))
            view[round(float(row["world_y_m"]) / SQUARE_M), round(float(row["world_x_m"]) / SQUARE_M)] = [float(row["u_px"]), float(row["v_px"]), 1]
        for image, view in seen.items():
            views.append(view)
            indices.append((images.index(image), camera, camera - 1))
    order = sorted(range(len(views)), key=lambda i: indices[i])
    return np.array([views[i] for i in order]), np.array([indices[i] for i in order], dtype=np.int32)


def rt(rotation, translation):
    return mrcal.rt_from_Rt(np.vstack((rotation, translation)))


def optimization_inputs(result):
    boards, indices = observations([image["image"] for image in result["images"]])
    right = result["cameras"]["right"]["pose_from_left"]
    frames = []
    for image in result["images"]:
        R = np.array(image["left2world"]["rotation"]).reshape(3, 3)
        frames.append(rt(R.T, -R.T @ image["left2world"]["translation"]))
    return {
        "lensmodel": "LENSMODEL_OPENCV5",
        "intrinsics": np.array([[result["cameras"][name]["parameters"][p]["value"] for p in LENS] for name in CAMERAS]),
        "extrinsics_rt_fromref": rt(np.array(right["rotation"]).reshape(3, 3), right["translation"])[None, :],
        "frames_rt_toref": np.array(frames),
        "points": None, "observations_point": None, "indices_point_camintrinsics_camextrinsics": None,
        "observations_board": boards, "indices_frame_camintrinsics_camextrinsics": indices,
        "imagersizes": np.array([[WIDTH, HEIGHT]] * 2, dtype=np.int32),
        "calobject_warp": None, "calibration_object_spacing": SQUARE_M,
        "do_optimize_intrinsics_core": True, "do_optimize_intrinsics_distortions": True, "do_optimize_extrinsics": True,
        "do_optimize_frames": True, "do_optimize_calobject_warp": False, "do_apply_regularization": False,
        "do_apply_outlier_rejection": False, "verbose": False,
    }


def main():
    result = slom_result()
    inputs = optimization_inputs(result)
    ours = inputs["intrinsics"].copy()
    inputs["intrinsics"][:, :2] *= 1.002  # must come back
    mrcal.optimize(**inputs)  # in place
    std = [[result["cameras"][name]["parameters"][p]["std"] for p in LENS] for name in CAMERAS]
    difference = (np.abs(inputs["intrinsics"] - ours) / std).max()
    print(f"mrcal's lens parameters differ by {difference:.1e} standard deviations at most")
    assert difference < 1e-2
    for camera, name in enumerate(CAMERAS):
        quality = result["quality"]["cameras"][name]
        columns, rows = quality["grid"]["columns"], quality["grid"]["rows"]
        pixels = np.array([[(WIDTH - 1) * (i % columns) / (columns - 1), (HEIGHT - 1) * (i // columns) / (rows - 1)] for i in range(columns * rows)])
        model = mrcal.cameramodel(optimization_inputs=inputs, icam_intrinsics=camera)
        rays = mrcal.unproject(pixels, *model.intrinsics(), normalize=True)
        for own in quality["projection_stated"]:
            distance = own["distance_m"]
            theirs = mrcal.projection_uncertainty(rays * (distance or 1), model=model, atinfinity=distance is None,
                                                  what="worstdirection-stdev", observed_pixel_uncertainty=SIGMA_PX)
            ours = np.array(own["std_px"])
            ratio = ours / theirs
            where = "infinity" if distance is None else f"{distance:.2f} m"
            print(f"{name:6} {where:9} worst: slom {ours.max():.3f}, mrcal {theirs.max():.3f} px; median: slom {np.median(ours):.4f}, "
                  f"mrcal {np.median(theirs):.4f} px; slom / mrcal from {ratio.min():.2f} to {ratio.max():.2f}")
            assert abs(ours.max() / theirs.max() - 1) < 0.01
            assert ratio.max() < 1.05
            assert ratio[theirs > 1].min() > 0.95


if __name__ == "__main__":
    main()
