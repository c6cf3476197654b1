"""The code cells of examples/python/first_fits.ipynb run as a Python program, and give the outputs that the notebook holds. Plots are
compared by being there."""

import ast
import contextlib
import importlib.util
import io
import json
import unittest
from pathlib import Path

NOTEBOOK = Path(__file__).resolve().parents[2] / "examples/python/first_fits.ipynb"
HAS_MATPLOTLIB = importlib.util.find_spec("matplotlib") is not None


def run(code, names):
    """Returns what a cell prints, and the value of its last line."""
    tree = ast.parse(code)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, NOTEBOOK.name, "exec"), names)
        value = None if last is None else eval(compile(ast.Expression(last.value), NOTEBOOK.name, "eval"), names)
    return printed.getvalue(), value


class Notebook(unittest.TestCase):
    def test_cells_give_the_outputs_of_the_notebook(self):
        if HAS_MATPLOTLIB:
            import matplotlib

            matplotlib.use("Agg")
        names, kinds = {"__name__": "notebook"}, set()
        cells = [c for c in json.loads(NOTEBOOK.read_text())["cells"] if c["cell_type"] == "code"]
        for number, cell in enumerate(cells, 1):
            code = "".join(cell["source"])
            outputs = {o.get("name", o["output_type"]): o for o in cell["outputs"]}
            kinds.update(kind for o in cell["outputs"] for kind in o.get("data", [o["output_type"]]))
            self.assertEqual(cell["execution_count"], number, "the notebook is not executed in its order")
            if ".plot(" in code:
                self.assertIn("image/png", outputs["display_data"]["data"])
                if not HAS_MATPLOTLIB:
                    continue
            with self.subTest(cell=number):
                printed, value = run(code, names)
                self.assertEqual(printed, "".join(outputs.get("stdout", {}).get("text", "")))
                if "execute_result" in outputs:
                    data = outputs["execute_result"]["data"]
                    self.assertEqual(value._repr_html_(), "".join(data["text/html"]))
                    self.assertEqual(str(value).rstrip(), "".join(data["text/plain"]).rstrip())
        self.assertEqual(kinds & {"image/png", "text/html", "stream"}, {"image/png", "text/html", "stream"})

    def test_is_small(self):
        self.assertLess(NOTEBOOK.stat().st_size, 300_000)


if __name__ == "__main__":
    unittest.main()
