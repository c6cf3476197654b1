"""Growth of cost with size: a table and a picture of generated problems."""
import math

from . import facts
from .tables import digits, ms, table, times

FAMILIES = {"grid2d": "poses in the plane, square lattice", "sheet": "poses in space, square lattice",
            "grid3d": "poses in space, cubic lattice", "scene": "bundle adjustment, aerial photographs"}
COLOURS = ("#1f6fb2", "#c8551b", "#3a8f3a", "#8a4fbe", "#777777")
WIDTH, HEIGHT, LEFT, TOP, RIGHT, BOTTOM = 420, 300, 60, 34, 28, 40


def size(comparison):
    return comparison["measurements"] if comparison["kind"] == "bundle" else comparison["variables"]


def family(comparison):
    return comparison["problem"].split(":")[0]


def exponent(points):
    """Returns the slope of the last two points in double logarithmic axes."""
    (x0, y0), (x1, y1) = points[-2:]
    return math.log(y1 / y0) / math.log(x1 / x0)


def growth_table(comparisons):
    rows, before = [], {}
    for c in comparisons:
        for r in c["programs"]:
            first = [c["problem"], f"{c['variables']}, {c['measurements']}"] if r is c["programs"][0] else ["", ""]
            if "failure" in r:
                rows.append(first + [r["program"], r["failure"]] + [""] * 7)
                continue
            points = before.setdefault((family(c), r["program"]), [])
            points.append((size(c), r["iteration"]))
            ratio = r["iteration"] / facts.slom(c)["iteration"] if facts.slom(c) else None
            rows.append(first + [r["program"], ms(r["build"]), ms(r["setup"]), ms(r["iteration"]),
                                 digits(exponent(points), 2) if len(points) > 1 else "–",
                                 times(ratio) if r["program"] != "SLoM" else "", ms(r["to_1e-6"]), digits(r["memory"] / 1e6),
                                 f"{r['final_rss']:.10g}"])
    return table(["problem", ">variables, measurements", "program", ">build ms", ">setup ms", ">iteration ms",
                  ">grows as size to the power", ">/ SLoM", ">to 1e-6 ms", ">memory MB", ">final cost"], rows)


def curves(comparisons):
    """Returns {family: {program: [(size, seconds per iteration)]}}."""
    result = {}
    for c in comparisons:
        for r in c["programs"]:
            if "failure" not in r:
                result.setdefault(family(c), {}).setdefault(r["program"], []).append((size(c), r["iteration"]))
    return result


def panel(title, lines, programs, x, y):
    points = [p for line in lines.values() for p in line]
    low = [math.floor(math.log10(min(p[k] for p in points))) for k in (0, 1)]
    high = [max(low[k] + 1, math.ceil(math.log10(max(p[k] for p in points)))) for k in (0, 1)]

    def place(point):
        u, v = ((math.log10(point[k]) - low[k]) / (high[k] - low[k]) for k in (0, 1))
        return x + LEFT + u * (WIDTH - LEFT - RIGHT), y + HEIGHT - BOTTOM - v * (HEIGHT - TOP - BOTTOM)

    out = [f'<text x="{x + LEFT}" y="{y + 20}" font-weight="bold">{title}</text>']
    for power in range(low[0], high[0] + 1):
        u, _ = place((10.0 ** power, 10.0 ** low[1]))
        out.append(f'<path d="M{u:.1f} {y + TOP}V{y + HEIGHT - BOTTOM}" stroke="#ddd"/>'
                   f'<text x="{u:.1f}" y="{y + HEIGHT - BOTTOM + 16}" text-anchor="middle">{10 ** power}</text>')
    for power in range(low[1], high[1] + 1):
        _, v = place((10.0 ** low[0], 10.0 ** power))
        out.append(f'<path d="M{x + LEFT} {v:.1f}H{x + WIDTH - RIGHT}" stroke="#ddd"/>'
                   f'<text x="{x + LEFT - 6}" y="{v + 4:.1f}" text-anchor="end">{10.0 ** power:g} s</text>')
    for name, line in lines.items():
        colour = COLOURS[programs.index(name) % len(COLOURS)]
        at = [place(p) for p in line]
        out.append(f'<polyline points="{" ".join(f"{u:.1f},{v:.1f}" for u, v in at)}" fill="none" stroke="{colour}" '
                   'stroke-width="2"/>')
        out += [f'<circle cx="{u:.1f}" cy="{v:.1f}" r="3" fill="{colour}"/>' for u, v in at]
    return out


def growth_svg(comparisons):
    """Draws a panel for each family: seconds per iteration against size, both logarithmic."""
    families = curves(comparisons)
    programs = list(dict.fromkeys(name for lines in families.values() for name in lines))
    rows = (len(families) + 1) // 2
    height = rows * HEIGHT + 20 * len(programs) + 16
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * WIDTH}" height="{height}" font-family="sans-serif" '
           'font-size="12">', f'<rect width="{2 * WIDTH}" height="{height}" fill="#fff"/>']
    for i, (name, lines) in enumerate(families.items()):
        out += panel(f"{name}: {FAMILIES[name]}", lines, programs, i % 2 * WIDTH, i // 2 * HEIGHT)
    for i, name in enumerate(programs):
        y = rows * HEIGHT + 16 + 20 * i
        out.append(f'<path d="M{LEFT} {y - 4}h24" stroke="{COLOURS[i % len(COLOURS)]}" stroke-width="2"/>'
                   f'<text x="{LEFT + 32}" y="{y}">{name}, seconds per iteration against poses or observations</text>')
    return "\n".join(out + ["</svg>", ""])
