#!/usr/bin/env python3
"""Measures fits from Python beside the command `slom`, SciPy, CasADi, JAX, SymForce and GTSAM, on one thread. Prints Markdown.

    PYTHONPATH=build/py/python python bench/python/fits.py --command SLOM --tape BENCH_TAPE [--json FILE]

Programs take turns. Each run has a process of its own; the least time of the rounds counts. A peer that is not
installed is left out: pip install scipy casadi jax symforce gtsam. Without --command and --tape their numbers are absent."""
import argparse
import json
import os
import re
import subprocess
import sys
import time

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.realpath(__file__))
DATA = os.path.join(HERE, "..", "..", "..", "shared", "data")
BAL = "problem-49-7776-pre"
TOLERANCES = ["1e-5", "1e-12"]  # of bundles: the command's, and one that only the limit of 100 iterations precedes
OTHERS = ["scipy", "casadi", "jax", "symforce", "gtsam"]
JOBS = ["graph:sphere2500", "graph:intel", *(f"bundle:{BAL},{t}" for t in TOLERANCES), "small", "million", "circle"]
PEERS = ["scipy:circle:lsmr", "scipy:circle:exact", "scipy:intel:numeric", "scipy:intel:by hand", "casadi:intel", "jax:intel", "symforce:intel",
         "gtsam:sphere2500:custom", "gtsam:sphere2500:between"]


def in_process(job, data):
    if job.split(":")[0] in OTHERS:
        import by_others as module
    else:
        import by_slom as module
    print(json.dumps(module.job(job, data)))


def output(command, allowed=(0,)):
    environment = os.environ | {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")}
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    if done.returncode in allowed:
        return json.loads(done.stdout)
    print(f"left out: {' '.join(command)}: {(done.stderr.strip().splitlines() or ['no message'])[-1]}", file=sys.stderr)
    return None


def by_python(job, data):
    return output([sys.executable, os.path.realpath(__file__), "--job", job, "--data", data])


def by_command(program, job, data):
    from problems import path_of

    kind, name = job.split(":")
    name, *tolerance = name.split(",")
    options = ["--init", "file"] if kind == "graph" else ["--tolerance", *tolerance, "--max-iterations", "100"]
    start = time.perf_counter()
    result = output([program, kind, path_of(data, name), *options, "--threads", "1", "--quiet", "--json", "-"], (0, 1))
    if result is None:
        return None
    trace = result["trace"]
    return {"fit": trace[-1]["seconds"], "rss": result["final_rss"], "start_rss": result["initial_rss"],
            "iterations": result["iterations"], "begin": trace[0]["seconds"], "process": time.perf_counter() - start,
            "phases": result["seconds"]}


def least(runs):
    """Returns the run with the least time of fitting, with the least of each time that it has."""
    runs = [run for run in runs if run]
    if not runs:
        return None
    best = dict(min(runs, key=lambda run: run.get("fit", run.get("wall", run.get("seconds", 0)))))
    for key in ("insert", "process", "wall", "seconds", "begin"):
        if key in best:
            best[key] = min(run[key] for run in runs)
    return best


def ms(seconds):
    return f"{1e3 * seconds:.3g}" if seconds < 1 else f"{1e3 * seconds:.0f}"


def table(head, rows):
    print("| " + " | ".join(head) + " |\n|" + "|".join("---" if k < 2 else "---:" for k in range(len(head))) + "|")
    for row in rows:
        print("| " + " | ".join(str(x) for x in row) + " |")
    print()


def tables(results):
    rows = []
    for job in JOBS[: 2 + len(TOLERANCES)]:
        a, b = results[job], results.get("command:" + job)
        name = job.split(":")[1].replace(",", ", ")
        rows.append([name, "Python", *columns(a), ms(a["insert"]), "", "", ""])
        if b:
            each = [(run["fit"] - run["begin"]) / run["iterations"] for run in (a, b)]
            rows[-1][-3:] = [f"{a['fit'] / b['fit']:.2f}", f"{each[0] / each[1]:.2f}", f"{a['rss'] / b['rss'] - 1:.1e}"]
            rows.append(["", "command", *columns(b), ms(b["phases"]["setup"]), "", "", ""])
    table(["problem", "program", "before the first step ms", "fit ms", "iterations", "final cost", "insertion ms",
           "fit: Python / command", "iteration: Python / command", "cost: Python / command - 1"], rows)
    million = results["million"]
    print(f"* Insertion of 10^6 scalar measurements from arrays: {million['insert']:.3g} s. Their fit: "
          f"{million['seconds']:.3g} s, {million['iterations']} iterations. "
          f"The whole `optimize()`: {million['wall']:.3g} s.")
    print("* From the first `measure` to the end of the first iteration, 20 points, new process: "
          f"{ms(results['small']['seconds'])} ms.\n")
    rows = []
    for job in ["circle", *PEERS[:2], "graph:intel", *PEERS[2:7], "graph:sphere2500", *PEERS[7:]]:
        run = results.get(job)
        if not run:
            continue
        words = job.split(":")
        if job not in PEERS:
            own = run
            name, program = words[-1], "SLoM"
        else:
            name, program = words[1], " ".join([words[0], *words[2:]])
        total, own_total = (x["wall"] + x.get("insert", 0) for x in (run, own))
        rows.append([name, program, ms(run["insert"]) if "insert" in run else "–", ms(run["wall"]), run["iterations"],
                     f"{run['rss']:.10g}", f"{total / own_total:.3g}"])
    table(["problem", "program", "insertion ms", "`optimize()` ms", "iterations", "final cost", "both / SLoM"], rows)


def columns(run):
    return [ms(run["begin"]), ms(run["fit"]), run["iterations"], f"{run['rss']:.10g}"]


def tape_table(program):
    text = subprocess.run([program], capture_output=True, text=True, check=True).stdout
    number = r"\(\s*([\d.]+)\)"
    pattern = rf"(.+?)  +plain .*?{number}.*packs .*?{number}.*tape .*?{number}"
    rows = [(name, *found) for name, *found in re.findall(pattern, text)]
    rows = [[*row, f"{float(row[3]) / float(row[1]):.2f}", f"{float(row[3]) / float(row[2]):.2f}"] for row in rows]
    table(["measurement", "plain ns", "packs ns", "tape ns", "tape / plain", "tape / packs"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", metavar="FILE", help="the program slom")
    parser.add_argument("--tape", metavar="FILE", help="the program bench_tape")
    parser.add_argument("--data", default=DATA, help="folder with posegraph and bal; default: %(default)s")
    parser.add_argument("--rounds", type=int, default=5, help="default: %(default)s")
    parser.add_argument("--json", metavar="FILE", help="all runs")
    parser.add_argument("--job", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.job:
        return in_process(given.job, given.data)
    runs = {}
    start = os.getloadavg()[0]
    for n in range(given.rounds):
        for job in [*JOBS, *PEERS]:
            if job in PEERS and (n > 1 or (n > 0 and not runs[job][0])):
                continue  # peers take long: two rounds
            runs.setdefault(job, []).append(by_python(job, given.data))
            if given.command and job.startswith(("graph", "bundle")):
                runs.setdefault("command:" + job, []).append(by_command(given.command, job, given.data))
    if given.json:
        with open(given.json, "w") as file:
            json.dump(runs, file, indent=1)
    tables({job: least(own) for job, own in runs.items()})
    if given.tape:
        tape_table(given.tape)
    print(f"Load of the machine: {start:.2f} at the start, {os.getloadavg()[0]:.2f} at the end.")


if __name__ == "__main__":
    main()
