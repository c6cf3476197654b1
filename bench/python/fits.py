#!/usr/bin/env python3
"""Measures fits from Python beside the command `slom`, SciPy, CasADi and GTSAM, on one thread, and prints tables in Markdown.

    PYTHONPATH=build/py/python python bench/python/fits.py --command build/release/apps/slom [--json FILE]

Programs take turns. Each run has a process of its own; the least time of the rounds counts. A peer that is not installed is left
out: pip install scipy casadi gtsam. Without --command its columns are absent."""
import argparse
import json
import os
import subprocess
import sys
import time

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.realpath(__file__))
DATA = os.path.join(HERE, "..", "..", "..", "shared", "data")
BAL = "problem-49-7776-pre"
TOLERANCES = ["1e-5", "1e-12"]  # of bundles: the command's, and one that only the limit of 100 iterations precedes
OTHERS = ["scipy", "casadi", "gtsam"]
JOBS = ["graph:sphere2500", "graph:intel", *(f"bundle:{BAL},{t}" for t in TOLERANCES), "small", "million", "circle"]
PEERS = ["scipy:circle:lsmr", "scipy:circle:exact", "scipy:intel:numeric", "scipy:intel:by hand", "casadi:intel",
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
    print("| " + " | ".join(head) + " |\n|" + "|".join("---" if k == 0 else "---:" for k in range(len(head))) + "|")
    for row in rows:
        print("| " + " | ".join(str(x) for x in row) + " |")
    print()


def tables(results):
    rows = []
    for job in JOBS[: 2 + len(TOLERANCES)]:
        a, b = results[job], results.get("command:" + job)
        row = [job.split(":")[1].replace(",", ", tolerance "), ms(a["insert"]), ms(a["begin"]), ms(a["fit"]), ms(a["wall"]), a["iterations"]]
        if b:
            each = lambda run: (run["fit"] - run["begin"]) / run["iterations"]  # noqa: E731
            row += [ms(b["begin"]), ms(b["fit"]), b["iterations"], f"{a['fit'] / b['fit']:.2f}", f"{each(a) / each(b):.2f}",
                    f"{a['rss'] / b['rss'] - 1:.1e}"]
        rows.append(row)
    table(["problem", "insertion ms", "before the first step ms", "fit ms", "`optimize()` ms", "iterations", "command: before the first step ms",
           "fit ms", "iterations", "fit: Python / command", "iteration: Python / command", "final cost: Python / command - 1"][: len(rows[0])],
          rows)
    million = results["million"]
    print(f"* Insertion of 10^6 scalar measurements from arrays: {million['insert']:.3g} s. Their fit: {million['wall']:.3g} s, "
          f"{million['iterations']} iterations.")
    print(f"* From the first `measure` to the end of the first iteration, 20 points, new process: {ms(results['small']['seconds'])} ms.\n")
    rows = []
    for job in ["circle", *PEERS[:2], "graph:intel", *PEERS[2:5], "graph:sphere2500", *PEERS[5:]]:
        run = results.get(job)
        if not run:
            continue
        is_peer = job in PEERS
        own = own if is_peer else run
        words = job.split(":")
        name, program = (words[1], " ".join([words[0], *words[2:]])) if is_peer else (words[-1], "SLoM")
        both = run["wall"] + run.get("insert", 0)
        rows.append([name, program, ms(run["insert"]) if "insert" in run else "–", ms(run["wall"]), run["iterations"], f"{run['rss']:.9g}",
                     f"{both / (own['wall'] + own['insert']):.3g}"])
    table(["problem", "program", "insertion ms", "fit ms", "iterations", "final cost", "insertion and fit / SLoM"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", metavar="FILE", help="the program slom")
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
    print(f"Load of the machine: {start:.2f} at the start, {os.getloadavg()[0]:.2f} at the end.")


if __name__ == "__main__":
    main()
