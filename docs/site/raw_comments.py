"""Doxygen's filter for headers: passes comments on word by word, in their layout. raw_comments.py HEADER

Comments that begin with /// become verbatim text; the one that a header begins with is about the file.
"""
import re
import sys


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
        result.append(re.sub(r"///<\s*(.*)$", r"///< \\verbatim \1 \\endverbatim", lines[i]))
        i += 1
    return result


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as header:
        print("\n".join(filtered(header.read().split("\n"))))
