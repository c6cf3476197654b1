"""The public headers as Doxygen reads them: what there is, how it is declared, what its comment says.

`read(folder)` has Doxygen write XML into the folder and returns the headers. Names in namespaces `detail`, private members and
specialisations of templates are left out.
"""
import dataclasses
import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree as xml

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).resolve().parent


@dataclasses.dataclass
class Entity:
    kind: str                # class, struct, function, variable, typedef, enum, enumvalue, concept, define, friend
    name: str                # without scope
    scope: str               # "slom::Estimator"; empty for macros
    header: str              # "slom/estimator.hpp"
    line: int
    comment: str             # its lines as they stand in the header, empty without any
    template: str = ""       # "template<class T>" or several of them
    requirement: str = ""    # what stands after requires
    type: str = ""
    arguments: str = ""      # of a function with what follows them, of a macro
    initial: str = ""
    words: tuple = ()        # static, explicit, virtual, override, default, strong
    members: list = dataclasses.field(default_factory=list)

    @property
    def qualified(self):
        return f"{self.scope}::{self.name}" if self.scope else self.name


@dataclasses.dataclass
class Header:
    name: str
    comment: str
    entities: list


def text(element):
    return "" if element is None else " ".join("".join(element.itertext()).split())


def comment_of(element):
    """All verbatim text of the descriptions, without the slashes that Doxygen leaves in it."""
    parts = []
    for tag in ("briefdescription", "detaileddescription"):
        found = element.find(tag)
        for verbatim in found.iter("verbatim") if found is not None else ():
            lines = [re.sub(r"^\s*/// ?", "", line).rstrip() for line in (verbatim.text or "").split("\n")]
            parts.append("\n".join(lines).strip("\n"))
    return "\n".join(parts).strip("\n")


def template_of(element):
    found = element.find("templateparamlist")
    if found is None:
        return ""
    parts = []
    for param in found.findall("param"):
        part = text(param.find("type"))
        name, default = text(param.find("declname")), text(param.find("defval"))
        if name and not re.search(rf"\b{re.escape(name)}$", part):
            part += f" {name}"
        parts.append(part + (f" = {default}" if default else ""))
    return f"template<{', '.join(parts)}>"


def is_hidden(qualified):
    return bool({"detail", "Eigen", "std", "internal"} & set(qualified.split("::"))) or "<" in qualified or "@" in qualified


def member(element, scope, kind_of_scope):
    location, kind = element.find("location"), element.get("kind")
    name = text(element.find("name"))
    words = [word for word, attribute in [("static", "static"), ("explicit", "explicit")] if element.get(attribute) == "yes"]
    arguments = text(element.find("argsstring"))
    if element.get("virt") in ("virtual", "pure-virtual"):
        words.append("virtual")
    if re.search(r"\boverride\b", arguments):
        words.append("override")
    if element.get("strong") == "yes":
        words.append("strong")
    entity = Entity(kind, name, scope, location.get("file"), int(location.get("line")), comment_of(element), template_of(element),
                    text(element.find("requiresclause")), text(element.find("type")), arguments, text(element.find("initializer")), tuple(words))
    if kind == "define":
        entity.arguments = ", ".join(text(param.find("defname")) for param in element.findall("param"))
        entity.arguments = f"({entity.arguments})" if element.find("param") is not None else ""
        entity.scope = entity.initial = ""
    for value in element.findall("enumvalue"):
        entity.members.append(Entity("enumvalue", text(value.find("name")), entity.qualified, entity.header, entity.line, comment_of(value),
                                     initial=text(value.find("initializer"))))
    return entity


def compound(element):
    """(the entity, whether it is public) of a class or concept."""
    name, location = text(element.find("compoundname")), element.find("location")
    scope, _, short = name.rpartition("::")
    entity = Entity(element.get("kind"), short, scope, location.get("file"), int(location.get("line")), comment_of(element),
                    template_of(element), text(element.find("requiresclause")))
    for section in element.findall("sectiondef"):
        for each in section.findall("memberdef"):
            if each.get("prot") == "public" and not is_hidden(text(each.find("name")).replace("<", "").replace("std", "")):
                entity.members.append(member(each, name, "class"))
    bases = [text(base) for base in element.findall("basecompoundref") if base.get("prot") == "public" and not is_hidden(text(base).split("<")[0])]
    entity.type = ", ".join(bases)
    return entity, element.get("prot", "public") == "public"


def run_doxygen(folder):
    settings = (f"@INCLUDE = {HERE}/Doxyfile\nINPUT = {ROOT}/include\nSTRIP_FROM_PATH = {ROOT}/include\nOUTPUT_DIRECTORY = {folder}\n"
                f'INPUT_FILTER = "{sys.executable} {HERE}/raw_comments.py"\n')
    pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
    subprocess.run(["doxygen", "-"], input=settings, text=True, check=True, stdout=subprocess.DEVNULL)


def read(folder):
    """{name of the header: Header} of all public headers."""
    run_doxygen(folder)
    headers, classes, loose, private = {}, {}, [], []
    for path in sorted(pathlib.Path(folder, "xml").glob("*.xml")):
        for element in xml.parse(path).getroot().findall("compounddef"):
            kind, name = element.get("kind"), text(element.find("compoundname"))
            if kind == "file":
                file = element.find("location").get("file")
                headers[file] = Header(file, comment_of(element), [])
                for each in element.iter("memberdef"):
                    if each.get("kind") == "define":
                        loose.append(member(each, "", "file"))
            elif kind in ("class", "struct", "union", "concept") and not is_hidden(name):
                entity, is_public = compound(element)
                if is_public:
                    classes[name] = entity
                else:
                    private.append(f"{name}::")
            elif kind == "namespace" and not is_hidden(name):
                loose += [member(each, name, "namespace") for each in element.iter("memberdef")]
    for name, entity in classes.items():
        if name.startswith(tuple(private)):
            continue
        (classes[entity.scope].members if entity.scope in classes else loose).append(entity)
    for entity in loose:
        if entity.header in headers and not is_hidden(re.sub(r"operator\W+$", "operator", entity.qualified)):
            headers[entity.header].entities.append(entity)
    for header in headers.values():
        sort_entities(header.entities)
    return headers


def sort_entities(entities):
    entities.sort(key=lambda entity: entity.line)
    for entity in entities:
        if entity.kind != "enum":
            sort_entities(entity.members)
