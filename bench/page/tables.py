"""Tables of the results page."""
from . import facts


def table(header, rows):
    """Returns a Markdown table. Columns whose header begins with `>` are numbers."""
    names = [h.lstrip(">") for h in header]
    lines = ["| " + " | ".join(names) + " |", "|" + "|".join("---:" if h.startswith(">") else "---" for h in header) + "|"]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines)


def digits(value, count=3):
    """Writes a number with `count` significant digits, without exponent; a dash if it is unknown."""
    if value is None:
        return "–"
    text = f"{float(f'{value:.{count}g}'):f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def ms(seconds):
    return digits(None if seconds is None else 1e3 * seconds)


def times(value):
    return "–" if value is None else digits(value, 3 if value < 100 else 2) + " x"


def rss(value):
    return f"{value:.10g}"


def per_program(comparisons):
    """Returns times, iterations, memory and cost of every program on every problem."""
    rows = []
    for c in comparisons:
        for r in c["programs"]:
            first = r is c["programs"][0]
            name = f"{c['problem']}" if first else ""
            if "failure" in r:
                rows.append([name, r["program"], r["failure"]] + [""] * 8)
                continue
            rows.append([name, r["program"], ms(r["build"]), ms(r["setup"]), ms(r["iteration"]), str(r["iterations"]),
                         ms(r["to_1e-3"]), ms(r["to_1e-6"]), ms(r["total"]), digits(r["memory"] / 1e6), rss(r["final_rss"])])
    return table(["problem", "program", ">build ms", ">setup ms", ">iteration ms", ">iterations", ">to 0.1 % ms",
                  ">to 1e-6 ms", ">until it stops ms", ">memory MB", ">final cost"], rows)


def ratios(comparisons):
    """Returns the times of the fastest peer as multiples of SLoM's."""
    rows = []
    for c in comparisons:
        own, cholmod = facts.slom(c), c["cholmod_factor"]
        if own is None:
            continue
        rows.append([c["problem"], f"{c['variables']}, {c['measurements']}", c["start"], times(facts.ratio(c, "iteration")),
                     times(cholmod and cholmod["numeric"] / own["iteration"]), times(facts.ratio(c, "to_1e-3")),
                     times(facts.ratio(c, "to_1e-6")), times(facts.ratio(c, "memory"))])
    return table(["problem", ">variables, measurements", "start", ">iteration", ">CHOLMOD's factorisation / SLoM's iteration",
                  ">to 0.1 %", ">to 1e-6", ">memory"], rows)


def factorizations(comparisons, machine):
    """Returns SLoM's and CHOLMOD's factorisation alone."""
    rows = []
    for c in comparisons:
        own, cholmod, result = c["slom_factor"], c["cholmod_factor"], facts.slom(c)
        if own is None or cholmod is None or result is None:
            continue
        seconds, rate = facts.factorization_seconds(result), facts.factor_rate(c)
        rows.append([c["problem"], ms(own["symbolic"]), ms(cholmod["symbolic"]), times(cholmod["symbolic"] / own["symbolic"]),
                     ms(seconds), ms(cholmod["numeric"]), times(cholmod["numeric"] / seconds), digits(own["flops"] / 1e6),
                     digits(cholmod["flops"] / 1e6), digits(rate / 1e9),
                     f"{100 * rate / machine['dgemm_1024']:.0f} %",
                     f"{100 * cholmod['flops'] / seconds / machine['dgemm_1024']:.0f} %"])
    return table(["problem", ">symbolic ms", ">CHOLMOD's", ">ratio", ">numeric ms", ">CHOLMOD's", ">ratio", ">Mflop",
                  ">CHOLMOD's", ">GFLOP/s", ">of dgemm", ">of dgemm, CHOLMOD's operations"], rows)


def phases(comparisons):
    """Returns the phases of an average iteration and their times."""
    rows = []
    for c in comparisons:
        own, peer = facts.slom(c), facts.fastest_peer(c, "iteration")
        if own is None:
            continue
        row = [c["problem"]]
        parts = [facts.per_iteration(own, p) for p in ("linearize", "factorize", "solve", "rest")]
        row += [f"{ms(p)} ({100 * p / sum(parts):.0f} %)" for p in parts]
        row.append(ms(own["setup"]))
        row += [ms(facts.per_iteration(peer, p)) if peer else "–" for p in ("linearize", "factorize", "rest")]
        rows.append(row)
    return table(["problem", ">linearise ms", ">factorise ms", ">solve ms", ">rest ms", ">setup, once",
                  ">Ceres: residuals, Jacobians ms", ">linear solver ms", ">rest ms"], rows)


def costs(comparisons):
    """Returns final costs of the programs that do not agree to EQUAL."""
    rows = []
    for c in comparisons:
        for r in c["programs"]:
            if "failure" not in r and facts.deviation(c, r) > facts.EQUAL:
                rows.append([c["problem"], str(c["threads"]), r["program"], rss(r["final_rss"]), rss(facts.best_rss(c)),
                             f"{facts.deviation(c, r):.1e}", "yes" if r["converged"] else "no"])
    if not rows:
        return "All final costs agree."
    return table(["problem", ">threads", "program", ">final cost", ">best of all", ">relative difference", "converged"], rows)


def threads(one, two):
    """Returns the times to 1e-6 on one thread and on two."""
    rows = []
    for c in one:
        other = next((d for d in two if d["problem"] == c["problem"]), None)
        if other is None:
            continue
        for r in c["programs"]:
            pair = facts.program(other, r["program"])
            if "failure" in r or pair is None:
                continue
            same = abs(pair["final_rss"] - r["final_rss"])
            rows.append([c["problem"] if r is c["programs"][0] else "", r["program"], ms(r["iteration"]), ms(pair["iteration"]),
                         ms(r["to_1e-6"]), ms(pair["to_1e-6"]), times(r["iteration"] / pair["iteration"]),
                         "equal" if same == 0 else f"{same / r['final_rss']:.0e}"])
    return table(["problem", "program", ">iteration ms, 1 thread", ">2 threads", ">to 1e-6 ms, 1 thread", ">2 threads",
                  ">gain per iteration", "final costs"], rows)


def linearization(linearize):
    rows = [[r["measurement"], r["variant"], digits(r["median_ns"]),
             f"{digits(r['lower_quartile_ns'])} - {digits(r['upper_quartile_ns'])}",
             digits(r["ratio_to_peer"], 2), digits(r["ratio_to_reference"], 3), f"{r['deviation']:.0e}"]
            for r in linearize["results"]]
    return table(["measurement", "variant", ">ns per measurement", ">quartiles", ">/ Ceres", ">/ by hand", ">deviation"], rows)
