"""Writes the reference: a page for each public header, an index for each of their folders. reference.py XML FOLDER

XML: a folder for what Doxygen writes; FOLDER: that of the site's sources, below which reference/ is made.
"""
import json
import pathlib
import re
import sys
import textwrap

import headers
from sphinx.domains.cpp import DefinitionError, DefinitionParser

FOLDERS = {  # in the order of the library's rooms, with the words of docs/architecture.md
    "mtk": "manifolds", "mtk/types": "types of variables", "mtk/testing": "tests of one's own types",
    "slom": "the estimator and what is beside it", "slom/base": "threads", "slom/model": "handles, measurements, noise, losses",
    "slom/measurements": "measurements that are ready to use", "slom/problem": "the variable and measurement table",
    "slom/linearize": "residuals and Jacobians", "slom/solve": "linear solvers", "slom/online": "fits that follow their data",
    "slom/optimize": "algorithms, options, summaries", "slom/analyze": "uncertainty and diagnostics",
    "slom/tape": "measurement functions as data", "slom/trajectory": "B-splines as functions of time",
    "slom/filter": "Kalman filters", "slom/filter/models": "ready models for filters",
    "slom/initialize": "start values of maps",
    "slom/io": "files", "slom/calibration": "calibration of cameras and an IMU",
}
MANY_FUNCTIONS = 8
DIRECTIVES = {"class": "class", "struct": "struct", "union": "union", "concept": "concept", "function": "function", "friend": "function",
              "variable": "member", "typedef": "type", "enum": "enum", "enumvalue": "enumerator"}


class ParserConfig:
    cpp_id_attributes, cpp_paren_attributes = [], []


def parses(directive, declaration):
    try:
        parser = DefinitionParser(declaration, location=None, config=ParserConfig())
        parser.parse_declaration(directive, directive)
        parser.assert_end()
        return True
    except DefinitionError:
        return False


def tidy(code):
    return re.sub(r"\s+", " ", code.replace("< ", "<").replace(" >", ">").replace(" &", "&").replace("& ", "& ")).strip()


def heading(title, line):
    return f"{title}\n{line * len(title)}\n\n"


class Comment:
    """A comment of a header as reStructuredText: sentences as paragraphs, indented lines in their layout."""

    def __init__(self, names):
        self.names = names
        self.to_root = ""  # way from the page at work to the root of the site
        self.errors = set(re.findall(r"^### (\S+)$", (headers.ROOT / "docs/errors.md").read_text(encoding="utf-8"), re.MULTILINE))

    def prose(self, words):
        """Names of classes and functions, ids of errors in brackets and pages become links; what stands in backticks is code."""
        parts = re.split(r"`([^`]+)`", words)
        return "".join(self.code(part) if i % 2 else self.linked(part) for i, part in enumerate(parts))

    def code(self, words):
        return f"\\ ``{words.strip()}``\\ "

    def linked(self, words):
        pieces = re.split(r"(\[(?:slom|mtk)\.[a-z0-9.-]+\]|docs/[\w/]+\.md)", words)
        return "".join(self.special(piece) if i % 2 else self.linked_names(piece) for i, piece in enumerate(pieces))

    def special(self, piece):
        """A link to an error or to a page."""
        if piece.startswith("["):
            return self.error(piece[1:-1])
        page = piece.removeprefix("docs/").removesuffix(".md")
        return f"\\ :doc:`/{page}`\\ " if (headers.ROOT / piece).exists() else piece

    def error(self, name):
        anchor = name.replace(".", "-")
        return f"[\\ `{name} <{self.to_root}errors.html#{anchor}>`__\\ ]" if name in self.errors else f"[{name}]"

    def linked_names(self, words):
        result = []
        for part in re.split(r"([A-Za-z_][\w]*(?:::[A-Za-z_]\w*)*(?:\(\))?)", words):
            name = part.removesuffix("()")
            target = self.names.get(name)
            looks_like_code = part != name or "::" in name or re.search(r"[a-z][A-Z]", name) or "_" in name
            if target and looks_like_code:
                result.append(f"\\ :cpp:any:`{part} <{target}>`\\ ")
            else:
                result.append(re.sub(r"([\\*`|_<>])", r"\\\1", part))
        return "".join(result)

    def rst(self, comment):
        blocks, kind = [], None
        for line in comment.split("\n"):
            now = None if not line.strip() else "text" if line.startswith("  ") else "words"
            item = now == "words" and re.match(r"^[*-] ", line)
            if now is None or now != kind or item:
                blocks.append((now, []))
            blocks[-1][1].append(line)
            kind = now
        result = []
        for now, lines in blocks:
            if now == "words":
                result.append(self.prose(" ".join(line.strip() for line in lines)))
            elif now == "text":
                body = textwrap.dedent("\n".join(lines))
                language = "cpp" if re.search(r"[;{]\s*(//.*)?$", body, re.MULTILINE) else "text"
                result.append(f".. code-block:: {language}\n\n" + textwrap.indent(body, "   "))
        return "\n\n".join(result)


