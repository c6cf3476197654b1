class Error(Exception):
    """A mistake of the caller, or input that cannot be used. Its text is `[id] sentence`.

    id        stable between versions, such as `slom.bad-option`
    subject   the name of the thing: a variable, an option, an argument, a file; empty if nothing has a name
    sentence  the fault and the remedy
    remedy    what to do; empty if there is none

    >>> try:
    ...     slom.Estimator().variable("one", "x")
    ... except slom.Error as error:
    ...     print(error.id)
    slom.bad-value
    """

    id: str
    subject: str
    sentence: str
    remedy: str

    def __init__(self, text: str = "", subject: str = "") -> None:
        super().__init__(text)
        self.id, _, self.sentence = text[1:].partition("] ") if text.startswith("[") else ("", "", text)
        self.subject = subject
        self.remedy = self.sentence.rpartition("; ")[2] if "; " in self.sentence else ""


class SlowFunctionWarning(UserWarning):
    """A measurement function cannot be recorded. It is called for each measurement, with numeric derivatives."""
