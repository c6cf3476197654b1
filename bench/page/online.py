"""The section on fits that follow their data, from the output of bench_online."""
from .tables import digits, ms, table

TEXT = """Poses are inserted in their order, with the edges to earlier poses and the landmarks they see. One fit follows each pose. Times are for one thread and include the insertion.

* `update()` is the fit that follows its data ([online.md](online.md)).
* `optimizeStep()` makes one step of everything after each pose.
* Ceres, for pose graphs, fits everything from the last values after each tenth pose. The time to build its problem does not count.

`ratio` is the time of `optimizeStep()` divided by the time of `update()`."""


def replay(file, method):
    """Returns the replay whose method begins with this text; None if there is none."""
    return next((r for r in file["replays"] if r["method"].startswith(method)), None)


def size(value, unit):
    """Writes a number with two digits and an exponent."""
    return "–" if value is None else f"{value:.1e}{unit}"


def times_table(files):
    rows = []
    for file in files:
        own, steps = replay(file, "update()"), replay(file, "optimizeStep()")
        for r in file["replays"]:
            first = r is file["replays"][0]
            rows.append([file["file"] if first else "", f"{file['poses']}, {file['edges']}" if first else "", r["method"], digits(r["total"]),
                         f"{steps['total'] / own['total']:.1f} x" if first and steps else "",
                         ms(r["median"]), ms(r["p99"]), ms(r["worst"]), ms(r["worst_at_closures"])])
    return table(["file", ">poses, edges", "fit", ">total s", ">ratio", ">median ms", ">99 % ms", ">worst ms", ">at closures ms"], rows)


def accuracy_table(files):
    rows = []
    for file in files:
        for r in file["replays"]:
            first = r is file["replays"][0]
            rows.append([file["file"] if first else "", r["method"], f"{r['rss']:.8g}", size(r["largest_gap"], ""),
                         size(r["largest_position_error"], " m"), str(r["by_optimize"]) if first else ""])
    return table(["file", "fit", ">RSS at the end", ">largest gap", ">largest position error", ">by optimize()"], rows)


def costs_table(files):
    rows = []
    for file in files:
        own = replay(file, "update()")
        marginals = [c["marginals"] for c in own["checks"] if "marginals" in c]
        memory = file.get("memory")
        rows.append([file["file"], ms(own["read_newest"] / own["fits"]), ms(own["read_all"] / own["fits"]),
                     ms(own["covariance"]["median"]), ms(own["covariance"]["worst"]), ms(own["marginals"]["median"]), ms(own["marginals"]["worst"]), ms(marginals[-1]) if marginals else "–",
                     digits(memory["after_one"] / 1e6) if memory else "–",
                     digits(memory["after_all"] / 1e6) if memory else "–"])
    return table(["file", ">read the newest pose ms", ">read all ms", ">covariance of the newest ms", ">worst", ">all marginals ms", ">worst", ">by `marginals()` ms",
                  ">memory after one replay MB", ">after ten"], rows)


def section(online):
    """Returns the section as Markdown, without the heading."""
    files = online["files"]
    load = online.get("load")
    alone = [f"This was measured in a run of its own. The load of the machine was {load['before']:.2f} at its start and {load['after']:.2f} at its end."] if load else []
    return "\n\n".join([
        TEXT, *alone, times_table(files),
        "The next table shows how good the values are. The gap is RSS / batch RSS - 1. The position error is the root mean square distance of the positions "
        "from the batch optimum. Both are computed at each hundredth pose, and the largest value is given. `by optimize()` counts the calls of `update()` that "
        "`optimize()` took over.",
        accuracy_table(files),
        "The last table shows the cost of questions after an update: to read values, which is one access to memory each; the covariance of the newest pose by "
        "`updatedCovariance`; and the covariances of all variables by `updatedMarginals`, after each of the last hundred poses. For comparison, `marginals()` "
        "linearises and factorises everything, here after the last hundredth pose. Memory is the resident memory of the process.", costs_table(files)])
