"""The command as functions, and the readers of files: beside the command's own output, on the data of the repository and,
if SLOM_SHARED_DATA names their folder, on those of the benchmarks."""

import copy
import json
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np

import slom
from slom import _command

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT / "data"
SHARED = Path(os.environ.get("SLOM_SHARED_DATA") or "/nonexistent")
STEREO = DATA / "opencv_stereo"
RIG = DATA / "simulated_stereo_imu"
TOWN = DATA / "simulated_pose_graph/town.g2o"
SCENE = DATA / "simulated_bundle/scene.txt"
NETWORK = DATA / "saved_problem/network.slom"
LOOP = "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\nEDGE_SE2 2 0 -2.1 0 0 1 0 0 1 0 1\n"
HAS_COMMAND = _command.PROGRAM.exists()


def has_readers():
    try:
        return bool(slom.read_g2o(TOWN))
    except slom.Error as error:
        if error.id != "slom.no-readers":
            raise
        return False


def shared(name):
    """Returns a file of the shared data, or skips the test."""
    file = SHARED / name
    if not file.exists():
        raise unittest.SkipTest(f"needs {name} in the folder SLOM_SHARED_DATA")
    return file


def by_command(*arguments):
    """Returns the JSON and the report that the command writes."""
    with tempfile.TemporaryDirectory() as folder:
        command = [_command.PROGRAM, *map(str, arguments), "--json", f"{folder}/result.json"]
        done = subprocess.run(command, capture_output=True, text=True)
        text = (done.stdout + done.stderr).replace(f"written: {folder}/result.json\n", "")
        return json.loads(Path(folder, "result.json").read_text()), text.rstrip()


def without_times(data):
    if isinstance(data, dict):
        return {key: without_times(x) for key, x in data.items() if key not in ("seconds", "peak_memory_mb")}
    return [without_times(x) for x in data] if isinstance(data, list) else data


class Checks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def written(self, name, text):
        file = self.folder / name
        file.write_text(text)
        return file

    def refused(self, text, f, *arguments, kind=slom.Error, **options):
        with self.assertRaises(kind) as raised:
            f(*arguments, **options)
        self.assertEqual(str(raised.exception), text)
        return raised.exception


