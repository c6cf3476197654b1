"""The check of what shared libraries export finds what they should not: exports_test.py COMPILER"""
import importlib.machinery
import importlib.util
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
CHECK = str(pathlib.Path(__file__).resolve().parents[3] / "packaging/check_exports")
LOADER = importlib.machinery.SourceFileLoader("check_exports", CHECK)
check_exports = importlib.util.module_from_spec(importlib.util.spec_from_loader("check_exports", LOADER))
LOADER.exec_module(check_exports)
COMPILER = sys.argv.pop()

# Ten functions that slom/io declares, and what may not be exported.
SOURCE = """
namespace slom::io {
template <int> int openInput() { return 0; }
template int openInput<0>(); template int openInput<1>(); template int openInput<2>(); template int openInput<3>(); template int openInput<4>();
template int openInput<5>(); template int openInput<6>(); template int openInput<7>(); template int openInput<8>(); template int openInput<9>();
#ifdef FAULTS
struct Scene { struct Inner { void fillByPrivateMeans(); }; };
void Scene::Inner::fillByPrivateMeans() {}
void readWholeByPrivateMeans() {}
#endif
}
#ifdef FAULTS
namespace slom { void optimize() {} }
namespace fmt { struct Buffer { virtual ~Buffer(); }; Buffer::~Buffer() {} }
#endif
"""


class Exports(unittest.TestCase):
    def faults(self, *flags):
        with tempfile.TemporaryDirectory() as folder:
            source, library = pathlib.Path(folder, "a.cpp"), pathlib.Path(folder, "libslom_io.so.0")
            source.write_text(SOURCE, encoding="utf-8")
            subprocess.run([COMPILER, "-std=c++20", "-shared", "-fPIC", *flags, source, "-o", library], check=True)
            return [fault.split(" exports ")[1] for fault in check_exports.faults(str(library), check_exports.public_words())]

    def test_that_are_meant_to_be_are_none(self):
        self.assertEqual(self.faults(), [])

    def test_that_are_not_meant_to_be_are_named(self):
        self.assertEqual(sorted(set(self.faults("-DFAULTS"))), [
            "fmt::Buffer::~Buffer(), which is not of slom::io::",
            "slom::io::Scene::Inner::fillByPrivateMeans(), which no header in include/ declares",
            "slom::io::readWholeByPrivateMeans(), which no header in include/ declares",
            "slom::optimize(), which is not of slom::io::",
            "typeinfo for fmt::Buffer, which is not of slom::io::",
            "typeinfo name for fmt::Buffer, which is not of slom::io::",
            "vtable for fmt::Buffer, which is not of slom::io::",
        ])

    def test_names_are_those_without_types(self):
        for symbol, name in (
                ("slom::Summary slom::Estimator::optimize(slom::Options const&)", "slom::Estimator::optimize"),
                ("vtable for slom::Foo<Eigen::Matrix<double, 3, 1> >", "slom::Foo"),
                ("std::ostream& slom::detail::operator<< <int>(std::ostream&, int)", "slom::detail::operator<<"),
                ("slom::Foo::operator bool() const", "slom::Foo::operator bool"),
                ("slom::X::operator()(int) const", "slom::X::operator()"),
                ("std::string slom::text[abi:cxx11](int)", "slom::text")):
            self.assertEqual(check_exports.qualified_name(symbol), name)


if __name__ == "__main__":
    unittest.main()
