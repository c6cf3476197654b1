"""Figures for the tables and the goals from a comparison: a problem fitted by all programs (see bench/fit/json.cpp)."""
import math

SAME_MINIMUM = 1e-6  # relative difference of final costs up to which two fits ended in the same minimum
EQUAL = 1e-8         # up to which their costs are equal there


def program(comparison, name):
    """Returns the result whose program's name ends in `name`; None if there is none."""
    for result in comparison["programs"]:
        if result["program"].endswith(name) and "failure" not in result:
            return result
    return None


def slom(comparison):
    return program(comparison, "SLoM")


def peers(comparison):
    return [r for r in comparison["programs"] if r["program"] != "SLoM" and "failure" not in r]


def fastest_peer(comparison, key):
    """Returns the peer with the smallest number there; None if no peer has one."""
    known = [r for r in peers(comparison) if r[key] is not None]
    return min(known, key=lambda r: r[key]) if known else None


def ratio(comparison, key):
    """Returns the fastest peer's number as a multiple of SLoM's; None if one of the two has no number."""
    own, peer = slom(comparison), fastest_peer(comparison, key)
    if own is None or peer is None or not own[key]:
        return None
    return peer[key] / own[key]


def best_rss(comparison):
    return min(r["final_rss"] for r in comparison["programs"] if "failure" not in r)


def deviation(comparison, result):
    """Returns the relative difference between the final cost and the best one."""
    return result["final_rss"] / best_rss(comparison) - 1


def same_minimum(comparison):
    """Returns whether SLoM and at least one peer ended in the best minimum found."""
    own = slom(comparison)
    return (own is not None and deviation(comparison, own) < SAME_MINIMUM
            and any(deviation(comparison, r) < SAME_MINIMUM for r in peers(comparison)))


def per_iteration(result, phase):
    """Returns the seconds of a phase in an average iteration; `rest` is the time outside of all phases."""
    iterations = max(1, result["iterations"])
    if phase != "rest":
        return result[phase] / iterations
    phases = sum(result[p] for p in ("setup", "linearize", "factorize", "solve"))
    return max(0.0, result["total"] - phases) / iterations


def factorization_seconds(result):
    return result["factorize"] / max(1, result["factorizations"])


def factor_rate(comparison):
    """Returns the operations of SLoM's own fronts per second [flop/s]; None for bundles."""
    if comparison["slom_factor"] is None or slom(comparison) is None:
        return None
    return comparison["slom_factor"]["flops"] / factorization_seconds(slom(comparison))


def geometric_mean(values):
    values = list(values)
    return math.exp(sum(map(math.log, values)) / len(values)) if values else None


def is_graph(comparison):
    return comparison["kind"] != "bundle"


def select(results, threads=1, generated=False, graphs=None, robust=False):
    return [c for c in results["comparisons"]
            if c["threads"] == threads and c["generated"] == generated and (c["huber"] > 0) == robust
            and (graphs is None or is_graph(c) == graphs)]
