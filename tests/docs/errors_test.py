"""docs/errors.md is what docs/site/errors.py writes, and has every id of the sources: errors_test.py"""
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs/site"))
import errors  # noqa: E402


class Errors(unittest.TestCase):
    def test_page_is_up_to_date(self):
        self.assertEqual(errors.PAGE.read_text(encoding="utf-8"), errors.page(), "run docs/site/errors.py --write")

    def test_every_id_is_there(self):
        listed = {line.removeprefix("### ") for line in errors.PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("### ")}
        self.assertEqual(errors.ids_of_sources() - listed, set(), "a test compares the whole text of an error; or add the id to BY_HAND")
        self.assertEqual(set(errors.BY_HAND) & set(errors.all_messages()), set(), "there is a test with the whole text now; remove these from BY_HAND")
        self.assertGreater(len(listed), 75)

    def test_messages_are_found(self):
        source = 'f("[slom.a-b] one " "two; three"); g("[slom.c] x " + name + " is \\"1\\"; y"); h("[slom.d] cut " + text(1));'
        self.assertEqual(list(errors.messages(source)), [("slom.a-b", "one two; three"), ("slom.c", 'x ... is "1"; y')])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
