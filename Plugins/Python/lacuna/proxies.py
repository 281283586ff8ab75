# SPDX-License-Identifier: BSD-3-Clause
"""What the plugin's XML says of its sources, readers, filters and writers: the one truth behind lacuna.help, the stubs for completion
and the guide's parameter tables.

Needs neither VTK nor ParaView: the build (Plugins/Python/make_stubs.py), the site (Documentation/Site/stage.py) and
Testing/Tools/check-parameters.py use it as a file of its own.
"""
import glob
import os
import re
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.normpath(os.path.join(HERE, "..", "..", ".."))  # of the sources
INSTALLED = os.path.join(HERE, "proxies.xml")  # beside the package
NOT_GIVEN = "1e299"  # a length that cannot be meant: the filter takes its own


@dataclass
class Property:
    name: str
    kind: str  # Double, Int, String, IdType, Input, Proxy, or empty for a button
    help: str
    advanced: bool
    hidden: bool
    information: bool
    default: list  # texts, as in the XML
    entries: dict  # of an enumeration: value to text
    boolean: bool
    low: list
    high: list
    choices: list  # of a proxy property: names of what it can be
    optional: bool
    count: int  # of values; 0: any number
    label: str  # empty: the name's words
    group: str = ""

    @property
    def python(self):
        """The name in Python, which ParaView makes of the label."""
        return re.sub(r"[^A-Za-z0-9_]", "", self.label) or self.name

    @property
    def in_python(self):
        """Whether it is an attribute that scripts read or set: buttons, and information that no panel shows, are not."""
        return bool(self.kind) and (not self.information or self.advanced or self.name == "TimestepValues")

    def default_text(self):
        """As a person reads it: on and off, names of choices, empty."""
        if self.kind == "Input":
            return "none" if self.optional else ""
        if self.kind == "Proxy":
            return spaced(self.choices[0]) if self.choices else ""
        if self.boolean:
            return "on" if self.default == ["1"] else "off"
        if self.entries:
            return " ".join(self.entries[value] for value in self.default)
        if not self.default:
            return "empty" if self.kind == "String" else ""
        if self.default[0] == NOT_GIVEN:
            return "not given"
        return " ".join(self.default)

    def values_text(self):
        """What it can be, as far as the XML tells."""
        if self.kind == "Proxy":
            return ", ".join(map(spaced, self.choices))
        if self.entries:
            return ", ".join(self.entries.values())
        low, high = single(self.low), single(self.high)
        if low == "0" and re.search(r"[(,] ?above 0\b", self.help):
            return f"above 0, to {high}" if high else "above 0"
        if low and high:
            return f"{low} to {high}"
        return f"{low} or more" if low else f"at most {high}" if high else ""


@dataclass
class Proxy:
    name: str
    cls: str
    label: str
    short_help: str
    kind: str  # source, reader, filter, writer, or the name of another group
    extensions: str
    help: str
    properties: list = field(default_factory=list)

    @property
    def page(self):
        """The user guide's page, its file name without .md."""
        return re.sub(r"[^a-z0-9]+", "-", self.label.lower())

    @property
    def constructor(self):
        """The name in Python, which ParaView makes of the label."""
        return re.sub(r"\W", "", self.label)


def spaced(name):
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name.removeprefix("Lacuna"))


def single(numbers):
    """'0' of ['0', '0', '0']; all of them where they differ."""
    return numbers[0] if len(set(numbers)) == 1 else " ".join(numbers)


def words(text):
    return "\n\n".join(" ".join(part.split()) for part in re.split(r"\n\s*\n", (text or "").strip()))


def read_property(element):
    def find(tag):
        return element.find(tag) if element.find(tag) is not None else ET.Element(tag)

    ranges = [domain for tag in ("DoubleRangeDomain", "IntRangeDomain") for domain in element.findall(tag)]
    domain = ranges[0] if ranges else ET.Element("none")
    default = element.get("default_values", "")
    if element.find("EnumerationDomain") is not None and domain.get("default_mode") == "min":
        default = find("EnumerationDomain")[0].get("value")  # default_values are those of states from before
    return Property(
        name=element.get("name"), kind=re.sub(r"(Vector)?Property$", "", element.tag), help=words(find("Documentation").text),
        advanced=element.get("panel_visibility") == "advanced", hidden=element.get("panel_visibility") == "never",
        information=element.get("information_only") == "1", default=default.split(),
        entries={entry.get("value"): entry.get("text") for entry in find("EnumerationDomain")},
        boolean=element.find("BooleanDomain") is not None,
        low=domain.get("min", "").split(), high=domain.get("max", "").split(),
        choices=[choice.get("name") for choice in find("ProxyListDomain")],
        optional=element.find("Hints/Optional") is not None,
        count=0 if element.get("repeat_command") == "1" else int(element.get("number_of_elements", "1")),
        label=element.get("label", ""))


def read_proxy(element, group):
    documentation = element.find("Documentation")
    factory = element.find("Hints/ReaderFactory[@extensions]")
    if factory is None:
        factory = element.find("Hints/WriterFactory")
    kind = "reader" if element.find("Hints/ReaderFactory") is not None else group.removesuffix("s")
    proxy = Proxy(name=element.get("name"), cls=element.get("class"), label=element.get("label"),
                  short_help=documentation.get("short_help"), kind=kind,
                  extensions="" if factory is None else " ".join(dict.fromkeys(factory.get("extensions").lower().split())),
                  help=words(documentation.text),
                  properties=[read_property(child) for child in element
                              if child.tag.endswith("Property") and child.get("is_internal") != "1"])
    for panel in element.findall("PropertyGroup"):
        members = [member.get("name") for member in panel]
        for own in proxy.properties:
            if own.name in members:
                own.group = panel.get("label", "")
    return proxy


def read_files(paths):
    """All proxies of XML files, by label."""
    proxies = [read_proxy(element, group.get("name"))
               for path in paths for group in ET.parse(path).getroot().findall("ProxyGroup") for element in group
               if element.get("label")]
    return sorted(proxies, key=lambda proxy: proxy.label.lower())


def read_proxies(root=ROOT):
    """All proxies of Plugins/Lacuna in the sources, by label."""
    return read_files(glob.glob(os.path.join(root, "Plugins", "Lacuna", "*", "*.xml")))
