# SPDX-License-Identifier: BSD-3-Clause
"""Every proxy keeps the conventions of the panels: help, units, visible properties, groups, icons, menu, colours."""
import os
import re
from xml.etree import ElementTree

import lacuna
from lacuna import classes
from paraview import servermanager
from paraview.simple import *

LoadPlugin(os.environ["LACUNA_PLUGIN"], ns=globals())

PLUGIN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Plugins", "Lacuna")
UNITS = re.compile(r"\b(mm|millimetres|mm²|mm³|mm/s|mm/min|degrees?|seconds?|s|pixels?|voxels?|MiB|percentile|percent|Hounsfield|"
                   r"grey levels?|in units of pi|turns per minute|g/cm³|unit of the (points|values)|no unit)\b|\b%|°", re.I)
# numbers that have no unit, or whose unit is the data's own; a new one is listed here after a thought
WITHOUT_UNIT = {
    "Ambient", "Diffuse", "Specular", "SpecularPower", "DepthCue", "SurfaceColor", "BackgroundColor", "Lights",
    "ViewDirection", "ViewUp", "Normal", "DefectDirection", "InsertionDirection", "Hemisphere", "GateRange", "Period", "OutputBounds",
    "InsideBounds", "OutsideBounds", "PixelAspect", "SpeckleLevel", "PresentFraction", "TissueFraction",
    "OutlierFraction", "ObjectOpacity", "Accuracy", "IsoValue", "IsoValues", "OutsideValue", "OutlierLimit",
    "Smoothing", "TimestepValues", "FootprintScale", "PaddingValue", "NoiseLevel", "TrueIsoValue", "Envelope",
    "OutputSpacing", "KernelSize", "Dilation", "StructureColors", "MinimumConfidence"}
# as lacuna::ValueRange describes it
RANGE = re.compile(r"(?:0 \((?P<zero>.*)\) or )?(?:a finite number|at most (?P<high>\S+)|from (?P<low>\S+) to (?P<high2>\S+)|"
                   r"above (?P<low2>\S+)(?: and at most (?P<high3>\S+))?|(?P<low3>\S+)(?P<unit3> .*)? or more)(?P<unit> .*)?")
# follow each other in the menu, as in the pipelines
PIPELINES = [
    ["AssembleTrackedSlices", "GateSlices", "SpeckleFilter", "SlicePlanes", "SliceRayCaster", "SweptVolume",
     "BSplineIsoRayCaster", "DepthMapShader"],
    ["BSplineIsoRayCaster", "DepthMapSurface", "Mirror", "RBFHoleFiller", "ImplantPlate", "DefectModel",
     "PressOrientation", "MillingToolPath"],
    ["ScanRegion", "ProbeCalibration", "TemporalCalibration", "SweptVolume"],
    ["OccludedAngle", "OcclusionSurface"]]
SMALL = {"OutlinedStructures": 2, "SliceOutliner": 2, "SkullBone": 2, "ScanRegion": 2, "TemporalCalibration": 1, "TrackedSliceWriter": 1, "SplineLoop": 1, "VolumeReader": 1,
         "OutlineReader": 0, "STEPWriter": 1}


def load():
    """name without Lacuna -> (group, element) of all proxies."""
    proxies = {}
    for folder in ("Sources", "Readers", "Filters"):
        for file in sorted(os.listdir(os.path.join(PLUGIN, folder))):
            for group in ElementTree.parse(os.path.join(PLUGIN, folder, file)).getroot():
                for proxy in group:
                    name = proxy.get("name")[len("Lacuna"):]
                    assert file == name + ".xml" and proxy.get("class") == "vtkLacuna" + name, (file, proxy.attrib)
                    proxies[name] = group.get("name"), proxy
    return proxies


def loaded_names():
    """Names of Lacuna's proxies that ParaView knows, without representations, which have no panel of their own."""
    session = servermanager.ProxyManager().SMProxyManager
    iterator = session.GetProxyDefinitionManager().NewIterator()
    names = set()
    iterator.InitTraversal()
    while not iterator.IsDoneWithTraversal():
        if iterator.GetProxyName().startswith("Lacuna") and iterator.GetGroupName() != "representations":
            names.add(iterator.GetProxyName()[len("Lacuna"):])
        iterator.GoToNextItem()
    return names