@unittest.skipUnless(HAS_COMMAND, "the package was built without the command")
class Calibrate(Checks):
    def test_is_what_the_command_writes(self):
        corners = [RIG / "left_corners.csv", RIG / "right_corners.csv"]
        report = self.folder / "report.html"
        result = slom.calibrate(*corners, imu=RIG / "imu.csv", report=report)
        cameras = ["--camera", f"left={corners[0]}", "--camera", f"right={corners[1]}"]
        data, text = by_command("calibrate", *cameras, "--imu", RIG / "imu.csv", "--report", report)
        self.assertEqual(without_times(result.json), without_times(data))
        self.assertEqual(str(result), text)
        self.assertEqual((result.exit_code, result.converged), (0, True))
        self.assertIn("<html", report.read_text())

        parameters = result.cameras.left.parameters
        self.assertEqual(parameters.fx.value, data["cameras"]["left"]["parameters"]["fx"]["value"])
        self.assertEqual(parameters.value.shape, (9,))
        self.assertEqual(parameters.std[0], parameters.fx.std)
        self.assertEqual(result.rms_px.left, result.json["rms_px"]["left"])
        pose = result.cameras.right.pose_from_left
        np.testing.assert_allclose(pose.se3.orient.matrix(), pose.rotation, atol=1e-15)
        np.testing.assert_array_equal(pose.se3.pos, data["cameras"]["right"]["pose_from_left"]["translation"])
        self.assertEqual(pose.std.shape, (6,))
        self.assertTrue(np.isnan(result.cameras.left.pose_from_left.dof).all())
        self.assertEqual(len(result.images.left2world.se3), len(result.images))
        self.assertEqual(result.images.left2world.translation.shape, (12, 3))
        self.assertEqual(result.images.acc_error.dtype, float)
        self.assertEqual(result.images.image[0], 1)
        self.assertEqual(result.imu.acc_bias.shape, (3,))
        self.assertEqual(result.clustered.covariance.shape, (31, 31))
        self.assertEqual(result.verdict.level, "trustworthy")
        self.assertIn("verdict: trustworthy", result._repr_html_())
        self.assertIsNone(result.board)

    def test_names_and_options(self):
        result = slom.calibrate(
            camera={"a": STEREO / "left_corners.csv", "b": STEREO / "right_corners.csv"},
            fix={"k3": 0, "a.p1": None},
            bound={"b.k2": (-1.5, np.float64(1))},
            image_size={"a": (640, 480)},
            exclude=[1, "b.2"],
            max_iterations=np.int64(50),
            intrinsics="opencv5",
            json=self.folder / "result.json",
            quiet=True,
        )
        self.assertEqual(list(result.cameras), ["a", "b"])
        self.assertEqual(result.cameras.b.parameters.k3.value, 0)
        self.assertEqual(result.cameras.a.image_size.tolist(), [640, 480])
        self.assertEqual([e["image"] for e in result.cameras.b.excluded], [1, 2])
        self.assertEqual(json.loads((self.folder / "result.json").read_text()), result.json)
        self.assertEqual(str(result), "slom calibrate: converged, exit code 0")

    def test_values_without_a_name(self):
        result = slom.calibrate(STEREO / "left_corners.csv", quiet=True)
        with self.assertRaisesRegex(AttributeError, "there is no parametres; there are parameters"):
            result.cameras.left.parametres
        with self.assertRaises(AttributeError):
            result.nothing
        self.assertFalse(hasattr(result, "__array__"))
        self.assertIn("rms_px", dir(result))
        again = pickle.loads(pickle.dumps(result))
        self.assertEqual(again.json, copy.deepcopy(result).json)
        self.assertEqual(again.cameras.left.parameters.fx.std, result.cameras.left.parameters.fx.std)

    def test_a_failed_fit_is_a_result(self):
        result = slom.calibrate(STEREO / "left_corners.csv", max_iterations=1)
        self.assertEqual((result.exit_code, result.converged), (1, False))
        self.assertIn("iteration", result.message)

    def test_mono(self):
        file = shared("mono/corners.csv")
        result = slom.calibrate(camera={"left": file}, quiet=True)
        data, _ = by_command("calibrate", "--camera", f"left={file}")
        self.assertEqual(without_times(result.json), without_times(data))

    def test_photographs(self):
        """Files of a camera, in a list. The module that finds boards lies where the command looks for it."""
        photos = [shared(f"reports/charuco_5x8_given_for_8x5/l0{k}.jpg") for k in (0, 2, 4, 6, 8)]
        try:
            result = slom.calibrate(images={"left": photos}, board="charuco:8x5:4x4_50", square=0.035, marker=0.02625)
        except slom.Error as error:
            if "built without" not in error.sentence:
                raise
            self.skipTest(error.sentence)
        self.assertAlmostEqual(result.cameras.left.parameters.fx.value, 620, delta=3)

    def test_bad_input(self):
        error = self.refused(
            "[slom.bad-input] /nowhere.csv: cannot be read (No such file or directory); check the path",
            slom.calibrate,
            Path("/nowhere.csv"),
        )
        self.assertEqual((error.id, error.subject), ("slom.bad-input", "/nowhere.csv"))
        self.assertEqual(error.remedy, "check the path")
        error = self.refused(
            "[slom.bad-option] slom.calibrate has no argument intrinsic; pass intrinsics",
            slom.calibrate,
            intrinsic=1,
            kind=TypeError,
        )
        self.assertIsInstance(error, slom.Error)
        self.refused(
            "[slom.bad-option] camera is passed beside corner files; pass all of them by camera",
            slom.calibrate,
            "a.csv",
            camera={"b": "b.csv"},
        )
        self.refused(
            "[slom.bad-option] sigma_px is True, but it needs a value; pass the value", slom.calibrate, sigma_px=True
        )
        self.refused("[slom.bad-option] quiet is 'yes'; pass True or False", slom.calibrate, quiet="yes")


