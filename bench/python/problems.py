"""The problems of fits.py, read with NumPy."""
import os

import numpy as np


class Graph:
    """A pose graph: rows of `poses` are x, y, angle or x, y, z, qx, qy, qz, qw; edges go from poses i to poses j. The
    information is that of the error t_ab - t_z in the frame of a, as in the command."""


def read_graph(path):
    vertices, edges = [], []
    with open(path) as lines:
        for line in lines:
            words = line.split()
            if words and words[0].startswith("VERTEX"):
                vertices.append(words[1:])
            elif words and words[0].startswith("EDGE"):
                edges.append(words[1:])
    vertices, edges = np.array(vertices, float), np.array(edges, float)
    graph = Graph()
    width = vertices.shape[1] - 1
    m = 3 if width == 3 else 6
    graph.poses = np.ascontiguousarray(vertices[:, 1:])
    index = {int(vertex): k for k, vertex in enumerate(vertices[:, 0])}
    graph.i, graph.j = (np.array([index[int(k)] for k in edges[:, c]]) for c in (0, 1))
    graph.measured = np.ascontiguousarray(edges[:, 2 : 2 + width])
    graph.information = np.zeros((len(edges), m, m))
    upper = np.triu_indices(m)
    graph.information[:, upper[0], upper[1]] = edges[:, 2 + width :]
    graph.information[:, upper[1], upper[0]] = edges[:, 2 + width :]
    turn = np.tile(np.eye(m), (len(edges), 1, 1))
    n = m // 3 + 1
    turn[:, :n, :n] = rotations(graph.measured)
    graph.information = turn @ graph.information @ turn.transpose(0, 2, 1)
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


class Bundle:
    """Rows of `cameras` are x, y, z, qx, qy, qz, qw, f, k1, k2."""


def read_bundle(path):
    with open(path) as file:
        cameras, points, observations = map(int, file.readline().split())
        numbers = np.array(file.read().split(), float)
    bundle = Bundle()
    seen, rest = numbers[: 4 * observations].reshape(-1, 4), numbers[4 * observations :]
    bundle.i, bundle.j = seen[:, 0].astype(int), seen[:, 1].astype(int)
    bundle.pixels = np.ascontiguousarray(seen[:, 2:])
    rows = rest[: 9 * cameras].reshape(-1, 9)
    angle = np.linalg.norm(rows[:, :3], axis=1)[:, None]
    axis = rows[:, :3] * np.sinc(angle / (2 * np.pi)) / 2
    bundle.cameras = np.hstack([rows[:, 3:6], axis, np.cos(angle / 2), rows[:, 6:]])
    bundle.points = np.ascontiguousarray(rest[9 * cameras :].reshape(-1, 3))
    return bundle


def circle(n=100000):
    """Returns points of a circle with noise of 0.1."""
    rng = np.random.default_rng(1)
    angles = rng.uniform(0, 2 * np.pi, n)
    return np.array([1.0, 2.0]) + 3 * np.array([np.cos(angles), np.sin(angles)]).T + 0.1 * rng.normal(size=(n, 2))


def path_of(data, name):
    return os.path.join(data, "bal" if name.startswith("problem") else "posegraph",
                        name + (".txt" if name.startswith("problem") else ".g2o"))