def properties(proxy):
    return [child for child in proxy if child.tag.endswith("Property")]


def settings(proxy):
    """Properties that a user sets in the panel (buttons, inputs and read-only ones aside)."""
    return [p for p in properties(proxy)
            if p.tag != "Property" and p.get("information_only") != "1" and p.get("panel_visibility") != "never"
            and (p.tag != "InputProperty" or p.find("Hints/SelectionInput") is not None)]


def check_help(name, proxy):
    text = proxy.find("Documentation")
    brief, detail = text.get("short_help"), text.get("long_help")
    assert brief and brief.endswith(".") and len(brief) <= 100, (name, brief)
    assert detail and detail.endswith(".") and len(detail) <= 200 and detail != brief, (name, detail)
    assert len(text.text.strip()) > 100, (name, "tooltip")
    for p in properties(proxy):
        help_text = p.findtext("Documentation", "").strip()
        assert help_text, (name, p.get("name"), "has no help")
        if p.tag == "DoubleVectorProperty" and p.get("name") not in WITHOUT_UNIT:
            assert UNITS.search(help_text), (name, p.get("name"), "says no unit", help_text)


def check_panel(name, proxy):
    shown = [p.get("name") for p in settings(proxy) if p.get("panel_visibility") != "advanced"]
    own_widget = [g for g in proxy.findall("PropertyGroup") if g.get("panel_widget")]
    in_own_widget = {p.get("name") for group in own_widget for p in group}
    for group in own_widget:  # shown as one
        members = [p.get("name") for p in group if p.get("name") in shown]
        shown = [p for p in shown if p not in members[1:]]
    if name in SMALL:
        assert len(shown) == SMALL[name], (name, shown)
    else:
        assert 3 <= len(shown) <= 6, (name, len(shown), shown)
    names = {p.get("name"): p for p in properties(proxy)}
    grouped = [p.get("name") for g in proxy.findall("PropertyGroup") for p in g.findall("Property")]
    assert set(grouped) <= set(names), (name, set(grouped) - set(names))
    advanced = [p.get("name") for p in settings(proxy) if p.get("panel_visibility") == "advanced"]
    if len(advanced) > 3:
        assert set(advanced) <= set(grouped), (name, "not in a group", set(advanced) - set(grouped))
    for group in proxy.findall("PropertyGroup"):
        assert group.get("label"), name
    for p in settings(proxy):  # ParaView writes no name beside a list
        if p.get("repeat_command") == "1" and p.tag != "InputProperty" and p.get("name") not in in_own_widget:
            words = re.sub(r"(?<!^)(?=[A-Z])", " ", p.get("name")).lower()
            labels = [g.get("label").lower() for g in proxy.findall("PropertyGroup")
                      if [member.get("name") for member in g] == [p.get("name")]]
            assert len(labels) == 1 and labels[0].startswith(words), (name, p.get("name"), labels)
    for p in proxy.findall("InputProperty"):  # ParaView asks only for those that are needed
        if p.find("Hints/Optional") is not None and p.find("Hints/SelectionInput") is None:
            assert p.get("panel_widget") == "input_selector", (name, p.get("name"), "cannot be set in the panel")
    for decorator in proxy.iter("PropertyWidgetDecorator"):
        if decorator.get("type") != "GenericDecorator":
            continue
        master = names[decorator.get("property")]
        known = {entry.get("value") for entry in master.iter("Entry")}
        values = set((decorator.get("value") or decorator.get("values")).split())
        assert values and (values <= known or not known), (name, decorator.attrib)
    for p in settings(proxy):
        domains = [child.tag for child in p if child.tag.endswith("Domain")]
        if p.tag == "IntVectorProperty" and p.get("name") not in ("Seed", "FrameRange", "FirstFrameNumber", "Stations"):
            assert domains, (name, p.get("name"), "has no domain")


