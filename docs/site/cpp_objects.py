"""The search finds classes, functions and members; not parameters, of which each function has some."""
from sphinx.domains.cpp import CPPDomain


class Objects(CPPDomain):
    def get_objects(self):
        return (each for each in super().get_objects() if each[2] not in ("functionParam", "templateParam"))


def setup(app):
    app.add_domain(Objects, override=True)
    return {"parallel_read_safe": True}
