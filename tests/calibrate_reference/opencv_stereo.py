#!/usr/bin/python3
"""Calibrates a stereo camera with OpenCV from two corner files: the reference that `slom calibrate` must reach.

    opencv_stereo.py LEFT_CORNERS.csv RIGHT_CORNERS.csv [--image-size W H] [--fix-k3] [--yaml FILE]

Prints one JSON object:
    rms_px      {"left": x, "right": x}   sqrt(sum of squared corner distances / corners), joint solution [px]
    rms_px_single                         the same of each camera calibrated alone (a bound from below) [px]
    cameras     {"left": {"fx": x, ... "k3": x}, "right": ...}
    rotation, translation                 of right from left: 9 numbers row by row, 3 numbers
    images, corners                       what was used: both cameras' corners of the images that both see
OpenCV wants the same corners from both cameras, so corners that one of them lacks in an image are left out.

--fix-k3 keeps k3 = 0 (the model opencv4). --yaml FILE reads the file with OpenCV's FileStorage and prints, in
"yaml", the matrices and numbers found at its top level and in its maps, instead of calibrating: the check that
OpenCV reads what slom writes. (LEFT and RIGHT are not needed then.)

Needs Debian's python3-opencv, hence Debian's python3: call it with /usr/bin/python3. Exit code 3 when OpenCV
is not installed.
"""

import argparse
import csv
import json
import math
import sys

try:
    import cv2
    import numpy as np
except ImportError as missing:
    print(f"opencv_stereo.py: {missing}; install Debian's python3-opencv", file=sys.stderr)
    sys.exit(3)

# Iterate to the optimum of double precision; OpenCV's own default of 30 steps stops before it.
CRITERIA = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 2000, 1e-15)
PARAMETERS = ["k1", "k2", "p1", "p2", "k3"]


def read_corners(path):
    """{image: {world point: pixel}}."""
    images = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            world = tuple(float(row[f"world_{axis}_m"]) for axis in "xyz")
            images.setdefault(row["image"], {})[world] = (float(row["u_px"]), float(row["v_px"]))
    return images


def common_views(left, right):
    """For each image that both cameras see: world points and both cameras' pixels, in the same order."""
    views = []
    for image in sorted(left.keys() & right.keys(), key=int):
        points = sorted(left[image].keys() & right[image].keys())
        if len(points) >= 4:
            views.append((
                np.array(points, np.float32),
                np.array([left[image][p] for p in points], np.float32),
                np.array([right[image][p] for p in points], np.float32),
            ))
    return views


def intrinsics(matrix, distortion):
    values = {"fx": matrix[0, 0], "fy": matrix[1, 1], "cx": matrix[0, 2], "cy": matrix[1, 2]}
    return values | dict(zip(PARAMETERS, distortion.ravel()[:5].tolist()))


def calibrate(options):
    views = common_views(read_corners(options.left), read_corners(options.right))
    if not views:
        sys.exit("opencv_stereo.py: no image is seen by both cameras")
    world, left, right = (list(part) for part in zip(*views))
    size = tuple(options.image_size)
    flags = cv2.CALIB_FIX_K3 if options.fix_k3 else 0

    single = {}
    start = []
    for name, pixels in (("left", left), ("right", right)):
        rms, matrix, distortion, _, _ = cv2.calibrateCamera(world, pixels, size, None, None, flags=flags,
                                                            criteria=CRITERIA)
        single[name] = rms
        start += [matrix, distortion]

    flags |= cv2.CALIB_USE_INTRINSIC_GUESS
    rms, K1, d1, K2, d2, R, T, _, _, view_rms = cv2.stereoCalibrateExtended(
        world, left, right, *start, size, np.eye(3), np.zeros((3, 1)), flags=flags, criteria=CRITERIA)

    corners = np.array([len(points) for points in world])
    squares = (view_rms**2 * corners[:, None]).sum(axis=0)
    # view_rms must belong to the solution returned: OpenCV's overall figure says whether it does.
    if abs(math.sqrt(squares.sum() / (2 * corners.sum())) - rms) > 1e-6 * rms:
        sys.exit(f"opencv_stereo.py: errors per view do not add up to the overall error {rms}")
    joint = np.sqrt(squares / corners.sum())
    return {
        "rms_px": {"left": joint[0], "right": joint[1]},
        "rms_px_single": single,
        "cameras": {"left": intrinsics(K1, d1), "right": intrinsics(K2, d2)},
        "rotation": R.ravel().tolist(),
        "translation": T.ravel().tolist(),
        "images": len(views),
        "corners": int(corners.sum()),
    }


def read_yaml(path):
    """What cv::FileStorage finds in the file: {key: number, text, list of rows of a matrix, or a map of these}."""

    def value(node):
        if node.isMap():
            matrix = node.mat() if {"rows", "cols", "dt", "data"} <= set(node.keys()) else None
            return matrix.tolist() if matrix is not None else {key: value(node.getNode(key)) for key in node.keys()}
        if node.isSeq():
            return [value(node.at(index)) for index in range(node.size())]
        return node.string() if node.isString() else node.real()

    storage = cv2.FileStorage(path, cv2.FILE_STORAGE_READ)
    if not storage.isOpened():
        sys.exit(f"opencv_stereo.py: OpenCV cannot read {path}")
    return {"yaml": {key: value(storage.getNode(key)) for key in storage.root().keys()}}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("left", nargs="?")
    parser.add_argument("right", nargs="?")
    parser.add_argument("--image-size", type=int, nargs=2, default=(640, 480), metavar=("W", "H"))
    parser.add_argument("--fix-k3", action="store_true")
    parser.add_argument("--yaml")
    options = parser.parse_args()
    if options.yaml is None and options.right is None:
        parser.error("give two corner files, or --yaml FILE")
    print(json.dumps(read_yaml(options.yaml) if options.yaml else calibrate(options), indent=2))


if __name__ == "__main__":
    main()
