#!/usr/bin/python3
"""Finds chessboard corners in a stereo camera's images and writes one CSV file per camera.

It made data/opencv_stereo from OpenCV's sample images:

    apt-get download opencv-doc && dpkg -x opencv-doc_*.deb opencv-doc
    scripts/detect_corners.py opencv-doc/usr/share/doc/opencv-doc/examples/data data/opencv_stereo

Images are <camera><number>.jpg. With --pictures FOLDER each image is also written there with its corners drawn
in their order, from red to blue, to look at. Needs Debian's python3-opencv (that is why the first line names
Debian's python3).
"""

import argparse
import pathlib
import re
import sys

import cv2
import numpy as np

HEADER = "image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px"


def detect(image, columns, rows, half_window):
    """Corners in board order, an array (columns * rows, 2) of pixels, or None where the board is not found."""
    found, corners = cv2.findChessboardCorners(image, (columns, rows))
    if not found:
        return None
    # Stop at 1e-4 px: far below the noise of the corners, so that the result does not depend on the start.
    criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-4)
    corners = cv2.cornerSubPix(image, corners, (half_window, half_window), (-1, -1), criteria)
    return corners.reshape(-1, 2)


def rows_of(image_number, corners, columns, square_size):
    """The CSV lines of one image. World: board frame, x along a row of corners, z = 0."""
    for index, (u, v) in enumerate(corners):
        x, y = (index % columns) * square_size, (index // columns) * square_size
        yield f"{image_number},{index + 1},{x:.6g},{y:.6g},0,{u:.4f},{v:.4f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("images", type=pathlib.Path, help="folder with the images")
    parser.add_argument("output", type=pathlib.Path, help="folder for <camera>_corners.csv")
    parser.add_argument("--cameras", nargs="+", default=["left", "right"])
    parser.add_argument("--columns", type=int, default=9, help="corners in a row of the board")
    parser.add_argument("--rows", type=int, default=6, help="rows of corners")
    parser.add_argument("--square-size", type=float, default=0.025, help="side of a square [m]")
    parser.add_argument("--half-window", type=int, default=5, help="cornerSubPix window, half its side [px]")
    parser.add_argument("--pictures", type=pathlib.Path, help="folder for the images with corners drawn")
    options = parser.parse_args()

    for camera in options.cameras:
        lines = [HEADER]
        files = sorted(options.images.glob(f"{camera}[0-9]*.jpg"))
        if not files:
            sys.exit(f"detect_corners: no image {camera}<number>.jpg in {options.images}")
        for file in files:
            image = cv2.imread(str(file), cv2.IMREAD_GRAYSCALE)
            corners = detect(image, options.columns, options.rows, options.half_window)
            if corners is None:
                print(f"{file.name}: the board was not found, image left out")
                continue
            number = int(re.search(r"(\d+)$", file.stem).group(1))
            lines += rows_of(number, corners, options.columns, options.square_size)
            if options.pictures:
                options.pictures.mkdir(parents=True, exist_ok=True)
                picture = cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
                board = corners.reshape(-1, 1, 2).astype(np.float32)
                cv2.drawChessboardCorners(picture, (options.columns, options.rows), board, True)
                cv2.imwrite(str(options.pictures / file.with_suffix(".png").name), picture)
        output = options.output / f"{camera}_corners.csv"
        output.write_text("\n".join(lines) + "\n")
        print(f"{output}: {len(lines) - 1} corners in {len(files)} images")


if __name__ == "__main__":
    main()