def check_declared(name, proxy):
    """The choices, ranges and units of the XML are those that errors name."""
    table = classes.properties(getattr(lacuna, "vtkLacuna" + name)())
    faults = []
    for p in settings(proxy):
        allowed = table.get(p.get("name"), ("", None))[1]
        entries = [(entry.get("value"), entry.get("text")) for entry in p.iterfind("EnumerationDomain/Entry")]
        domain = next((d for d in p if d.tag in ("DoubleRangeDomain", "IntRangeDomain") and d.find("RequiredProperties") is None), None)
        if entries:
            choices = [f"{value} ({text})" for value, text in entries]
            fault = allowed != ", ".join(choices[:-1]) + " or " + choices[-1]
        elif allowed:
            fault = differs(RANGE.fullmatch(allowed), domain, p.find("Hints/LacunaLabel"))
        else:
            fault = domain is not None
        if fault:
            faults.append((name, p.get("name"), "errors say:", allowed, "XML:", ElementTree.tostring(p, encoding="unicode").split("<Documentation")[0]))
    assert not faults, "\n".join(map(str, faults))


def differs(range_, domain, label):
    """Whether what a panel shows of a number is not the range that an error names. A slider may end before the range does."""
    low = next((float(range_[key]) for key in ("low", "low2", "low3") if range_[key]), None)
    high = next((float(range_[key]) for key in ("high", "high2", "high3") if range_[key]), None)
    if range_["zero"] and low is not None:
        low = min(low, 0)
    shown = {}
    for end in ("min", "max"):
        if domain is not None and domain.get(end):
            shown[end], = {float(number) for number in domain.get(end).split()}  # the same for each element
    unit = (range_["unit"] or range_["unit3"] or "").strip().replace("degrees", "°").replace("^2", "²")
    if range_[0].endswith("a finite number"):
        unit = label.get("unit", "") if label is not None else ""
    return (shown.get("min") != low or shown.get("max", high) is not None and (high is None or shown.get("max", high) > high)
            or label is not None and (label.get("unit", ""), label.get("zero")) != (unit, range_["zero"]))


def check_icon(name, group, proxy, resources):
    entry = proxy.find("Hints/ShowInMenu")
    if group not in ("sources", "filters"):
        assert entry is None, (name, "is not in a menu")
        return
    assert entry.get("category") is None, (name, "LacunaMenus.xml has the categories")
    assert entry.get("icon") == f":/Lacuna/Icons/{name}.svg", (name, entry.attrib)
    assert f"Icons/{name}.svg" in resources, (name, "icon is not in lacuna.qrc")


def check_resources():
    folder = os.path.join(PLUGIN, "Resources")
    root = ElementTree.parse(os.path.join(folder, "lacuna.qrc")).getroot()
    icons, menus = root
    assert icons.get("prefix") == "/Lacuna" and menus.get("prefix") == "/Lacuna/ParaViewResources"
    assert [file.text for file in menus] == ["../LacunaMenus.xml"]
    listed = [file.text for file in icons]
    assert sorted(listed) == sorted("Icons/" + file for file in os.listdir(os.path.join(folder, "Icons"))), listed
    for file in listed:
        picture = ElementTree.parse(os.path.join(folder, file)).getroot()
        assert picture.get("viewBox") == "0 0 16 16", (file, "is not made for 16 pixels")
    return set(listed)


def check_menus(proxies):
    root = ElementTree.parse(os.path.join(PLUGIN, "LacunaMenus.xml")).getroot()
    for tag, group in (("ParaViewSources", "sources"), ("ParaViewFilters", "filters")):
        category, *common = root.find(tag)
        assert category.get("name") == "Lacuna" and category.get("preserve_order") == "1"
        entries = [entry.get("name")[len("Lacuna"):] for entry in category]
        expected = {name for name, (place, proxy) in proxies.items()
                    if place == group and proxy.find("Hints/ReaderFactory") is None}
        assert len(entries) == len(set(entries)) and set(entries) == expected, set(entries) ^ expected
        for entry, name in zip(category, entries):
            assert entry.get("group") == group and entry.get("icon") == f":/Lacuna/Icons/{name}.svg", entry.attrib
        icons = {entry.get("name"): entry.get("icon") for entry in category}
        for other in common:  # in ParaView's toolbar "Common"
            assert group == "filters" and other.get("name") == "Common", other.attrib
            assert len(other) <= 4 and all(icons[entry.get("name")] == entry.get("icon") for entry in other)
    for pipeline in PIPELINES:
        places = [entries.index(name) for name in pipeline]
        assert places == sorted(places), pipeline


