#!/usr/bin/env python3
"""Fits generated maps and scenes on several processes: time, memory, messages and iterations of the linear solver.

    bench/scale/run.py build/bench/apps/slom                     the table of docs/scale.md
    bench/scale/run.py build/bench/apps/slom --sizes 1000,8000 --processes 1,2 --methods auto,gamg

Needs mpirun, numpy and a slom that was built with -DSLOM_WITH_PETSC=ON. Each fit takes --iterations steps at most, so times per iteration
compare. "iterations" is the mean of a solution. The last five columns are of one iteration: its time, the time of the products with matrices
(multigrid multiplies on each level), operations of the process with most, messages and bytes of all.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

import numpy as np

import container

METHODS = {  # --solver, and options of PETSc
    "auto": ("auto", ""),
    "mumps": ("cholesky", "-slom_matrix assembled"),
    "block-jacobi": ("cg", "-slom_matrix assembled"),
    "block-jacobi-aij": ("cg", "-slom_matrix assembled -mat_type aij"),
    "block-jacobi-baij": ("cg", "-slom_matrix assembled -mat_type baij"),
    "ranges": ("cg", "-slom_matrix assembled -mat_partitioning_type average"),
    "jacobi": ("cg", "-slom_matrix assembled -pc_type pbjacobi"),
    "schwarz": ("cg", "-slom_matrix assembled -pc_type asm -pc_asm_type basic"),
    "gamg": ("cg", "-slom_matrix assembled -pc_type gamg"),
    "free": ("cg", "-slom_matrix free"),
}


def quaternions(vectors):
    """Quaternions x, y, z, w of rotation vectors."""
    angle = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.hstack([vectors * 0.5 * np.sinc(angle / (2 * np.pi)), np.cos(angle / 2)])


def product(a, b):
    ax, ay, az, aw = a.T
    bx, by, bz, bw = b.T
    return np.stack([aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
                     aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz], axis=1)


def rotated(q, v):
    """R(q) v."""
    t = 2 * np.cross(q[:, :3], v)
    return v + q[:, 3:] * t + np.cross(q[:, :3], t)


def inverse(q):
    return q * [-1, -1, -1, 1]


def lattice(file, size, is_shuffled):
    """Writes about `size` poses on a cubic lattice, with edges between neighbours. Shuffled: their ids are in no order."""
    random = np.random.default_rng(1)
    n = round(size ** (1 / 3))
    index = np.arange(n ** 3).reshape(n, n, n)
    position = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), axis=-1).reshape(-1, 3).astype(float)
    rotation = quaternions(random.normal(size=(n ** 3, 3)))
    start_position = position + 0.2 * random.normal(size=position.shape)
    start_rotation = product(rotation, quaternions(0.05 * random.normal(size=position.shape)))
    start_position[0], start_rotation[0] = position[0], rotation[0]
    pairs = np.vstack([np.stack([a.ravel(), b.ravel()], axis=1) for a, b in
                       ((index[:-1], index[1:]), (index[:, :-1], index[:, 1:]), (index[:, :, :-1], index[:, :, 1:]))])
    pairs = pairs[np.argsort(pairs[:, 0], kind="stable")]
    i, j = pairs.T
    seen = rotated(inverse(rotation[i]), position[j] - position[i]) + 0.05 * random.normal(size=(len(i), 3))
    turn = product(product(inverse(rotation[i]), rotation[j]), quaternions(0.02 * random.normal(size=(len(i), 3))))
    information = " ".join(str(v) for v in (400, 0, 0, 0, 0, 0, 400, 0, 0, 0, 0, 400, 0, 0, 0, 2500, 0, 0, 2500, 0, 2500))
    name = random.permutation(n ** 3) if is_shuffled else np.arange(n ** 3)
    with open(file, "w") as out:
        for k, numbers in enumerate(np.hstack([start_position, start_rotation])):
            out.write(f"VERTEX_SE3:QUAT {name[k]} " + " ".join(f"{x:.9g}" for x in numbers) + "\n")
        out.write(f"FIX {name[0]}\n")
        for a, b, numbers in zip(i, j, np.hstack([seen, turn])):
            out.write(f"EDGE_SE3:QUAT {name[a]} {name[b]} " + " ".join(f"{x:.9g}" for x in numbers) + f" {information}\n")
    return f"lattice of {n ** 3} poses, {len(i)} edges"


def write_bal(file, camera, point, turn, centre, start_noise, random):
    """Writes cameras at these centres, turned by these rotation vectors, and points; point p[i] is seen by camera[i]."""
    c, p = camera
    translation = -rotated(quaternions(turn), centre)
    seen = rotated(quaternions(turn[c]), point[p]) + translation[c]
    pixel = -500 * seen[:, :2] / seen[:, 2:] + 0.5 * random.normal(size=(len(c), 2))
    with open(file, "w") as out:
        out.write(f"{len(turn)} {len(point)} {len(c)}\n")
        for row in zip(c, p, pixel[:, 0], pixel[:, 1]):
            out.write("%d %d %.9g %.9g\n" % row)
        for t, r in zip(translation + start_noise * random.normal(size=translation.shape), turn):
            out.write("\n".join(f"{x:.9g}" for x in (*r, *t, 500, 0, 0)) + "\n")
        for x in point + 0.05 * random.normal(size=point.shape):
            out.write("\n".join(f"{v:.9g}" for v in x) + "\n")
    return f"{len(turn)} cameras, {len(point)} points, {len(c)} observations"


def scene(file, observations):
    """Writes a container of a scene with about so many observations: a street with points on both sides, seen from ten cameras each."""
    random = np.random.default_rng(2)
    per_point, per_camera, piece = 10, 2000, 100000
    cameras = max(20, observations // per_camera)
    points = observations // per_point
    camera = np.arange(cameras)
    centre = np.stack([0.5 * camera, 0.2 * random.normal(size=cameras), 0.2 * random.normal(size=cameras)], axis=1)
    turn = 0.03 * random.normal(size=(cameras, 3))
    attitude = quaternions(turn)
    translation = -rotated(attitude, centre)
    out = container.Container(file, container.BUNDLE, [("observation", 2, 2, points * per_point), ("camera", 0, 9, cameras), ("point", 0, 3, points)])
    place = np.sort(random.uniform(0, cameras - per_point + 1, points))
    for begin in range(0, points, piece):
        first = place[begin:begin + piece]
        n = len(first)
        point = np.stack([0.5 * (first + per_point / 2), random.normal(size=n) * 2, -8 - 3 * random.random(n)], axis=1)
        c = (first.astype(int)[:, None] + np.arange(per_point)).ravel()
        p = np.repeat(np.arange(n), per_point)
        seen = rotated(attitude[c], point[p]) + translation[c]
        pixel = -500 * seen[:, :2] / seen[:, 2:] + 0.5 * random.normal(size=(len(c), 2))
        out.add(0, np.stack([c, begin + p], axis=1), pixel)
        out.add(2, None, point + 0.05 * random.normal(size=point.shape))
    start = translation + 0.02 * random.normal(size=translation.shape)
    out.add(1, None, np.hstack([turn, start, np.tile([500.0, 0, 0], (cameras, 1))]))
    out.close()
    return f"scene of {cameras} cameras, {points} points, {points * per_point} observations"


def photographs(file, observations):
    """Writes photographs of one place from all around: each point is seen by six cameras, any of them. So nearly all cameras meet."""
    random = np.random.default_rng(3)
    per_point, per_camera = 6, 200
    cameras, points = max(20, observations // per_camera), observations // per_point
    point = random.normal(size=(points, 3))
    direction = random.normal(size=(cameras, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    axis = np.cross(direction, [0, 0, 1])
    turn = axis * (np.arccos(direction[:, 2]) / np.linalg.norm(axis, axis=1))[:, None]
    c = random.integers(0, cameras // per_point, (points, per_point)) * per_point + np.arange(per_point)  # all different
    return "photographs: " + write_bal(file, (c.ravel(), np.repeat(np.arange(points), per_point)), point, turn, 12 * direction, 0.02,
                                       random)


def fit(slom, kind, file, processes, method, iterations, folder, limit_mb=0):
    result = folder / "result.json"
    result.unlink(missing_ok=True)
    words = [slom, kind, str(file), "--json", str(result), "--max-iterations", str(iterations)]
    words += ["--init", "file"] if kind == "graph" else []
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_mpi_yield_when_idle="1", OMP_NUM_THREADS="1")
    if processes > 0:
        solver, options = METHODS[method]
        environment["PETSC_OPTIONS"] = options + " -log_view -ksp_converged_reason"
        words += ["--solver", solver]
    if limit_mb > 0:
        words = ["sh", "-c", f"ulimit -v {limit_mb * 1000000 // 1024}; exec \"$0\" \"$@\""] + words
    if processes > 0:
        words = ["mpirun", "-n", str(processes)] + words
    begin = time.monotonic()
    run = subprocess.run(words, env=environment, capture_output=True, text=True)
    seconds = time.monotonic() - begin
    if not result.exists():
        return None, run.stderr.strip().splitlines()[:1]
    report = json.loads(result.read_text())
    memory = re.search(r"memory: .* at most (\d+) MB", run.stdout)
    row = {"seconds": seconds, "steps": report["iterations"], "rss": report["final_rss"],
           "memory": int(memory[1]) if memory else round(report["peak_memory_mb"]),
           "solver": report["solver"], "phases": report["seconds"]}
    solves = re.search(r"^KSPSolve +(\d+) +\S+ +(\S+) +\S+ +(\S+)", run.stdout, re.M)
    # Of the event: count, ratio, seconds, ratio, flops, ratio, messages, mean length.
    products = re.search(r"^MatMult +(\d+) +\S+ +(\S+) +\S+ +(\S+) +\S+ +(\S+) +(\S+)", run.stdout, re.M)
    iterations = sum(map(int, re.findall(r"^ *Linear solve .* iterations (\d+)", run.stdout, re.M)))
    if solves and products and iterations > 0:
        row["iterations"] = iterations / max(1, int(solves[1]))
        row["ms"] = 1e3 * float(solves[2]) / iterations
        row["product ms"] = 1e3 * float(products[2]) / iterations
        row["mflop"] = float(solves[3]) / iterations / 1e6
        row["messages"] = float(products[4]) / iterations
        row["kb"] = float(products[4]) * float(products[5]) / iterations / 1e3
    return row, []


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("slom", help="the command")
    parser.add_argument("--kind", default="graph", choices=("graph", "bundle", "photographs"))
    parser.add_argument("--file", help="a file instead of generated ones")
    parser.add_argument("--shuffle", action="store_true", help="give the poses of lattices ids in no order")
    parser.add_argument("--sizes", default="2744,19683", help="poses, or observations")
    parser.add_argument("--processes", default="0,1,2,4", help="0: one process without MPI, the library's own solver")
    parser.add_argument("--methods", default="block-jacobi,gamg", help=", ".join(METHODS))
    parser.add_argument("--iterations", type=int, default=5)
    parser.add_argument("--limit-mb", type=int, default=0, help="address space of each process; 0: no limit")
    arguments = parser.parse_args()
    print("| problem | processes | method | solver | steps | s | MB, most of one | iterations | ms | product ms | Mflop | messages | kB |")
    print("| --- | ---: | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for size in map(int, arguments.sizes.split(",")) if arguments.file is None else [0]:
            file = pathlib.Path(arguments.file or folder / "problem.txt")
            problem = (file.name if arguments.file else
                       lattice(file, size, arguments.shuffle) if arguments.kind == "graph" else
                       (scene if arguments.kind == "bundle" else photographs)(file, size))
            for processes in map(int, arguments.processes.split(",")):
                for method in arguments.methods.split(",") if processes > 0 else ["own"]:
                    row, why = fit(arguments.slom, "graph" if arguments.kind == "graph" else "bundle", file, processes, method,
                                   arguments.iterations, folder, arguments.limit_mb)
                    if row is None:
                        print(f"| {problem} | {processes} | {method} | failed: {why} |", flush=True)
                        continue
                    numbers = [f"{row.get(key, 0):.3g}" for key in ("iterations", "ms", "product ms", "mflop", "messages", "kb")]
                    print(f"| {problem} | {processes or 'without MPI'} | {method} | {row['solver'].split(': ')[-1]} | {row['steps']} | "
                          f"{row['seconds']:.1f} | {row['memory']} | {' | '.join(numbers)} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
