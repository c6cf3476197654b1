"""Writes the sources of the site: the pages of the repository with links that hold in it.

    stage.py FOLDER

Pages keep their text. Of their relative links those to pages become links to pages of the site, those to other files of the repository
links to a page that shows the file, and those to folders links to the README.md in them. FOLDER is replaced.
`pages_of_site`, `text_of`, `links`, `slug` and `anchors` are also what tests/docs checks the Markdown with.
"""
import itertools
import os
import pathlib
import re
import shutil
import sys
import textwrap

import notebook

ROOT = pathlib.Path(__file__).resolve().parents[2]
FENCE = re.compile(r"^ {0,3}(```+|~~~+)")
INLINE_CODE = re.compile(r"(`+)(?!`).*?(?<!`)\1(?!`)")
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(([^()\s]+)\)")
LANGUAGES = {".hpp": "cpp", ".cpp": "cpp", ".py": "python", ".sh": "bash", ".cmake": "cmake", ".json": "json", ".txt": "text", ".csv": "text"}
SHOWN_LINES = 2000  # of a file that a page links to
PICTURES = {".svg", ".png", ".jpg"}


def pages_of_site():
    """{page of the repository: name of the page in the site}, both with .md and relative to ROOT or the site."""
    pages = {"README.md": "overview.md", "CHANGELOG.md": "changes.md", "bench/README.md": "benchmark_programs.md",
             "examples/python/first_fits.ipynb": "first_fits.md"}
    for path in sorted((ROOT / "docs").rglob("*.md")):
        name = path.relative_to(ROOT / "docs").as_posix()
        if not name.startswith("site/"):
            pages[f"docs/{name}"] = re.sub(r"(^|/)README\.md$", r"\1index.md", name)
    return pages


