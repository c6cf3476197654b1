"""The links of all pages hold, in plain Markdown as on the site, and every page is in an index: links_test.py"""
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs/site"))
import stage  # noqa: E402


def faults(page, text):
    """What is wrong with the relative links of a page."""
    found = []
    for target in stage.links(text):
        place = stage.resolve(page, target)
        if place is None:
            continue
        path, anchor = place
        file = stage.ROOT / path
        if path != page and not file.is_file():
            found.append(f"{page}: {target} is no file and no folder with a README.md")
        elif anchor and path.endswith(".md") and anchor not in stage.anchors(text if path == page else file.read_text(encoding="utf-8")):
            found.append(f"{page}: {target} names a heading that is not there")
    return found


class Links(unittest.TestCase):
    def test_hold(self):
        pages = stage.pages_of_site()
        self.assertGreater(len(pages), 30)
        for page in pages:
            self.assertEqual(faults(page, stage.text_of(page)), [])

    def test_broken_ones_are_noticed(self):
        text = "# A heading\n[a](fitting.md#outliers) [b](#a-heading) `[c](none.md)` [d](../bench/README.md) [e](https://x.org)\n"
        self.assertEqual(faults("docs/x.md", text), [])
        self.assertEqual(faults("docs/x.md", "[a](none.md)"), ["docs/x.md: none.md is no file and no folder with a README.md"])
        self.assertEqual(faults("docs/x.md", "[a\nb](none.md)"), ["docs/x.md: none.md is no file and no folder with a README.md"])
        self.assertEqual(faults("docs/x.md", "[a](fitting.md#none)"), ["docs/x.md: fitting.md#none names a heading that is not there"])
        self.assertEqual(faults("docs/x.md", "[a](#none)"), ["docs/x.md: #none names a heading that is not there"])
        self.assertEqual(faults("docs/x.md", "[a](../src)"), ["docs/x.md: ../src is no file and no folder with a README.md"])

    def test_lead_to_every_page(self):
        """Each folder's README.md links to all pages of the folder, and docs/README.md to those outside of docs/ as well."""
        linked = {"docs/README.md"}
        for page in stage.pages_of_site():
            if page.endswith("/README.md"):
                text = (stage.ROOT / page).read_text(encoding="utf-8")
                linked.update(place[0] for place in (stage.resolve(page, target) for target in stage.links(text)) if place)
        self.assertEqual(set(stage.pages_of_site()) - linked, set())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
