"""Files of other programs: pose graphs and bundle adjustments."""

import os
from typing import Any, Dict, Optional, Tuple, Union

import numpy as np

from ._manifold import manifold
from ._slom import SE2, SE3, SO2, Estimator, Loss, Rows, VariableArray, _read_bal, _read_g2o

Path = Union[str, "os.PathLike[str]"]


class Edges:
    """Measurements between nodes, one a row.

    i, j              indices of poses; of sightings and bearings, j are indices of landmarks
    measured          what was measured: Rows of poses, or an array
    information       inverse covariances (m, k, k) as in the file: translation first, in the frame of j; [m, rad]
    information_in_i  of edges, in the frame of i: that of the error (i^-1 j) [-] measured, which est.measure computes
    """

    i: np.ndarray
    j: np.ndarray
    measured: Any
    information: np.ndarray
    information_in_i: np.ndarray

    def __init__(self, parts: Dict[str, Any], like: Any = None) -> None:
        self.__dict__.update(parts)
        if like is not None:
            self.measured = Rows(self.measured, like=like)

    def __len__(self) -> int:
        return len(self.i)

    def __repr__(self) -> str:
        return f"<{len(self)} measurements of {_shape(self.measured)}>"


class PosePriors(Edges):
    """Measurements of poses in the world, one a row.

    offsets               Rows of poses: where the sensor sits on the pose i
    measured              Rows of poses: world_T_sensor
    information_in_world  information of the error (i * offset) [-] measured, whose translation is in the frame of the world
    """

    offsets: Rows
    information_in_world: np.ndarray

    def __init__(self, parts: Dict[str, Any], like: Any) -> None:
        super().__init__(parts, like)
        self.offsets = Rows(parts["offsets"], like=like)


class PoseGraph:
    """A map of poses and landmarks, in the plane or in space.

    poses           Rows of SE2 or SE3: world_T_pose
    ids             their numbers in the file
    fixed           True for poses that keep their values. If the file has neither lines FIX nor priors, it is the first
    landmarks       (n, 2) or (n, 3); landmark_ids, landmark_fixed
    edges           Edges from pose to pose: i_T_j
    sightings       Edges from pose to landmark: the landmark in the frame of the pose
    bearings        Edges from pose to landmark, in the plane: angles [rad]
    pose_priors     PosePriors: poses in the world
    position_priors Edges without j: positions of poses in the world
    warnings        sentences on lines that were skipped, and on sensors that the file does not place
    """

    def __init__(self, file: str, parts: Dict[str, Any]) -> None:
        pose = SE2 if parts["dim"] == 2 else SE3
        self.file = file
        self.poses = Rows(parts["poses"]["values"], like=pose)
        self.ids, self.fixed = parts["poses"]["ids"], parts["poses"]["fixed"].astype(bool)
        self.landmarks = parts["landmarks"]["values"]
        self.landmark_ids, self.landmark_fixed = parts["landmarks"]["ids"], parts["landmarks"]["fixed"].astype(bool)
        self.edges = Edges(parts["edges"], pose)
        self.sightings = Edges(parts["sightings"])
        self.bearings = Edges(parts["bearings"], SO2)
        self.pose_priors = PosePriors(parts["pose_priors"], pose)
        self.position_priors = Edges(parts["position_priors"])
        self.warnings = parts["warnings"]

    def estimator(self, loss: Optional[Loss] = None) -> Tuple[Estimator, VariableArray, VariableArray]:
        """Returns an estimator with all measurements, whose errors are those of the command `slom graph`, and the variables
        of poses and of landmarks. Those that are `fixed` keep their values."""
        est = Estimator()
        poses = _variables(est, self.poses, "pose", self.fixed)
        landmarks = _variables(est, self.landmarks, "landmark", self.landmark_fixed)

        def measure(f, name, edges, information, *arguments):
            if len(edges):
                noise = {} if loss is None else {"loss": loss}
                est.measure(f, *arguments, measured=edges.measured, information=information, name=name, **noise)

        e, s, b, x, p = self.edges, self.sightings, self.bearings, self.pose_priors, self.position_priors
        measure(lambda a, b: a.inverse() * b, "edge", e, e.information_in_i, poses[e.i], poses[e.j])
        measure(lambda a, p: a.inverse() * p, "sighting", s, s.information, poses[s.i], landmarks[s.j])
        measure(_bearing, "bearing", b, b.information, poses[b.i], landmarks[b.j])
        measure(lambda x, o: x * o, "prior", x, x.information_in_world, poses[x.i], x.offsets)
        measure(lambda x: x.pos, "position prior", p, p.information, poses[p.i])
        return est, poses, landmarks

    def __repr__(self) -> str:
        place = "in the plane" if isinstance(self.poses[0], SE2) else "in space"
        counts = ((name, len(getattr(self, name))) for name in _COUNTED)
        return f"<pose graph {place}, {self.file}: {', '.join(f'{n} {name}' for name, n in counts if n)}>"


