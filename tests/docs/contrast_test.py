"""Every colour of code and console output is readable on its background, light and dark: contrast_test.py HTML

The colours are those of docs/site/code_style.py and, where scripts/docs has built the site in the folder HTML, of its style sheet, too.
Exit code 77: skipped, because Pygments is not there.
"""
import pathlib
import re
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs/site"))
try:
    import code_style
except ImportError:
    print("skipped: needs Debian's python3-pygments")
    sys.exit(77)

HTML = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else None
LEAST = 7  # level AAA; level AA is 4.5


def luminance(colour):
    """Relative luminance of #rgb or #rrggbb, as WCAG 2.1 defines it."""
    digits = colour.lstrip("#")
    digits = "".join(2 * digit for digit in digits) if len(digits) == 3 else digits
    linear = []
    for i in (0, 2, 4):
        s = int(digits[i:i + 2], 16) / 255
        linear.append(s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4)
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one, other):
    darker, lighter = sorted([luminance(one), luminance(other)])
    return (lighter + 0.05) / (darker + 0.05)


def too_pale_in_style(style):
    """The kinds of tokens whose contrast is too low, with the contrast."""
    found = {}
    for token, look in style:
        colour = f"#{look['color']}" if look["color"] else "#000000"
        ratio = contrast(colour, f"#{look['bgcolor']}" if look["bgcolor"] else style.background_color)
        if look["color"] and ratio < LEAST:
            found[str(token)] = round(ratio, 2)
    return found


def too_pale_in_sheet(text):
    """The rules of a style sheet of Pygments whose contrast is too low. Line numbers, which the site has not, are left out."""
    backgrounds, found = {}, {}
    rules = re.findall(r"^((?:body\S*|) ?\.highlight[^{]*?)\s*\{([^}]*)\}", text, re.MULTILINE)
    for selector, body in rules:
        if selector.endswith(".highlight"):
            backgrounds[selector] = re.search(r"background(?:-color)?: (#\w+)", body).group(1)
    for selector, body in rules:
        colour = re.search(r"(?<![-\w])color: (#\w+)", body)
        if colour and "linenos" not in selector:
            ratio = contrast(colour.group(1), backgrounds[selector.partition(".highlight")[0] + ".highlight"])
            if ratio < LEAST:
                found[selector] = round(ratio, 2)
    return len(rules), found


class Contrast(unittest.TestCase):
    def test_is_that_of_the_standard(self):
        self.assertAlmostEqual(contrast("#ffffff", "#000"), 21)
        self.assertAlmostEqual(contrast("#888888", "#f0f0f0"), 3.11, 2)  # too pale

    def test_of_the_styles(self):
        for style in [code_style.Light, code_style.Dark]:
            self.assertEqual(too_pale_in_style(style), {}, style.__name__)

    def test_a_pale_colour_is_noticed(self):
        class Pale(code_style.Light):
            styles = {**code_style.Light.styles, code_style.Generic.Output: "#888888"}
        self.assertEqual(list(too_pale_in_style(Pale)), ["Token.Generic.Output"])
        sheet = ".highlight { background: #f0f0f0; }\n.highlight .go { color: #888888 } /* Generic.Output */\n"
        self.assertEqual(too_pale_in_sheet(sheet), (2, {".highlight .go": 3.11}))

    def test_of_the_built_site(self):
        sheet = HTML / "_static/pygments.css" if HTML else None
        if sheet is None or not sheet.exists():
            self.skipTest(f"no site in {HTML}; scripts/docs builds it")
        rules, pale = too_pale_in_sheet(sheet.read_text(encoding="utf-8"))
        self.assertGreater(rules, 100)
        self.assertEqual(pale, {})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
