"""Doxygen's filter for headers: passes comments on word by word, in their layout. raw_comments.py HEADER

Comments that begin with /// become verbatim text; the one that a header begins with is about the file. Two macros that declare classes
are written out: MTK_BUILD_MANIFOLD and the table of losses.
"""
import re
import sys


COMPOUND = re.compile(r"\s*MTK_BUILD_MANIFOLD\((\w+), (.*)\)$")
LOSS = re.compile(r"\s*(SCALED|SHAPED)\((\w+)\)")
LOSSES = "SLOM_LOSSES(SLOM_SCALED_LOSS, SLOM_SHAPED_LOSS)"


def declared(line, lines):
    """What a macro in this line declares."""
    compound = COMPOUND.match(line)
    if compound:
        members = re.findall(r"\(\(([^()]*), (\w+)\)\)", compound.group(2))
        return [f"struct {compound.group(1)} {{ " + " ".join(f"{kind} {name};" for kind, name in members) + " };"]
    if line != LOSSES:
        return [line]
    result = []
    for kind, name in (found.groups() for found in map(LOSS.match, lines) if found):
        parameters = "double scale" if kind == "SCALED" else "double shape, double scale"
        result += ["/// \\verbatim", "/// The loss of this name in the table above; scale c in standard deviations of the whitened residual.",
                   "/// \\endverbatim", f"struct {name} : Loss {{"]
        result += ["/// \\verbatim", "/// Checked at insertion.", "/// \\endverbatim", f"constexpr {name}({parameters});", "};"]
    return result


def filtered(lines):
    result, i = [], 0
    while i < len(lines):
        block = []
        while i < len(lines) and re.match(r"\s*///(?![/<])", lines[i]):
            block.append(re.sub(r"^\s*/// ?", "", lines[i]))
            i += 1
        if block:
            if not result:
                result.append("/// \\file")
            result += ["/// \\verbatim", *("/// " + text for text in block), "/// \\endverbatim"]
            continue
        result += declared(re.sub(r"///<\s*(.*)$", r"///< \\verbatim \1 \\endverbatim", lines[i]), lines)
        i += 1
    return result


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as header:
        print("\n".join(filtered(header.read().split("\n"))))