def check_display(proxy, view, representation, array, title):
    """What is seen at the first Apply."""
    proxy.UpdatePipeline()
    display = Show(proxy, view)
    assert display.Representation == representation, (proxy, display.Representation)
    assert display.ColorArrayName[1] == array, (proxy, list(display.ColorArrayName))
    display.SetScalarBarVisibility(view, True)
    bar = GetScalarBar(GetColorTransferFunction(array), view)
    assert bar.Title == title, (array, bar.Title)
    return display


def views(proxy, active=None):
    """The kinds of views in which ParaView shows the outputs at the first Apply."""
    proxy.UpdatePipeline()
    controller = servermanager.vtkSMParaViewPipelineControllerWithRendering()
    opened = [controller.ShowInPreferredView(proxy.SMProxy, port, active and active.SMProxy)
              for port in range(proxy.SMProxy.GetNumberOfOutputPorts())]
    return [view.GetXMLName() if view else None for view in opened]


def check_displays():
    view = CreateRenderView()
    head = SkullPhantom()
    check_display(head, view, "Slice", "HounsfieldUnits", "Hounsfield units (HU)")
    sweep = PhantomSweep(NumberOfSlices=4)
    check_display(sweep, view, "Slice", "Intensity", "Grey level")
    volume = SweptVolume(Input=sweep)
    assert views(volume, view) == ["RenderView"]
    assert GetDisplayProperties(volume, view).ColorArrayName[1] == "Intensity", "as its input"
    depth = BSplineIsoRayCaster(Input=head, PixelSpacing=3)
    check_display(depth, view, "Slice", "Depth", "Depth (mm)")
    assert GetColorTransferFunction("Depth").NanOpacity == 0
    check_display(DepthMapSurface(Input=depth), view, "Surface", "Depth", "Depth (mm)")
    check_display(DepthMapShader(Input=depth), view, "Slice", "Color", "Brightness")
    filled = RBFHoleFiller(Input=depth, NodeSpacing=3)
    display = check_display(filled, view, "Slice", "Depth", "Depth (mm)")
    display.SMProxy.SetScalarColoring("Deviation", 0)
    display.SMProxy.RescaleTransferFunctionToDataRange(False, False)  # as the panel does
    points = list(GetColorTransferFunction("Deviation").RGBPoints)
    assert points[0] == -points[-4] < 0 and points[4] == 0, points
    assert points[5] == points[6] == points[7] and points[1] < points[3] and points[-3] > points[-1], points
    display.SMProxy.SetScalarColoring("FilledMask", 0)
    masks = GetColorTransferFunction("FilledMask")
    assert masks.InterpretValuesAsCategories == 1
    assert list(masks.Annotations) == ["0", "as measured", "1", "filled"], list(masks.Annotations)
    valid = GetColorTransferFunction("vtkValidPointMask")
    assert list(valid.IndexedColors)[:3] == [1, 1, 0], "what is not valid is yellow"
    model = DefectModel(Input=filled)
    check_display(model, view, "Surface", "ModelFace", "Face of the model")
    assert views(model) == ["RenderView", None], "Top is in the coordinates of a press"
    assert views(ContrastToSpeckle(Input=head, InsideBounds=[-9, 9] * 3)) == ["SpreadSheetView"]
    shape = IncompleteShape(Shape="Sphere", Dimensions=[28, 28, 28])
    check_display(OccludedAngle(Input=shape, NumberOfDirections=20), view, "Slice", "Object", "Object")


def main():
    proxies = load()
    assert loaded_names() == set(proxies), loaded_names() ^ set(proxies)
    resources = check_resources()
    check_menus(proxies)
    faults = []
    for name, (group, proxy) in sorted(proxies.items()):
        for check in (check_help, check_panel, check_declared):
            try:
                check(name, proxy)
            except AssertionError as fault:
                faults.append(str(fault))
        check_icon(name, group, proxy, resources)
    assert not faults, "\n".join(faults)
    check_displays()
    print(f"{len(proxies)} proxies keep the conventions")


main()
