"""The Markdown of a Jupyter notebook with its outputs: printed text as blocks, tables as HTML, plots as pictures in the page."""
import json


def fenced(text, language):
    return f"```{language}\n{text.rstrip()}\n```"


def output(item):
    """The Markdown of one output of a cell: its richest form that a page can show."""
    data = {kind: "".join(text) for kind, text in item.get("data", {}).items()}
    if item["output_type"] == "stream":
        return fenced("".join(item["text"]), "text")
    if "image/png" in data:
        source = data["image/png"].replace("\n", "")
        return f'<p><img alt="{data.get("text/plain", "plot")}" src="data:image/png;base64,{source}"></p>'
    if data.get("text/html", "<pre>").startswith("<pre>"):
        return fenced(data["text/plain"], "text")
    return data["text/html"].replace("<table>", '<table class="docutils">')


def markdown(text):
    parts = []
    for cell in json.loads(text)["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(source)
        elif cell["cell_type"] == "code":
            parts += [fenced(source, "python"), *map(output, cell["outputs"])]
    return "\n\n".join(parts) + "\n"