_COUNTED = ("poses", "landmarks", "edges", "sightings", "bearings", "pose_priors", "position_priors")


def _bearing(pose, landmark):
    p = pose.inverse() * landmark
    return SO2(np.arctan2(p[1], p[0]))


def _variables(est, values, name, fixed):
    variables = est.variables(values, name)
    variables[fixed].fix()
    return variables


def _shape(values):
    return repr(values) if isinstance(values, Rows) else f"shape {np.shape(values)}"


@manifold
class BalCamera:
    """A camera of "Bundle adjustment in the large". It looks along -z.

    pose  cam_T_world
    lens  focal length f [px], distortion k1, k2
    """

    pose: SE3
    lens: np.ndarray

    def project(self, point):
        """Returns the pixel of a point in the world, from the centre of the image, v upwards."""
        p = self.pose * point
        u = -p[:2] / p[2]
        r2 = u @ u
        f, k1, k2 = self.lens
        return f * (1 + r2 * (k1 + r2 * k2)) * u


class Bundle:
    """A bundle adjustment: cameras, points, and the pixels where cameras see points.

    cameras  Rows of slom.BalCamera: cameras.pose, cameras.lens
    points   (n, 3), in the world
    i, j     camera and point of each observation
    pixels   (m, 2), from the centre of the image, v upwards [px]
    """

    def __init__(self, file: str, parts: Dict[str, Any]) -> None:
        self.file = file
        self.cameras = Rows(parts["cameras"], like=BalCamera(SE3(), np.zeros(3)))  # type: ignore[call-arg]
        self.points, self.pixels = parts["points"], parts["pixels"]
        self.i, self.j = parts["i"], parts["j"]

    def estimator(self, loss: Optional[Loss] = None) -> Tuple[Estimator, VariableArray, VariableArray]:
        """Returns an estimator with all observations, with a standard deviation of 1 px and the algorithm of the command
        `slom bundle`, and the variables of cameras and of points. Place, rotation and scale of the whole are free."""
        est = Estimator()
        cameras, points = est.variables(self.cameras, "camera"), est.variables(self.points, "point")
        noise: Dict[str, Any] = {} if loss is None else {"loss": loss}
        seen = cameras[self.i], points[self.j]
        est.measure(BalCamera.project, *seen, measured=self.pixels, name="observation", **noise)
        est.use_algorithm("lm", memory=0.1)
        return est, cameras, points

    def __repr__(self) -> str:
        counts = f"{len(self.cameras)} cameras, {len(self.points)} points, {len(self.pixels)} observations"
        return f"<bundle adjustment, {self.file}: {counts}>"


def read_g2o(file: Path, init: Optional[str] = None) -> PoseGraph:
    """Reads a pose graph of g2o or TORO.

    init  where poses and landmarks start: "file", "odometry", "spanning-tree", "chordal", "build-up", or "auto" for the
          one with the lowest cost. Without it, at the values of the file, or, if it has none, as with "auto"
    """
    name = os.fspath(file)
    return PoseGraph(name, _read_g2o(name, init))


def read_bal(file: Path) -> Bundle:
    """Reads a bundle adjustment of "Bundle adjustment in the large", plain or compressed by bzip2."""
    name = os.fspath(file)
    return Bundle(name, _read_bal(name))
