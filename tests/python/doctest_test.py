"""The examples in the docstrings of the package print what they say."""

import doctest
import inspect
import unittest

import numpy as np

import slom

# What has to have an example.
NEED = """array curve_fit Error Estimator Estimator.covariance Estimator.measure Estimator.outliers Estimator.prior
Estimator.profile Estimator.propagate Estimator.variable Estimator.variables FixedLag Huber load manifold Rows S2 SE2 SE3 SO2
SO3 Variable.bound Variable.fix where""".split()


def documented():
    """The docstrings of the public names, and of the members of the classes among them."""
    places = {name: getattr(slom, name) for name in slom.__all__}
    found = {"slom": slom.__doc__}
    for name, value in places.items():
        found[name] = value.__doc__
        if inspect.isclass(value):
            for member, own in vars(value).items():
                own = getattr(own, "__func__", own)
                if not member.startswith("_"):
                    found[f"{name}.{member}"] = own.__doc__
    return found


class Docstrings(unittest.TestCase):
    maxDiff = None

    def test_examples_print_what_they_say(self):
        parser, runner = doctest.DocTestParser(), doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
        have, said = set(), []
        for name, text in documented().items():
            test = parser.get_doctest(text or "", {"slom": slom, "np": np}, name, None, None)
            if not test.examples:
                continue
            have.add(name)
            runner.run(test, out=said.append)
        self.assertEqual("".join(said), "")
        self.assertEqual(set(NEED) - have, set())

    def test_public_names_are_documented(self):
        for name, text in documented().items():
            if "." not in name:
                self.assertTrue(text and text.strip(), name)


if __name__ == "__main__":
    unittest.main()
