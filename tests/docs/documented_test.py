"""Every public class and function has a comment: documented_test.py FOLDER

Doxygen reads the headers of include/ into FOLDER. Not asked for are
  * names in namespaces `detail`, private and protected members, specialisations of templates,
  * functions that C++ or the concept of manifolds define: constructors without arguments and of the same type, assignments, destructors,
    operators, deduction guides, size, empty, begin, end of containers, boxplus, boxminus, mtkMembers and
    mtkMemberNames of compounds; members MtkState (mtk/detail/state.hpp); those of <cmath> for other numbers,
  * overrides, which the base class documents, and overloads that follow a documented one.
A class whose name is that of its header may leave the comment to that which the header begins with.
Exit code 77: skipped, because Doxygen is not there.
"""
import pathlib
import re
import shutil
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "docs/site"))
import headers  # noqa: E402

BY_CONVENTION = {"boxplus", "boxminus", "size", "empty", "begin", "end", "mtkMembers", "mtkMemberNames"}
MATHEMATICAL = {"abs", "abs2", "fabs", "fmax", "fmin", "isfinite", "isinf", "isnan", "pow", "atan", "cos", "sin", "sqrt", "hypot"}


def snake(name):
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def is_asked_for(entity):
    if entity.name == "MtkState" or entity.scope.endswith("::MtkState") or re.fullmatch(r"[A-Z][A-Z0-9_]+_[A-Z0-9_]+", entity.name):
        return False  # the latter are uses of macros
    if entity.scope == "mtk" and entity.name in MATHEMATICAL:
        return False
    if entity.kind in ("class", "struct", "union", "concept"):
        return True
    if entity.kind != "function" or "override" in entity.words:
        return False
    if "->" in entity.arguments and not entity.type:
        return False  # deduction guides
    name, of_class = entity.name, entity.scope.rpartition("::")[2]
    if name.startswith(("operator", "~")) or name in BY_CONVENTION:
        return False
    if name == of_class:
        arguments = re.sub(r"\s*(noexcept|=default|=delete)", "", entity.arguments)
        same = rf"\((const )?{name}(< .* >)? ?&&? ?\w*\)"
        return arguments != "()" and not re.fullmatch(same, arguments)
    return True


def undocumented(all_headers):
    """The names of the classes and functions that are asked for and have no comment, each once."""
    found = []

    def visit(entities, header):
        explained = set()
        for entity in entities:
            has_comment = bool(entity.comment) or entity.name in explained
            if entity.kind in ("class", "struct") and header.comment and snake(entity.name) == pathlib.PurePath(header.name).stem:
                has_comment = True
            if has_comment:
                explained.add(entity.name)
            elif is_asked_for(entity) and f"{header.name} {entity.qualified}" not in found:
                found.append(f"{header.name} {entity.qualified}")
            if entity.kind in ("class", "struct", "union"):
                visit(entity.members, header)

    for header in all_headers.values():
        visit(header.entities, header)
    return sorted(found)


class Comments(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.headers = headers.read(FOLDER)

    def test_are_there(self):
        self.assertEqual(undocumented(self.headers), [], "these have no comment; write one")

    def test_the_headers_are_read(self):
        estimator = [entity for entity in self.headers["slom/estimator.hpp"].entities if entity.name == "Estimator"]
        self.assertEqual(len(estimator), 1)
        names = {entity.name for entity in estimator[0].members}
        self.assertLessEqual({"insertRV", "insertMeasurement", "optimize", "covariance"}, names)
        self.assertGreater(len(self.headers), 140)
        losses = {entity.name for entity in self.headers["slom/model/loss.hpp"].entities}
        self.assertLessEqual({"Huber", "Barron"}, losses)
        self.assertIn("OpenCv5Camera", {entity.name for entity in self.headers["slom/measurements/projection.hpp"].entities})

    def test_a_missing_comment_is_noticed(self):
        def function(name, comment, scope="slom", arguments="()", line=1):
            return headers.Entity("function", name, scope, "slom/x.hpp", line, comment, arguments=arguments)
        entities = [function("a", "said", line=1), function("a", "", line=2), function("b", "", line=3), function("operator==", "", line=4)]
        kind = headers.Entity("class", "Thing", "slom", "slom/x.hpp", 9, "", members=[
            function("Thing", "", "slom::Thing"), function("Thing", "", "slom::Thing", "(const Thing &)"),
            function("Thing", "", "slom::Thing", "(int n)"), function("length", "", "slom::Thing")])
        found = undocumented({"slom/x.hpp": headers.Header("slom/x.hpp", "", entities + [kind])})
        self.assertEqual(found, [f"slom/x.hpp slom::{name}" for name in ("Thing", "Thing::Thing", "Thing::length", "b")])


if __name__ == "__main__":
    if not shutil.which("doxygen"):
        print("skipped: needs Debian's doxygen")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = sys.argv[1] if len(sys.argv) > 1 else folder
        unittest.main(argv=sys.argv[:1])
