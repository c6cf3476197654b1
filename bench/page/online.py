"""The section on fits that follow their data, from what bench_online wrote."""
from .tables import digits, ms, table

TEXT = """Poses are inserted in their order, with the edges to earlier ones and the landmarks they see, one fit after each; one thread, insertion included. `update()` is the fit that
follows its data ([online.md](online.md)), `optimizeStep()` one step of everything after each pose, and Ceres, for pose graphs, fits everything from
the last values after each tenth pose, its building of the problem not counted. `ratio` is the time of `optimizeStep()` / that of `update()`."""


def replay(file, method):
    """The replay whose method begins so; None if there is none."""
    return next((r for r in file["replays"] if r["method"].startswith(method)), None)


def size(value, unit):
    """Two digits with an exponent."""
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
    """Markdown, without the heading."""
    files = online["files"]
    load = online.get("load")
    alone = [f"Measured in a run of its own, with a load of the machine of {load['before']:.2f} when it began and {load['after']:.2f} when it ended."] if load else []
    return "\n\n".join([
        TEXT, *alone, times_table(files),
        "How good the values are: RSS / batch RSS - 1, and the root mean square distance of the positions to those of the batch optimum; the largest of "
        "those at each hundredth pose. `by optimize()` counts the calls of `update()` that `optimize()` took over.",
        accuracy_table(files),
        "What else is asked after each update: values, whose reading is one access to memory each, the covariance of the newest pose by "
        "`updatedCovariance`, and the covariances of all variables by `updatedMarginals`, after each of the last hundred poses; `marginals()` linearises and factorises everything for them, here after the last hundredth pose. Memory is what the process "
        "has resident.", costs_table(files)])
