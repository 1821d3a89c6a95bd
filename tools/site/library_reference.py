"""From Doxygen's XML to pages of Sphinx's C++ domain, one a module, its public headers in order.

Breathe would do the same, but writes the namespace anew for every header, which takes minutes and repeats every declaration.
"""
import re
import xml.etree.ElementTree as ElementTree
from collections import defaultdict
from pathlib import Path

NAMESPACE = "bespoke::"


def escaped(text):
    """As plain text for reStructuredText, `names` in it as code."""
    parts = re.split(r"(?<!\w)`([^`]+)`(?!\w)", text)
    plain = [re.sub(r"([*`|_\\])", r"\\\1", part) for part in parts[::2]]
    code = [f"``{part}``" for part in parts[1::2]] + [""]
    return "".join(a + b for a, b in zip(plain, code))


def inline(element):
    """The text of an element, code in it as code."""
    parts = [escaped(element.text or "")]
    for child in element:
        if child.tag == "computeroutput":
            parts.append(f"``{''.join(child.itertext()).strip()}``")
        elif child.tag not in ("itemizedlist", "verbatim"):
            parts.append(inline(child))
        parts.append(escaped(child.tail or ""))
    return " ".join("".join(parts).split())


def comment(element):
    """A declaration's comment, one paragraph each, lists as lists."""
    paragraphs = []
    for paragraph in element.findall("detaileddescription/para"):
        paragraphs.append(inline(paragraph))
        paragraphs += ["- " + inline(item) for item in paragraph.iter("listitem")]
        paragraphs += ["::\n\n" + indented(block.text or "") for block in paragraph.iter("verbatim")]
    # Doxygen has taken the first sentence off the first paragraph.
    first = " ".join(inline(paragraph) for paragraph in element.findall("briefdescription/para"))
    return [f"{first} {''.join(paragraphs[:1])}".strip(), *paragraphs[1:]]


def indented(text):
    return "\n".join("   " + line if line else line for line in text.splitlines())


def directive(kind, declaration, paragraphs, inner=()):
    """One declaration with its comment and what stands in it."""
    lines = [f".. cpp:{kind}:: {' '.join(declaration.split())}", ""]
    for block in [*paragraphs, *inner]:
        lines += [indented(block), ""]
    return "\n".join(lines)


def text_of(element, tag):
    found = element.find(tag)
    return "" if found is None else "".join(found.itertext()).strip()


def template_of(element):
    parameters = element.findall("templateparamlist/param")
    if not parameters:
        return ""
    words = [f"{text_of(p, 'type')} {text_of(p, 'declname')}".strip() for p in parameters]
    return f"template <{', '.join(words)}> "


def enum(member):
    kind = "enum-class" if member.get("strong") == "yes" else "enum"
    values = [directive("enumerator", text_of(value, "name"), comment(value)) for value in member.findall("enumvalue")]
    return directive(kind, text_of(member, "name"), comment(member), values)


def declared(member):
    """A member of a class or of the namespace as a directive."""
    kind, name, type_name = member.get("kind"), text_of(member, "name"), text_of(member, "type")
    if kind == "enum":
        return enum(member)
    if kind == "typedef":
        return directive("type", f"{template_of(member)}{name} = {type_name}", comment(member))
    if kind == "variable":
        value = text_of(member, "initializer")
        # Long tables of values are the headers' own business.
        shown = f" {value}" if len(value) < 60 and "{" not in value else ""
        return directive("member", f"{type_name} {name}{text_of(member, 'argsstring')}{shown}", comment(member))
    arguments = re.sub(r"\s*=\s*(0|default|delete)$", "", text_of(member, "argsstring"))
    words = [word for word in ("static", "explicit") if member.get(word) == "yes"]
    words += ["virtual"] if member.get("virt", "non-virtual") != "non-virtual" and "override" not in arguments else []
    declaration = f"{' '.join(words)} {type_name} {name}{arguments}"
    return directive("function", template_of(member) + declaration, comment(member))


class Library:
    """What the public headers declare, as Doxygen has read them."""

    def __init__(self, xml):
        self.xml = Path(xml)
        self.by_header = defaultdict(list)  # header: (line, directive)
        seen = set()
        for compound in ElementTree.parse(self.xml / "index.xml").getroot():
            if compound.get("kind") in ("struct", "class", "namespace") and not compound.get("refid") in seen:
                self.add(ElementTree.parse(self.xml / f"{compound.get('refid')}.xml").getroot()[0])
                seen.add(compound.get("refid"))

    def add(self, compound):
        name = text_of(compound, "compoundname")
        if compound.get("kind") == "namespace":
            if name == NAMESPACE.strip(":"):
                for member in compound.findall("sectiondef/memberdef"):
                    self.note(member, declared(member))
        elif name.startswith(NAMESPACE) and compound.get("prot") == "public":
            self.note(compound, self.class_of(compound, name))

    def note(self, element, text):
        place = element.find("location")
        self.by_header[place.get("file")].append((int(place.get("line")), text))

    def class_of(self, compound, name):
        bases = [f"{base.get('prot')} {base.text}" for base in compound.findall("basecompoundref")]
        derived = f" : {', '.join(bases)}" if bases else ""
        members = [member for section in compound.findall("sectiondef") if section.get("kind").startswith("public")
                   for member in section.findall("memberdef")]
        members.sort(key=lambda member: int(member.find("location").get("line")))
        inner = dict.fromkeys(declared(m) for m in members if m.get("kind") != "friend")
        kind, name = compound.get("kind"), name.removeprefix(NAMESPACE)
        return directive(kind, f"{template_of(compound)}{name}{derived}", comment(compound), inner)

    def page(self, module, headers):
        """The page of one module as reStructuredText; `headers` as programs include them."""
        title = module or "beside the modules"
        lines = [title, "=" * len(title), ""]
        if module:
            lines += [f"What this module is for: :doc:`its page </src/bespoke/{module}/README>`.", ""]
        lines += [".. cpp:namespace:: bespoke", ""]
        for header in headers:
            lines += [header, "-" * len(header), ""]
            for text in dict.fromkeys(text for _, text in sorted(self.by_header[header])):
                lines += [text, ""]
        return "\n".join(lines)
