"""Writes the corners of a table as cv::FileStorage does: file_storage.py corners.csv folder

sample.xml, .yml and .json have the keys of OpenCV's calibration sample, hand.xml, .yml and .json a matrix for each image. Exit code 3: no OpenCV.
"""
import csv
import sys

try:
    import cv2
    import numpy
except ImportError:
    print("needs Debian's python3-opencv", file=sys.stderr)
    sys.exit(3)

COLUMNS, ROWS, SQUARE = 9, 6, 0.025
views = {}
for row in csv.DictReader(open(sys.argv[1], encoding="utf-8")):
    place = round(float(row["world_y_m"]) / SQUARE), round(float(row["world_x_m"]) / SQUARE)
    views.setdefault(int(row["image"]), {})[place] = float(row["u_px"]), float(row["v_px"])
points = numpy.array([[view[r, c] for r in range(ROWS) for c in range(COLUMNS)] for view in views.values()])
board = numpy.array([[c * SQUARE, r * SQUARE, 0] for r in range(ROWS) for c in range(COLUMNS)])
for ending in ("xml", "yml", "json"):
    sample = cv2.FileStorage(f"{sys.argv[2]}/sample.{ending}", cv2.FileStorage_WRITE)
    for key, value in (("image_width", 640), ("image_height", 480), ("board_width", COLUMNS), ("board_height", ROWS),
                       ("square_size", SQUARE), ("camera_matrix", numpy.eye(3)), ("image_points", points)):
        sample.write(key, value)
    sample.writeComment("written by a test")
    sample.release()
    hand = cv2.FileStorage(f"{sys.argv[2]}/hand.{ending}", cv2.FileStorage_WRITE)
    for key, entries in (("imagePoints", [view.reshape(-1, 1, 2) for view in points]), ("objectPoints", [board] * len(points)),
                         ("image_list", [f"shots/left{image:02}.jpg" for image in views])):
        hand.startWriteStruct(key, cv2.FileNode_SEQ)
        for entry in entries:
            hand.write("", entry)
        hand.endWriteStruct()
    hand.release()