@unittest.skipUnless(HAS_COMMAND, "the package was built without the command")
class Graph(Checks):
    def test_is_what_the_command_writes(self):
        fitted = self.folder / "fitted.g2o"
        result = slom.graph(TOWN, hold_parts=True, plot=self.folder / "town.svg")
        data, text = by_command("graph", TOWN, "--hold-parts", "--plot", self.folder / "town.svg", "--output", fitted)
        self.assertEqual(without_times(result.json), without_times(data))
        self.assertEqual(str(result), text.replace(f"written: {fitted}\n", ""))
        self.assertEqual(len(result.poses), 400)
        self.assertIsInstance(result.poses[0], slom.SE2)
        np.testing.assert_array_equal(result.poses.numbers, slom.read_g2o(fitted).poses.numbers)
        np.testing.assert_array_equal(result.trace.rss, [step["rss"] for step in data["trace"]])
        self.assertEqual(result.seconds.total, result.json["seconds"]["total"])
        self.assertIn("warnings", dir(result))

    def test_output_of_the_callers(self):
        result = slom.graph(TOWN, output=self.folder / "own.g2o", init="chordal", threads=1)
        self.assertIn(f"written: {self.folder}/own.g2o", result.report)
        np.testing.assert_array_equal(result.poses.numbers, slom.read_g2o(self.folder / "own.g2o").poses.numbers)

    def test_a_failed_fit_has_no_poses(self):
        result = slom.graph(TOWN, max_iterations=1, output=self.written("old.g2o", LOOP), init="odometry")
        self.assertEqual((result.exit_code, result.poses, result.landmarks), (1, None, None))

    def test_bad_input(self):
        bad = self.written("bad map.g2o", LOOP + "EDGE_SE2 2 x\n")
        error = self.refused(f"[slom.bad-input] {self.complaint('graph', bad)}", slom.graph, bad)
        self.assertTrue(error.subject.startswith(f"{bad}:4"), error.subject)
        error = self.refused(
            "[slom.bad-option] --init fil: unknown start; give auto, file, odometry, spanning-tree, chordal or build-up",
            slom.graph,
            TOWN,
            init="fil",
        )
        self.assertEqual(error.subject, "--init")

    def complaint(self, *arguments):
        done = subprocess.run([_command.PROGRAM, *map(str, arguments)], capture_output=True, text=True)
        return done.stderr.strip().removeprefix("slom: ")

    def test_many_threads(self):
        """The interpreter is free while the command runs."""
        results = [None] * 3
        def fit(k):
            results[k] = slom.graph(TOWN, threads=1)
        threads = [threading.Thread(target=fit, args=(k,)) for k in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual({r.final_rss for r in results}, {results[0].final_rss})


@unittest.skipUnless(HAS_COMMAND, "the package was built without the command")
class BundleAndReplay(Checks):
    def test_bundle(self):
        cloud = self.folder / "cloud.ply"
        result = slom.bundle(SCENE, output=cloud)
        self.assertEqual(without_times(result.json), without_times(by_command("bundle", SCENE, "--output", cloud)[0]))
        self.assertEqual(result.points.shape, (100, 3))
        self.assertEqual(result.cameras.lens.shape, (6, 3))
        self.assertTrue(cloud.exists())
        est, _, _ = result.fitted.estimator()
        self.assertAlmostEqual(est.rss / result.final_rss, 1, places=9)

    def test_replay(self):
        result = slom.replay(NETWORK, diagnose=True)
        self.assertEqual(without_times(result.json), without_times(by_command("replay", NETWORK)[0]))
        self.assertEqual((result.estimator, result.variables), (None, None))  # of types that Python cannot read
        est = slom.Estimator()
        x = est.variable(1.0, "x")
        est.measure(lambda x, p: x * x - p, x, np.array([2.0, 2.1]))
        est.save(self.folder / "root.slom")
        result = slom.replay(self.folder / "root.slom")
        est.optimize()
        self.assertAlmostEqual(result.variables["x"].value, x.value, places=12)
        again, variables = slom.read_archive(self.folder / "root.slom")
        self.assertEqual(list(variables), ["x"])


@unittest.skipUnless(HAS_COMMAND, "the package was built without the command")
class Process(Checks):
    def test_console_script(self):
        code = "import sys; sys.argv = ['slom', *sys.argv[1:]]; from slom._command import main; main()"
        script = [sys.executable, "-c", code]
        run = lambda *words: subprocess.run([*script, *map(str, words)], capture_output=True, text=True)
        self.assertRegex(run("--version").stdout, r"^slom \d+\.\d+\.\d+, kernels: ")
        self.assertEqual(run("graph", "/nowhere").returncode, 2)
        self.assertIn("Converged", run("graph", TOWN).stdout)

    def test_interrupt_ends_the_command(self):
        """Ctrl-C ends the child at once. It reads a pipe that never ends."""
        pipe = self.folder / "endless.g2o"
        os.mkfifo(pipe)
        code = f"import slom\ntry: slom.graph({str(pipe)!r})\nexcept KeyboardInterrupt: print('interrupted')"
        process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
        writer = os.open(pipe, os.O_WRONLY)  # waits for the command to read
        os.write(writer, LOOP.encode())
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.communicate(timeout=20)[0], "interrupted\n")
        with self.assertRaises(BrokenPipeError):  # nobody reads any longer
            os.write(writer, LOOP.encode())
        os.close(writer)

    def test_missing_program(self):
        program = _command.PROGRAM
        _command.PROGRAM = self.folder / "slom"
        try:
            error = self.refused(
                f"[slom.no-command] the program slom is not at {self.folder}/slom, because the package was built without "
                "it; install the libraries that docs/start/install.md lists for the command, and build the package again",
                slom.graph,
                TOWN,
            )
        finally:
            _command.PROGRAM = program
        self.assertEqual(error.id, "slom.no-command")

    def test_killed_program(self):
        program = _command.PROGRAM
        _command.PROGRAM = self.written("slom", '#!/bin/sh\n[ "$2" = --help ] && echo "  --json FILE  x" || kill -9 $$\n')
        _command.PROGRAM.chmod(0o755)
        try:
            complaint = "[slom.command-failed] slom graph ended by signal 9 and no message; please report it"
            self.refused(complaint, slom.graph, TOWN)
        finally:
            _command.PROGRAM = program
            _command._options.cache_clear()


