"""Names of classes and functions that stand as code in the pages lead to the reference: `slom::Options`, `est.optimize()`."""
import json
import pathlib
import re

from docutils import nodes
from sphinx import addnodes


def target_of(code, names):
    found = re.match(r"^(?:est\.|estimator\.)?((?:\w+::)*\w+)(?:<[\w:, ]*>)?(?:\(.*\))?$", code)
    if not found or not (code.startswith(("slom::", "mtk::", "est.")) or re.match(r"^[A-Z][a-z]\w*[A-Z]\w*$", found.group(1))):
        return None
    name = found.group(1)
    return names.get(f"Estimator::{name}") if code.startswith("est.") else names.get(name)


def link(app, doctree):
    file = pathlib.Path(app.srcdir) / "names.json"
    if not file.exists() or app.env.docname.startswith(("reference/", "files/")):
        return
    names = json.loads(file.read_text(encoding="utf-8"))
    for literal in list(doctree.findall(nodes.literal)):
        target = target_of(literal.astext(), names)
        if target is None or isinstance(literal.parent, (nodes.reference, nodes.title)):
            continue
        reference = addnodes.pending_xref("", literal.deepcopy(), refdomain="cpp", reftype="any", reftarget=target, refexplicit=True, refdoc=app.env.docname)
        literal.replace_self(reference)


def setup(app):
    app.connect("doctree-read", link)
    return {"parallel_read_safe": True}
