"""The goals, and how far they are reached."""
from . import facts
from .tables import digits, ms, table, times

FACTOR_RATE_PROBLEMS = ("sphere2500", "torus3D")


class Goal:
    """A goal. `values`: (problem, number or None) pairs; each number should be at least `wanted`."""

    def __init__(self, text, values, wanted, show=times):
        self.text, self.wanted, self.show = text, wanted, show
        self.known = [(name, value) for name, value in values if value is not None]
        self.short = [(name, value) for name, value in self.known if value < wanted]

    @property
    def is_reached(self):
        return bool(self.known) and not self.short

    def row(self):
        if not self.known:
            return [self.text, self.show(self.wanted), "not measured", "–", "–"]
        numbers = [value for _, value in self.known]
        lowest = min(self.known, key=lambda pair: pair[1])
        return [self.text, self.show(self.wanted), "**reached**" if self.is_reached else "short",
                f"{len(self.known) - len(self.short)} of {len(self.known)}",
                f"{self.show(facts.geometric_mean(numbers))}, lowest {self.show(lowest[1])} ({lowest[0]})"]


def percent(value):
    return f"{100 * value:.0f} %"


def goals_of(results):
    graphs, bundles = facts.select(results, graphs=True), facts.select(results, graphs=False)
    alike = [c for c in graphs if facts.same_minimum(c)]

    def of(comparisons, number):
        return [(c["problem"], number(c)) for c in comparisons]

    def iteration_to_cholmod(c):
        own = facts.slom(c)
        return c["cholmod_factor"]["numeric"] / own["iteration"] if own and c["cholmod_factor"] else None

    def share_of_dgemm(c):
        rate = facts.factor_rate(c)
        return rate and rate / results["machine"]["dgemm_1024"]

    def symbolic(c):
        return c["cholmod_factor"]["symbolic"] / c["slom_factor"]["symbolic"] if c["cholmod_factor"] and c["slom_factor"] else None

    to_minimum = facts.geometric_mean(r for c in alike if (r := facts.ratio(c, "to_1e-6")) is not None)
    return [
        Goal("Ceres' iteration / SLoM's, pose graphs", of(graphs, lambda c: facts.ratio(c, "iteration")), 5),
        Goal("CHOLMOD's numeric factorisation / SLoM's whole iteration, pose graphs", of(graphs, iteration_to_cholmod), 3),
        Goal("Ceres' time to 1e-6 / SLoM's, geometric mean of the pose graphs where both end in the same minimum",
             [("all", to_minimum)], 10),
        Goal("rate of the factorisation / rate of dgemm",
             of([c for c in graphs if c["problem"] in FACTOR_RATE_PROBLEMS], share_of_dgemm), 0.4, percent),
        Goal("CHOLMOD's symbolic time / SLoM's, pose graphs", of(graphs, symbolic), 5),
        Goal("best Schur solver's time to 0.1 % / SLoM's, bundles", of(bundles, lambda c: facts.ratio(c, "to_1e-3")), 5),
        Goal("best Schur solver's time to 1e-6 / SLoM's, bundles", of(bundles, lambda c: facts.ratio(c, "to_1e-6")), 5),
        Goal("least memory of Ceres / SLoM's, all files", of(graphs + bundles, lambda c: facts.ratio(c, "memory")), 1),
    ]


def goals_table(goals):
    return table(["ratio", ">goal, at least", "", ">problems that reach it", "geometric mean, lowest"], [g.row() for g in goals])


def shortfalls(goals, results):
    """Returns, for each goal not reached, the problems and the gaps; then a table with the largest phase of these iterations."""
    comparisons = {c["problem"]: c for c in facts.select(results)}
    lines = []
    for goal in goals:
        if goal.short:
            where = ", ".join(f"{name} {goal.show(value)}" for name, value in sorted(goal.short, key=lambda pair: pair[1]))
            lines.append(f"* {goal.text}: the goal {goal.show(goal.wanted)} is missed by {where}.")
    rows = []
    for name in dict.fromkeys(name for goal in goals for name, _ in goal.short if name in comparisons):
        own = facts.slom(comparisons[name])
        parts = {p: facts.per_iteration(own, p) for p in ("linearize", "factorize", "solve", "rest")}
        largest = max(parts, key=parts.get)
        share = parts[largest] / max(1e-30, sum(parts.values()))
        rows.append([name, largest, percent(share), ms(own["iteration"]), str(own["iterations"]), digits(own["memory"] / 1e6)])
    if rows:
        lines += ["", "The table has the largest part of an iteration of SLoM on these problems:", "",
                  table(["problem", "largest part", ">of an iteration", ">iteration ms", ">iterations", ">memory MB"], rows)]
    return "\n".join(lines)
