"""What the command does, as functions."""

import html
import json
import os
import re
import tempfile
from pathlib import Path
from typing import Any, Dict, List, Optional

import numpy as np

from . import _command
from ._error import Error
from ._files import Bundle, PoseGraph, read_bal, read_g2o
from ._files import Path as PathLike
from ._record import Record
from ._slom import Estimator, Rows, Variable, load


class Result:
    """What a run of the command found. The keys of its JSON are attributes, with arrays in place of lists.

    json       the JSON as it is: a dict
    report     the report as text, which print(result) shows
    exit_code  0: success; 1: the fit did not converge or is not determined, or the data contradict each other
    """

    def __init__(self, command: str, exit_code: int, json: Record, report: str) -> None:
        self.command, self.exit_code, self.json, self.report = command, exit_code, json, report

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "json":
            raise AttributeError(name)
        return getattr(self.json, name)

    def __getitem__(self, key: str) -> Any:
        return self.json[key]

    def __dir__(self) -> List[str]:
        return [*super().__dir__(), *self.json]

    def __str__(self) -> str:
        how = "converged" if self.json.get("converged") else "not converged"
        return self.report or f"slom {self.command}: {how}, exit code {self.exit_code}"

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(str(self))}</pre>"


class Calibration(Result):
    """A calibration. cameras.NAME.parameters.fx.value, .std; cameras.NAME.parameters.value, all of them;
    cameras.NAME.pose_from_REFERENCE.se3; images.left2world.se3; verdict.level, .sentence, .doubts. All keys:
    docs/calibrate/json.md."""

    @property
    def verdict(self) -> Any:
        """How far the calibration can be trusted."""
        return self.quality.verdict


class GraphFit(Result):
    """A fitted pose graph. `fitted` is the slom.PoseGraph; None if the fit failed."""

    fitted: Optional[PoseGraph]

    @property
    def poses(self) -> Optional[Rows]:
        return self.fitted.poses if self.fitted else None

    @property
    def landmarks(self) -> Optional[np.ndarray]:
        return self.fitted.landmarks if self.fitted else None


class BundleFit(Result):
    """A fitted bundle adjustment. `fitted` is the slom.Bundle; None if the fit failed."""

    fitted: Optional[Bundle]

    @property
    def cameras(self) -> Optional[Rows]:
        return self.fitted.cameras if self.fitted else None

    @property
    def points(self) -> Optional[np.ndarray]:
        return self.fitted.points if self.fitted else None


class Replay(Result):
    """A fitted problem of a file. `estimator` and `variables` are those of slom.load; None if the fit failed, or if a C++
    program saved types that slom.load cannot read."""

    estimator: Optional[Estimator]
    variables: Optional[Dict[str, Variable]]


def calibrate(*files: PathLike, **options: Any) -> Calibration:
    """Calibrates cameras, and an IMU on their rig: the command `slom calibrate`.

        result = slom.calibrate("left_corners.csv", "right_corners.csv", report="report.html")
        result = slom.calibrate(images={"left": "left*.jpg"}, board="9x6", square=0.025)

    files    corner files, named after their cameras: left_corners.csv is of the camera left
    camera   the same with names of your own: {"left": "a.csv"}
    report   file for the page that shows how far to trust the calibration

    All options of the command are keyword arguments, with _ in place of -: `slom calibrate --help-all` lists them. Flags
    take True; options that are repeated take a list, or a dict of NAME=VALUE."""
    if len(files) == 1 and isinstance(files[0], (list, tuple)):  # as of glob
        files = tuple(files[0])
    if files:
        if options.get("camera"):
            raise Error("[slom.bad-option] camera is passed beside corner files; pass all of them by camera", "camera")
        options["camera"] = [f"{_camera(file)}={os.fspath(file)}" for file in files]
    code, data, report, _ = _run("calibrate", [], options)
    return Calibration("calibrate", code, data, report)


def graph(file: PathLike, **options: Any) -> GraphFit:
    """Fits a pose graph of a file of g2o or TORO: the command `slom graph`. The options are those of the command."""
    code, data, report, fitted = _run("graph", [file], options, "fitted.g2o", read_g2o)
    result = GraphFit("graph", code, data, report)
    result.fitted = fitted
    return result


def bundle(file: PathLike, **options: Any) -> BundleFit:
    """Fits cameras and points of a BAL file: the command `slom bundle`. The options are those of the command."""
    code, data, report, fitted = _run("bundle", [file], options, "fitted.txt", read_bal)
    result = BundleFit("bundle", code, data, report)
    result.fitted = fitted
    return result


def replay(file: PathLike, **options: Any) -> Replay:
    """Fits a problem that Estimator.save or slom::Archive wrote: the command `slom replay`. The options are those of the
    command."""
    code, data, report, fitted = _run("replay", [file], options, "fitted.slom", _loaded)
    result = Replay("replay", code, data, report)
    result.estimator, result.variables = fitted or (None, None)
    return result


def _loaded(file):
    try:
        return load(file)
    except Error:
        return None


def _camera(file):
    return re.sub(r"_?corners$", "", Path(file).stem) or "camera"


def _run(command, files, options, own_output=None, read=None):
    """Runs the command. Returns exit code, JSON, report, and what `read` makes of its output; None if there is none."""
    with tempfile.TemporaryDirectory(prefix="slom-") as folder:
        json_file = options.pop("json", None) or os.path.join(folder, "result.json")
        output = options.get("output")
        if own_output and (output is None or command == "bundle"):
            others = [] if output is None else list(output) if isinstance(output, (list, tuple)) else [output]
            output = os.path.join(folder, own_output)
            options = {**options, "output": [*others, output] if others else output}
        before = _command.state(output) if read else None
        code, report = _command.run(command, files, {**options, "json": json_file})
        lines = [line for line in report.splitlines() if not line.startswith(f"written: {folder}")]
        with open(json_file, encoding="utf-8") as stream:
            data = json.load(stream, object_hook=Record)
        is_written = read and _command.state(output) != before  # an older file is none of this run's
        return code, data, "\n".join(lines).rstrip(), read(output) if is_written else None
