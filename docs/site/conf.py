"""Sphinx's settings for the site that scripts/docs builds. Everything comes from local files."""
import os
import pathlib
import re
import sys

from pygments.lexers.special import TextLexer

ROOT = pathlib.Path(__file__).resolve().parents[2]
version_header = (ROOT / "include/slom/version.hpp").read_text(encoding="utf-8")
numbers = re.findall(r"#define SLOM_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", version_header)

project = "SLoM"
author = "the authors of SLoM"
release = version = ".".join(numbers)
sys.path.insert(0, os.fspath(pathlib.Path(__file__).parent))
extensions = ["myst_parser", "theme", "code_links", "cpp_objects", "excerpts"]
root_doc = "index"
language = "en"
nitpicky = True
nitpick_ignore_regex = [("cpp:identifier", ".*")]  # types in declarations: those of Eigen and of C++ have no page here
highlight_language = "text"
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]

html_theme = "furo"
html_title = f"SLoM {release}"
html_static_path = [os.fspath(pathlib.Path(__file__).parent / "static")]
html_css_files = ["site.css"]
html_js_files = ["keyboard.js"]
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
html_last_updated_fmt = None
html_use_index = True
html_show_search_summary = False  # a page in a file may not read another one; excerpts.py has what it may
pygments_style = "code_style.Light"
pygments_dark_style = "code_style.Dark"


def setup(app):
    app.add_lexer("csv", TextLexer)
