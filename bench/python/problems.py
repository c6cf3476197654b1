"""The problems of fits.py."""
import os

import numpy as np
import slom


class Graph:
    """A pose graph: rows of `poses` are x, y, angle or x, y, z, qx, qy, qz, qw; edges go from poses i to poses j. The
    information is that of the error t_ab - t_z in the frame of a, as in the command."""


def read_graph(path):
    file, graph = slom.read_g2o(path), Graph()
    graph.poses, graph.measured = file.poses.numbers, file.edges.measured.numbers
    graph.i, graph.j, graph.information = file.edges.i, file.edges.j, file.edges.information_in_i
    return graph


def rotations(poses):
    if poses.shape[1] == 3:
        c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        return np.array([[c, -s], [s, c]]).transpose(2, 0, 1)
    x, y, z, w = (poses[:, 3:] / np.linalg.norm(poses[:, 3:], axis=1)[:, None]).T
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.array(rows).transpose(2, 0, 1)


def circle(n=100000):
    """Returns points of a circle with noise of 0.1."""
    rng = np.random.default_rng(1)
    angles = rng.uniform(0, 2 * np.pi, n)
    return np.array([1.0, 2.0]) + 3 * np.array([np.cos(angles), np.sin(angles)]).T + 0.1 * rng.normal(size=(n, 2))


def path_of(data, name):
    return os.path.join(data, "bal" if name.startswith("problem") else "posegraph",
                        name + (".txt" if name.startswith("problem") else ".g2o"))