@unittest.skipUnless(has_readers(), "the package was built without slom::io")
class Readers(Checks):
    def test_graph(self):
        graph = slom.read_g2o(TOWN)
        self.assertEqual((len(graph.poses), len(graph.edges)), (400, 458))
        self.assertEqual(graph.edges.information.shape, (458, 3, 3))
        self.assertEqual(np.flatnonzero(graph.fixed).tolist(), [0])
        self.assertIn("400 poses, 458 edges", repr(graph))
        e = graph.edges
        a, b = graph.poses[int(e.i[7])], graph.poses[int(e.j[7])]
        self.assertEqual((a.inverse() * b).boxminus(e.measured[7]).shape, (3,))
        est, poses, landmarks = graph.estimator()
        self.assertEqual((len(poses), len(landmarks)), (400, 0))
        self.assertTrue(est.optimize().converged)

    def costs(self, file, init="file"):
        """Compares the final cost with that of the command."""
        est, poses, _ = slom.read_g2o(file, init).estimator()
        fit = est.optimize()
        self.assertTrue(fit.converged)
        self.assertTrue(all(kind.derivatives == "exact" for kind in fit.kinds))
        if HAS_COMMAND:
            result = slom.graph(file, init=init)
            self.assertAlmostEqual(fit.final_rss / result.final_rss, 1, delta=1e-9)
            np.testing.assert_allclose(poses.value.pos, result.poses.pos, atol=1e-3)

    def test_costs_of_graphs_are_the_commands(self):
        self.costs(TOWN, "chordal")
        for name in ("intel", "sphere2500", "parking-garage"):
            self.costs(shared(f"posegraph/{name}.g2o"))

    def test_all_kinds_of_lines(self):
        """Landmarks, bearings, priors and FIX in the plane, priors of a sensor and landmarks in space; each information
        is full."""
        full3 = "2 0.1 0.2 3 0.3 4"
        plane = (
            "VERTEX_SE2 3 0 0 0.1\nVERTEX_SE2 5 1 0.2 0.3\nVERTEX_SE2 9 2 0.5 0.7\n"
            "VERTEX_XY 4 2 2\nVERTEX_XY 18446744073709551615 1 -2\n"
            f"EDGE_SE2 3 5 1 0.1 0.2 {full3}\nEDGE_SE2 5 9 1.1 0.2 0.3 {full3}\nEDGE_SE2 3 9 2.1 0.3 0.6 {full3}\n"
            "EDGE_SE2_XY 3 4 2.2 1.8 3 0.5 2\nEDGE_SE2_XY 9 4 0.9 1.6 3 0.5 2\n"
            "EDGE_SE2_XY 5 18446744073709551615 0.1 -2 3 0.5 2\n"
            "EDGE_BEARING_SE2_XY 9 18446744073709551615 -2.5 40\nEDGE_BEARING_SE2_XY 5 4 0.8 50\n"
            f"EDGE_PRIOR_SE2 5 1.05 0.2 0.3 {full3}\nEDGE_PRIOR_SE2_XY 9 2.1 0.4 5 1 6\n"
        )
        file = self.written("plane.g2o", plane + "VERTEX_CAM 1 2\n")
        graph = slom.read_g2o(file)
        self.assertFalse(graph.fixed.any())
        self.assertEqual(graph.landmark_ids.tolist(), [4, 2**64 - 1])
        self.assertEqual(graph.bearings.measured[0].angle, -2.5)
        self.assertEqual(graph.warnings, ["skipped 1 line with the unknown tag VERTEX_CAM"])
        self.costs(file)
        self.costs(self.written("fixed.g2o", plane + "FIX 3\nFIX 9\n"))
        est, poses, _ = slom.read_g2o(self.folder / "fixed.g2o").estimator()
        est.optimize()
        np.testing.assert_array_equal(poses.value.pos[[0, 2]], [[0, 0], [2, 0.5]])

        rows = [" ".join(["1"] + ["0.1"] * (5 - k)) for k in range(6)]
        full6, full = " ".join(rows).replace("1 ", "3 ", 1), "1 0.1 0.2 2 0.3 3"
        turn = "0.1 0.2 -0.1 0.9"
        space = (
            f"PARAMS_SE3OFFSET 7 0.1 0.2 0.3 {turn}\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 {turn}\n"
            f"VERTEX_TRACKXYZ 2 1 1 1\nEDGE_SE3:QUAT 0 1 1.1 0.1 0 {turn} {full6}\n"
            f"EDGE_SE3_TRACKXYZ 0 2 7 1 1 1.2 {full}\nEDGE_SE3_TRACKXYZ 1 2 7 0.1 1 1.2 {full}\n"
            f"EDGE_SE3_PRIOR 0 7 0.1 0.3 0.3 {turn} {full6}\nEDGE_SE3_PRIOR 1 8 1 0 0.1 0.1 0.2 0 1 {full6}\n"
        )
        graph = slom.read_g2o(self.written("space.g2o", space))
        self.assertEqual(graph.pose_priors.offsets.pos.tolist(), [[0.1, 0.2, 0.3], [0, 0, 0]])
        self.assertEqual(len(graph.warnings), 1)
        self.costs(self.folder / "space.g2o")

    def test_starts(self):
        graph = slom.read_g2o(self.written("edges.g2o", LOOP))
        np.testing.assert_allclose(graph.poses[1].pos, [1, 0], atol=0.2)  # found, as the file has none
        best = slom.read_g2o(TOWN, init="auto").poses.numbers
        np.testing.assert_array_equal(slom.read_g2o(TOWN).poses.numbers, best)
        starts = ("auto", "odometry", "spanning-tree", "chordal")
        costs = {init: slom.read_g2o(TOWN, init=init).estimator()[0].rss for init in starts}
        self.assertEqual(min(costs.values()), costs["auto"])
        if HAS_COMMAND:
            for init, cost in costs.items():
                self.assertAlmostEqual(cost / slom.graph(TOWN, init=init).initial_rss, 1, places=9)
        self.refused(
            '[slom.bad-option] init is "best"; pass "auto", "file", "odometry", "spanning-tree", "chordal" or "build-up"',
            slom.read_g2o,
            TOWN,
            init="best",
        )
        edges = self.folder / "edges.g2o"
        complaint = f'[slom.bad-option] init is "file", but {edges} has no vertices; drop the argument'
        self.refused(complaint, slom.read_g2o, edges, init="file")

    def test_bundle(self):
        scene = slom.read_bal(SCENE)
        self.assertEqual((len(scene.cameras), scene.points.shape, scene.pixels.shape), (6, (100, 3), (491, 2)))
        self.assertIn("6 cameras, 100 points, 491 observations", repr(scene))
        camera = scene.cameras[int(scene.i[0])]
        self.assertLess(np.abs(camera.project(scene.points[scene.j[0]]) - scene.pixels[0]).max(), 100)

    def test_costs_of_bundles_are_the_commands(self):
        for file in (SCENE, shared("bal/problem-49-7776-pre.txt")):
            est, _, _ = slom.read_bal(file).estimator()
            fit = est.optimize(decrease_tolerance=1e-5, deviation_tolerance=np.inf)
            self.assertEqual(fit.kinds[0].derivatives, "exact")
            if HAS_COMMAND:
                result = slom.bundle(file)
                self.assertAlmostEqual(fit.final_rss / result.final_rss, 1, delta=1e-9)
                self.assertEqual(fit.iterations, result.iterations)
        packed = shared("bal/problem-93-61203-pre.txt.bz2")
        self.assertEqual(len(slom.read_bal(packed).points), 61203)

    def test_losses(self):
        robust, _, _ = slom.read_g2o(TOWN).estimator(loss=slom.Huber(1.345))
        cost = robust.optimize().final_rss
        if HAS_COMMAND:
            self.assertAlmostEqual(cost / slom.graph(TOWN, robust="huber:1.345").final_rss, 1, places=9)
        self.assertTrue(slom.read_bal(SCENE).estimator(loss=slom.Huber(1.0))[0].optimize().converged)

    def test_bad_files(self):
        bad = self.written("bad.g2o", LOOP + "EDGE_SE2 2 x\n")
        with self.assertRaises(slom.Error) as raised:
            slom.read_g2o(bad)
        self.assertEqual((raised.exception.id, raised.exception.subject), ("slom.io.bad-line", f"{bad}:4"))
        self.assertIn(f"{bad}:4: ", str(raised.exception))
        with self.assertRaises(slom.Error) as raised:
            slom.read_bal(self.written("bad.txt", "1 1 1\n0 5 1.0 2.0\n"))
        self.assertEqual(raised.exception.subject, f"{self.folder}/bad.txt:2")
        for read in (slom.read_g2o, slom.read_bal):
            with self.assertRaises(slom.Error) as raised:
                read("/nowhere")
            self.assertEqual(raised.exception.id, "slom.io.cannot-read")
        with self.assertRaises(slom.Error):
            slom.read_g2o(self.written("indefinite.g2o", "EDGE_SE2 0 1 1 0 0 -1 0 0 1 0 1\n")).estimator()


if __name__ == "__main__":
    unittest.main()
