"""Gives results of the search a sentence around the hit: writes _static/excerpts_data.js, the text of all pages by section, which the page of the
search loads as a script, since a page in a file may not read another one. static/excerpts.js shows the sentences."""
import json
import pathlib
import re

from docutils import nodes
from sphinx import addnodes

def own_text(section, titles):
    """The text of a section without its headings and the sections in it; of declarations the name alone."""
    left_out = (nodes.section, nodes.title, nodes.comment, nodes.raw, addnodes.toctree)
    found = []

    def visit(node):
        if isinstance(node, nodes.Text):
            found.append(node.astext())
        elif isinstance(node, addnodes.desc_signature):
            found.append(" ".join(name.astext() for name in node.findall(addnodes.desc_name)) + " ")
        elif isinstance(node, addnodes.pending_xref) and node["reftype"] == "doc" and not node["refexplicit"]:
            found.append(titles[node["reftarget"].lstrip("/")].astext())
        elif not isinstance(node, left_out):
            for child in node.children:
                visit(child)
            if not isinstance(node, nodes.Inline):
                found.append(" ")
    for child in section.children:
        visit(child)
    return re.sub(r"\s+", " ", "".join(found)).strip()


def sections(doctree, titles):
    """[anchor, heading, text] of each section that has text, in the order of the page."""
    result = []
    for section in doctree.findall(nodes.section):
        text = own_text(section, titles)
        if text:
            result.append([section["ids"][0], section.next_node(nodes.title).astext(), text])
    return result


def write(app, exception):
    if exception is not None or app.builder.name != "html":
        return
    env = app.env
    pages = {name: sections(env.get_doctree(name), env.titles) for name in sorted(env.found_docs) if "nosearch" not in env.metadata[name]}
    text = json.dumps(pages, ensure_ascii=False, separators=(",", ":"))
    (pathlib.Path(app.outdir) / "_static/excerpts_data.js").write_text(f"window.slomExcerpts = {text};\n", encoding="utf-8")


def add_scripts(app, pagename, templatename, context, doctree):
    if pagename == "search":
        app.add_js_file("excerpts_data.js")
        app.add_js_file("excerpts.js")


def setup(app):
    app.connect("html-page-context", add_scripts)
    app.connect("build-finished", write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