def text_of(page):
    """The Markdown of a page of the repository."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return notebook.markdown(text) if page.endswith(".ipynb") else text


def lines_outside_code(text):
    """Yields (line, is outside of fenced and indented code), fences included."""
    fence = None
    for line in text.split("\n"):
        found = FENCE.match(line)
        if fence:
            yield line, False
            if found and found.group(1).startswith(fence) and not line.strip().strip("`~"):
                fence = None
        elif found:
            fence = found.group(1)
            yield line, False
        else:
            yield line, not line.startswith("    ")


def replaced_links(text, replacement):
    """The text with replacement(is picture, text, target) for each link outside of code, where that is not None. The text of a link
    may go on in the next line."""
    def in_paragraph(lines):
        codes = []
        def hide(match):
            codes.append(match.group(0))
            return f"\0{len(codes) - 1}\0"
        def show(part):
            return re.sub("\0(\\d+)\0", lambda m: codes[int(m.group(1))], part)
        def one(match):
            new = replacement(match.group(1) == "!", show(match.group(2)), match.group(3))
            return match.group(0) if new is None else new
        return show(LINK.sub(one, INLINE_CODE.sub(hide, lines)))
    paragraphs = itertools.groupby(lines_outside_code(text), lambda line: line[1] and bool(line[0].strip()))
    joined = ((is_text, "\n".join(line for line, _ in lines)) for is_text, lines in paragraphs)
    return "\n".join(in_paragraph(lines) if is_text else lines for is_text, lines in joined)


def with_code_at_the_margin(text):
    """The text with the indentation removed that all lines of a fenced block have, as of code from the middle of a function."""
    result, block = [], []
    for line, outside in lines_outside_code(text):
        if not outside and not FENCE.match(line):
            block.append(line)
            continue
        result += textwrap.dedent("\n".join(block)).split("\n") if block and result and FENCE.match(result[-1]) else block
        block = []
        result.append(line)
    return "\n".join(result + block)


def links(text):
    """The targets of all links outside of code."""
    found = []
    replaced_links(text, lambda picture, words, target: found.append(target))
    return found


def slug(heading):
    """The anchor of a heading, as GitHub and MyST make it."""
    heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "")
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def anchors(text):
    found, counts = set(), {}
    for line, outside in lines_outside_code(text):
        heading = re.match(r"^#{1,6} +(.*?)#* *$", line) if outside else None
        if heading:
            name = slug(heading.group(1))
            counts[name] = counts.get(name, 0) + 1
            found.add(name if counts[name] == 1 else f"{name}-{counts[name] - 1}")
    return found


def resolve(page, target):
    """(path in the repository, anchor) of a relative link in a page; folders lead to their README.md. None for addresses."""
    if re.match(r"^[a-z]+:", target):
        return None
    path, _, anchor = target.partition("#")
    full = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
    if (ROOT / full).is_dir() and (ROOT / full / "README.md").exists():
        full += "/README.md"
    return full, anchor


def title(path):
    return re.search(r"^# +(.*)$", path.read_text(encoding="utf-8"), re.MULTILINE).group(1)


class Site:
    def __init__(self, folder):
        self.folder, self.pages, self.shown = pathlib.Path(folder), pages_of_site(), {}

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def page_of(self, path):
        """Where the site has a file of the repository."""
        if path in self.pages:
            return self.pages[path]
        self.shown[path] = f"files/{path}.md"
        return self.shown[path]

    def translate(self, page, name):
        def link(is_picture, words, target):
            place = resolve(page, target)
            if place is None or (not target.partition("#")[0]):
                return None
            path, anchor = place
            if not (ROOT / path).is_file():
                sys.exit(f"docs: {page} links to {target}, which is no file and no folder with a README.md")
            if is_picture:
                copy = self.folder / "pictures" / path
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(ROOT / path, copy)
                relative = os.path.relpath(copy.relative_to(self.folder), os.path.dirname(name) or ".")
                return f"![{words}]({relative})"
            relative = os.path.relpath(self.page_of(path), os.path.dirname(name) or ".")
            if words.strip("`").endswith(".md"):
                words = title(ROOT / path)
            return f"[{words}]({relative}{'#' + anchor if anchor else ''})"
        text = text_of(page)
        if os.path.basename(name) == "index.md":
            text += self.contents(page, name, text)
        return replaced_links(with_code_at_the_margin(text), link)

    def contents(self, page, name, text):
        """The navigation below an index: one list for each of its sections, of the pages in its folder and below that it links to, or,
        for the index of the site, of any."""
        result = [[None, []]]
        for line, outside in lines_outside_code(text):
            heading = re.match(r"^## +(.*)$", line)
            if heading and outside:
                result.append([heading.group(1), []])
            item = re.match(r"^\* \[([^\]]*)\]\(([^)#]*)\)", line)
            if item and outside:
                target = self.pages.get(resolve(page, item.group(2))[0], "")
                folder = os.path.dirname(name)
                if target and (not folder or target.startswith(folder + "/")):
                    result[-1][1].append(f"{item.group(1)} </{target.removesuffix('.md')}>")
        return "".join("\n\n```{toctree}\n:hidden:\n" + (f":caption: {caption}\n" if caption else "") + "\n" + "\n".join(names) + "\n```\n"
                       for caption, names in result if names)

    def show_files(self):
        for path, name in self.shown.items():
            content = (ROOT / path).read_text(encoding="utf-8", errors="replace").split("\n")
            note = f"The first {SHOWN_LINES} lines of {len(content)}.\n\n" if len(content) > SHOWN_LINES else ""
            language = LANGUAGES.get(pathlib.Path(path).suffix, "bash" if content[0].startswith("#!") else "text")
            code = "\n".join(content[:SHOWN_LINES]).rstrip("\n")
            self.write(name, f"---\norphan: true\nnosearch: true\n---\n\n# {path}\n\n{note}``````{{code-block}} {language}\n{code}\n``````\n")

    def make(self):
        shutil.rmtree(self.folder, ignore_errors=True)
        for page, name in self.pages.items():
            self.write(name, self.translate(page, name))
        self.show_files()


if __name__ == "__main__":
    Site(sys.argv[1]).make()