class Reference:
    def __init__(self, all_headers):
        self.headers, self.declared = all_headers, set()
        self.comment = Comment(self.names())

    def names(self):
        """{what a comment may call it: qualified name} of all classes and functions whose name belongs to one alone."""
        found = {}

        def visit(entity):
            if entity.kind in ("class", "struct", "concept", "function", "enum") and not entity.name.startswith(("operator", "~", "MTK_", "SLOM_")):
                parts = entity.qualified.split("::")
                if entity.kind == "function" and len(parts) > 1 and parts[-1] == parts[-2]:
                    return
                for i in range(len(parts)):
                    found.setdefault("::".join(parts[i:]), set()).add(entity.qualified)
                for each in entity.members:
                    visit(each)
        for header in self.headers.values():
            for entity in header.entities:
                visit(entity)
        return {name: next(iter(targets)) for name, targets in found.items() if len(targets) == 1}

    def declaration(self, entity, name):
        """(for the directive, whether Sphinx understands it)"""
        template = tidy(entity.template)
        required = f"requires {tidy(entity.requirement)}" if entity.requirement else ""
        words = " ".join(word for word in entity.words if word in ("static", "explicit"))
        type_, arguments = tidy(entity.type), tidy(entity.arguments)
        if entity.kind in ("class", "struct", "union"):
            bases = f" : {', '.join('public ' + tidy(base) for base in entity.type.split(', '))}" if entity.type and "<" not in entity.type else ""
            candidates = [f"{template} {required} {name}{bases}", f"{template} {name}"]
        elif entity.kind == "concept":
            candidates = [f"{template} {name}"]
        elif entity.kind in ("function", "friend"):
            arguments = re.sub(r"\s*=\s*(0|default|delete)$", r" = \1", arguments)
            if entity.kind == "friend" and not type_.startswith("friend"):
                type_ = f"friend {type_}"
            candidates = [f"{template} {required} {words} {type_} {name}{arguments}", f"{template} {words} {type_} {name}{arguments}"]
        elif entity.kind == "typedef":
            alias = re.sub(r"^using \w+ = ", "", type_)
            candidates = [f"{template} {name} = {alias}" if alias else name]
        elif entity.kind == "variable":
            initial = tidy(entity.initial)
            initial = f" {initial}" if initial.startswith(("=", "{")) and len(initial) < 60 else ""
            candidates = [f"{template} {words} {type_} {name}{arguments}{initial}", f"{template} {words} {type_} {name}{arguments}"]
        else:
            candidates = [f"{name} {tidy(entity.initial)}".strip()]
        candidates = [re.sub(r"\s+", " ", one).strip() for one in candidates]
        directive = DIRECTIVES[entity.kind]
        if entity.kind == "enum" and "strong" in entity.words:
            directive = "enum-class"
        for one in candidates:
            if parses({"enum-class": "enum", "struct": "class"}.get(directive, directive), one):
                return directive, one, True
        return directive, candidates[0], False

    def entry(self, entity, name):
        directive, declaration, is_understood = self.declaration(entity, name)
        key = (entity.scope, declaration)
        if entity.kind in ("class", "struct", "enum", "concept", "typedef", "variable"):
            key = entity.qualified
        if key in self.declared:
            return ""
        self.declared.add(key)
        body = self.comment.rst(entity.comment)
        shown = [each for each in entity.members if self.is_shown(each)]
        inner = "".join(self.entry(each, each.name) for each in shown)
        if not is_understood:
            code = textwrap.indent(declaration, "   ")
            return f".. code-block:: cpp\n\n{code}\n\n{body}\n\n{inner}"
        body = f"{body}\n\n{self.list_of_members(entity, shown)}"
        return f".. cpp:{directive}:: {declaration}\n\n{textwrap.indent(body, '   ')}\n\n{textwrap.indent(inner, '   ')}\n"

    def list_of_members(self, entity, shown):
        """A line of links to the functions of a class that has many of them."""
        names = dict.fromkeys(each.name for each in shown if each.kind == "function" and re.fullmatch(r"(?!explicit)[a-z]\w*", each.name))
        if len(names) < MANY_FUNCTIONS:
            return ""
        return ", ".join(f":cpp:any:`{name} <{entity.qualified}::{name}>`" for name in names) + "\n\n"

    def is_shown(self, entity):
        if entity.kind == "define" or re.match(r"^[A-Z0-9_]{4,}$", entity.name) and entity.kind == "function":
            return False
        if entity.name in ("MtkState", "DeclaredAs") or entity.name.startswith(("mtk", "~")):
            return False  # what the library asks types for
        if entity.kind == "function" and "->" in entity.arguments and not entity.type:
            return False  # a deduction guide
        if entity.name == "operator=" or (entity.name == entity.scope.rpartition("::")[2] and not entity.comment and "&&" in entity.arguments):
            return False
        return True

    def page(self, header):
        self.comment.to_root = "../" * (header.name.count("/") + 1)
        text = heading(header.name, "=") + f".. code-block:: cpp\n\n   #include <{header.name}>\n\n"
        text += self.comment.rst(header.comment) + "\n\n"
        headed = set()
        for entity in header.entities:
            is_macro = entity.kind == "define" and entity.comment
            if entity.name not in headed and (is_macro or entity.kind != "define" and self.is_shown(entity)):
                headed.add(entity.name)
                if len(header.entities) > 1:
                    text += heading(re.sub(r"([\\*`|_<>])", r"\\\1", entity.name), "-")
            if entity.kind == "define" and entity.comment:
                text += f".. c:macro:: {entity.name}{entity.arguments}\n\n" + textwrap.indent(self.comment.rst(entity.comment), "   ") + "\n\n"
            elif self.is_shown(entity):
                text += self.entry(entity, entity.qualified)
        return text

    def write(self, folder):
        (folder.parent / "names.json").write_text(json.dumps(self.comment.names), encoding="utf-8")  # for code_links.py
        pages = {}
        for header in self.headers.values():
            path = folder / f"{header.name.removesuffix('.hpp')}.rst"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(self.page(header), encoding="utf-8")
            pages.setdefault(header.name.rpartition("/")[0], []).append(header.name.removesuffix(".hpp"))
        missing = set(pages) - set(FOLDERS)
        if missing:
            sys.exit(f"docs: docs/site/reference.py does not know the folders {sorted(missing)} of include/; add them to FOLDERS")
        for name, words in FOLDERS.items():
            firsts = [(header, re.split(r"(?<=[.:]) ", self.headers[f"{header}.hpp"].comment.replace("\n", " "))[0]) for header in sorted(pages[name])]
            self.comment.to_root = "../"
            text = heading(f"{name}: {words}", "=")
            text += "".join(f"* :doc:`/reference/{header}`: {self.comment.prose(first)}\n" for header, first in firsts)
            text += "\n.. toctree::\n   :hidden:\n\n" + "".join(f"   {header.rpartition('/')[2]}.hpp </reference/{header}>\n" for header, _ in firsts)
            (folder / f"{name.replace('/', '_')}_folder.rst").write_text(text, encoding="utf-8")
        index = folder / "index.md"
        entries = "\n".join(f"{name} <{name.replace('/', '_')}_folder>" for name in FOLDERS)
        listed = "\n".join(f"* {{doc}}`{name} <{name.replace('/', '_')}_folder>`: {words}" for name, words in FOLDERS.items())
        index.write_text(index.read_text(encoding="utf-8") + f"\n{listed}\n\n```{{toctree}}\n:hidden:\n\n{entries}\n```\n", encoding="utf-8")


if __name__ == "__main__":
    public = {name: header for name, header in headers.read(sys.argv[1]).items() if "/detail/" not in name}
    Reference(public).write(pathlib.Path(sys.argv[2]) / "reference")
