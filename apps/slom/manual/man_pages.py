#!/usr/bin/env python3
"""Writes the manual pages of the command and of its subcommands from their help: man_pages.py COMMAND VERSION FOLDER.

Each is FOLDER/<command>[-<subcommand>...].1 in the macros of man(7).
"""
import os
import re
import subprocess
import sys

COLUMN = 30  # where the help's texts of options begin


def help_of(command, words):
    """The lines of the help with all options."""
    def said(flag):
        return subprocess.run([command, *words, flag], check=True, capture_output=True, text=True).stdout.rstrip().split("\n")
    lines = said("--help")
    return said("--help-all") if any(line.startswith("  --help-all ") for line in lines) else lines


def escaped(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text[:1] in (".", "'") else text


def paragraphs(lines):
    """Lines between empty ones."""
    found = [[]]
    for line in lines:
        found[-1].append(line) if line else found.append([])
    return [lines for lines in found if lines]


def items(lines):
    """Pairs of an option, or what else is listed, and the lines of its text."""
    found = []
    for line in lines:
        if line.startswith(" " * COLUMN):
            found[-1][1].append(line.strip())
        elif len(line) > COLUMN and line[COLUMN - 1] == " ":
            found.append((line[:COLUMN].strip(), [line[COLUMN:]]))
        else:
            found.append((line.strip(), []))
    return found


def text_of(lines):
    """Lines as one text, but for those that begin as entries of a list."""
    out = []
    for i, line in enumerate(lines):
        if i > 0 and re.match(r"\S+: ", line):
            out.append(".br")
        out.append(escaped(line))
    return out


def subcommands(lines):
    start = lines.index("Subcommands:") + 1 if "Subcommands:" in lines else len(lines)
    return [name for name, _ in items([line for line in lines[start:] if line])]


def page(words, version, lines, others):
    """The page of `slom WORD...`."""
    name = "-".join(words)
    blocks = paragraphs(lines)
    usage = next((line for line in lines if line.startswith("Usage: ")), "Usage: " + " ".join(words))
    blocks = [[line for line in block if not line.startswith("Usage: ")] for block in blocks]
    blocks = [block for block in blocks if block]
    example = blocks.pop(0) if blocks[0][0].startswith(words[0] + " ") else []
    purpose = blocks[0][0].split(". ")[0].rstrip(".")
    description, sections, status = [], [], []
    for block in blocks:
        if block[0].startswith("Exit code: "):
            status = text_of([block[0][len("Exit code: "):], *block[1:]])
        elif re.fullmatch(r"[A-Z][\w ]+:", block[0]) and all(line.startswith("  ") for line in block[1:]):
            sections += [".SH " + block[0][:-1].upper()]
            for item, text in items(block[1:]):
                sections += [".TP", ".B " + escaped(item), *text_of(text)]
        elif any("  " in line for line in block):
            description += [".PP", ".nf", *map(escaped, block), ".fi"]
        else:
            description += [".PP", *text_of(block)]
    out = [f'.TH {name.upper()} 1 "" "slom {version}" "User Commands"',
           ".SH NAME", f"{escaped(name)} \\- {escaped(purpose)}", ".SH SYNOPSIS", ".B " + escaped(usage[len("Usage: "):])]
    if example:
        out += [".PP", ".nf", *map(escaped, example), ".fi"]
    out += [".SH DESCRIPTION", *description[1:], *sections]
    if status:
        out += [".SH EXIT STATUS", *status]
    if others:
        out += [".SH SEE ALSO", *(f".BR {escaped(other)} (1){',' if other != others[-1] else ''}" for other in others)]
    return "\n".join(out) + "\n"


def write(command, words, version, folder):
    """The page of these words, and those of their subcommands."""
    lines = help_of(command, words[1:])
    below = subcommands(lines)
    others = ["-".join([*words, name]) for name in below] or ["-".join(words[:-1])]
    with open(os.path.join(folder, "-".join(words) + ".1"), "w", encoding="utf-8") as file:
        file.write(page(words, version, lines, others))
    for name in below:
        write(command, [*words, name], version, folder)


def main():
    command, version, folder = sys.argv[1:]
    os.makedirs(folder, exist_ok=True)
    write(command, [os.path.basename(command)], version, folder)


if __name__ == "__main__":
    main()
