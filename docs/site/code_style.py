"""Colours of code and console output, light and dark: each has a contrast of at least 7:1 on its background (WCAG 2.1, level AAA), which
tests/docs/contrast_test.py checks."""
from pygments.style import Style
from pygments.token import Comment, Error, Generic, Keyword, Literal, Name, Number, Operator, Punctuation, String, Text, Token, Whitespace


def styles(text, comment, keyword, type_, string, number, preprocessor, output, bad, good):
    """The colours of the kinds of tokens; those without an entry have that of the kind that they belong to."""
    return {Token: text, Text: text, Whitespace: "", Error: bad, Comment: f"italic {comment}", Comment.Preproc: f"noitalic {preprocessor}",
            Comment.PreprocFile: f"noitalic {string}", Keyword: f"bold {keyword}", Keyword.Type: f"nobold {type_}",
            Operator: text, Operator.Word: f"bold {keyword}", Punctuation: text, Name: text, Name.Builtin: type_, Name.Class: type_,
            Name.Function: type_, Name.Namespace: text, Name.Decorator: preprocessor, Name.Exception: type_, Name.Tag: type_,
            Name.Attribute: number, Name.Variable: number, Name.Constant: number, Literal: number, Number: number, String: string,
            String.Escape: f"bold {string}", Generic.Output: output, Generic.Prompt: f"bold {comment}", Generic.Heading: f"bold {type_}",
            Generic.Subheading: f"bold {type_}", Generic.Deleted: bad, Generic.Inserted: good, Generic.Error: bad, Generic.Traceback: bad,
            Generic.Emph: "italic", Generic.Strong: "bold"}


class Light(Style):
    background_color = "#f4f4f4"
    highlight_color = "#ffffcc"
    styles = styles(text="#1a1a1a", comment="#4d4d4d", keyword="#00501e", type_="#00407a", string="#7d1f00", number="#5a2a85",
                    preprocessor="#653a00", output="#2b2b2b", bad="#8b0000", good="#00501e")


class Dark(Style):
    background_color = "#202020"
    highlight_color = "#3d3d00"
    styles = styles(text="#e2e2e2", comment="#b5b5b5", keyword="#8fd460", type_="#8cc8ff", string="#f3bc63", number="#d3b8ff",
                    preprocessor="#ffb78f", output="#dcdcdc", bad="#ffb3b3", good="#8fd460")
