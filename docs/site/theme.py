"""Completes the theme furo as Debian 12 packages it, in the built site: its style imports normalize.css from a web server's folder and has
lost the rule for systems that are set to dark, and its script imports another one though it is no module. What is in order stays as it is."""
import pathlib
import re

NORMALIZE = pathlib.Path("/usr/share/javascript/normalize.css/normalize.css")


def complete_style(text):
    text = re.sub(r"@import url\((/javascript/normalize\.css/[a-z.]*)\);", lambda m: NORMALIZE.read_text(encoding="utf-8"), text)
    dark = re.search(r'body\[data-theme="dark"\] \{([^{}]*)\}', text)
    if dark and "prefers-color-scheme" not in text:
        text += ("\n@media not print { @media (prefers-color-scheme: dark) {\n"
                 'body:not([data-theme="light"]) {' + dark.group(1) + "} } }\n")
    return text


def complete_script(text, folder):
    imported = re.compile(r'^import Gumshoe from "\./(gumshoe-patched\.js)";\n')
    return imported.sub(lambda m: (folder / m.group(1)).read_text(encoding="utf-8"), text)


def complete(app, exception):
    if exception is not None:
        return
    static = pathlib.Path(app.outdir) / "_static"
    style, script = static / "styles/furo.css", static / "scripts/furo.js"
    style.write_text(complete_style(style.read_text(encoding="utf-8")), encoding="utf-8")
    script.write_text(complete_script(script.read_text(encoding="utf-8"), script.parent), encoding="utf-8")


def setup(app):
    app.connect("build-finished", complete)
    return {"parallel_read_safe": True}
