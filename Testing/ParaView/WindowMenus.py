# SPDX-License-Identifier: BSD-3-Clause
"""Every entry of Sources > Lacuna and Filters > Lacuna in the ParaView application: chosen, Apply with defaults, and there is something.
After an error of one of them the view and the Information panel are empty, and the next good value brings both back.

Those that the other Window tests make from the menu (of a CT to its files) are not made again, but must be in the menu.
Polhemus Video Source is in LiveToolbar.py.
"""
import os
from xml.etree import ElementTree

import lacuna_window

ERROR = "Stride is 0; it must be 1 or more"
MENUS = "LACUNA_MENUS"  # names of the proxies in the menus, without Lacuna
ELSEWHERE = {"PolhemusVideoSource", "SliceOutliner", "SkullPhantom", "BSplineIsoRayCaster", "DepthMapSurface", "Mirror", "RBFHoleFiller",
             "ImplantPlate", "DefectModel", "PressOrientation", "MillingToolPath"}


def test(window):
    import calibration_scans as scans
    import lacuna_test
    import numpy as np
    from paraview.simple import (BSplineIsoRayCaster, Calculator, GetActiveSource, GetSources, SetActiveSource, SkullPhantom, Slice, Sphere,
                                 Transform)
    from tracked_slice_files import open_slices
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader
    made, faults = {}, []

    def label(source):
        return source.SMProxy.GetXMLLabel()

    def make(group, text, source=None, others=None, slow=False, says="", **settings):
        """From the menu, on a source that is selected. others: of the inputs that ParaView asks for; slow: it asks whether to go on; says: what it warns of."""
        if source:
            if "TimeArray" in source.ListProperties():  # of a file. As the panel has it: otherwise Apply has the
                source.TimeArray = "None"  # file read again beside a chart, where ParaView 6.1 may end (reports.md)
            source.UpdatePipeline()
        SetActiveSource(source)
        window.wait(50)

        def choose_inputs():
            for name, one in (others or {}).items():
                window.press(name)
                window.select("pipelineView", names()[one])
            window.press("OK")
        window.menu(f"{group}/Lacuna/{text}", *[choose_inputs] * bool(others), *[lambda: window.press("Yes")] * slow)
        proxy = GetActiveSource()
        assert label(proxy) == text, (label(proxy), text)
        for name, value in settings.items():
            setattr(proxy, name, value)
        window.press(lacuna_window.ACCEPT)
        said = window.take_messages()
        if says not in said or (said and not says):
            faults.append(f"{text}: {said}")
        made[proxy.SMProxy.GetXMLName()[len("Lacuna"):]] = proxy
        rows = proxy.GetDataInformation().DataInformation.GetNumberOfRows()
        count = proxy.GetDataInformation().GetNumberOfPoints() + max(rows, 0)
        if count == 0:
            faults.append(f"{text}: nothing after the first Apply")
        print(f"{text}: {count} points", flush=True)
        return proxy

    def look():
        """The colours of the view, and the numbers of points and cells in the Information panel."""
        window.wait(300)
        file = lacuna_test.output("WindowMenus-view.png")
        window.save(file, lacuna_window.VIEW)
        reader = vtkPNGReader()
        reader.SetFileName(file)
        reader.Update()
        return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).copy(), [window.get("informationWidget/" + name).split()[0] for name in ("pointCount", "cellCount")]

    def recovers(field, bad, good, says):
        """A bad value typed into the panel empties the view and the Information panel; the good one brings both back."""
        shown, numbers = look()
        window.type(lacuna_window.PANEL + field, bad)
        window.press(lacuna_window.ACCEPT)
        said = window.take_messages()
        assert says in said, said
        empty, none = look()
        changed = empty[(shown != empty).any(axis=-1)]
        assert len(changed) > 0.03 * len(shown), f"{field} {bad}: the view shows the old result"
        _, counts = np.unique(changed, axis=0, return_counts=True)
        assert counts.max() > 0.99 * len(changed), "and nothing but the background behind it"
        assert none == ["0", "0"] and "0" not in numbers, (numbers, none)
        window.type(lacuna_window.PANEL + field, good)
        window.apply()
        again, same = look()
        assert np.array_equal(again, shown) and same == numbers, (numbers, same)
        print(f"{field} {bad}: the view is empty, and comes back", flush=True)

    def names():
        return {source: name for (name, _), source in GetSources().items()}

    window.resize_view(992, 665)
    random = np.random.default_rng(3)
    sweep = make("Sources", "Phantom Sweep", NumberOfSlices=12, ImageSize=[80, 60], PixelSpacing=0.8)
    make("Filters", "Slice Planes", sweep)
    recovers("Stride/LineEdit0", 0, 1, ERROR)
    make("Filters", "Gate Slices", sweep, SpeedLimit=200)
    make("Filters", "Bone Echo", sweep)
    for text in ("Speckle Filter", "Slice Ray Caster"):
        make("Filters", text, sweep)
    window.compare("MenusSweep")
    volume = make("Filters", "Swept Volume", sweep)
    make("Filters", "Contrast To Speckle", volume, InsideBounds=[-5, 5, -5, 5, 20, 30])

    poses = [scans.pose(scans.rotation([0, 0, 1], 2 * i), [0, 0, i]) for i in range(8)]
    stack = open_slices("WindowMenus-stack", random.integers(0, 255, (8, 30, 40)).astype(np.uint8), poses)
    table = scans.open_table("WindowMenus-poses", ["Slice", *(f"m{i}" for i in range(16))], [[n, *pose.ravel()] for n, pose in enumerate(poses)])
    make("Filters", "Assemble Tracked Slices", stack, {"Poses": table}, PixelSpacing=0.4)
    wall = scans.open_wall("WindowMenus-", random)
    make("Filters", "Temporal Calibration", wall)
    make("Filters", "Scan Region", wall)
    wires, picks = scans.open_wires("WindowMenus-", random)
    make("Filters", "Probe Calibration", wires, Picks=picks, PixelSpacing=0.4)
    make("Filters", "Tracker Self Test", scans.open_receivers("WindowMenus-", random), says="the tracker is as specified", LengthUnit="cm")

    depth = BSplineIsoRayCaster(Input=SkullPhantom(Spacing=[4, 4, 4]), PixelSpacing=3)
    make("Filters", "Depth Map Shader", depth)
    bone = make("Filters", "Skull Bone", SkullPhantom(Spacing=[3, 3, 3]))
    make("Filters", "Skull Implant", bone, says="the wall of bone has undercuts")
    make("Filters", "Skull Resection", bone, Tumour=Sphere(Center=[-38, -15, 32], Radius=12))

    shape = make("Sources", "Incomplete Shape", Shape="Sphere", Dimensions=[28, 28, 28])
    angle = make("Filters", "Occluded Angle", shape, slow=True, NumberOfDirections=60)
    make("Filters", "Occlusion Surface", angle, {"Data": shape})

    places = Sphere(Radius=50)
    warmth = Calculator(Input=places, ResultArrayName="Warmth", Function="20 + coordsX/10")
    warmth.UpdatePipeline()
    cloud = make("Filters", "RBF Interpolator", warmth, OutputSpacing=[9, 9, 9])
    moved = Transform(Input=places)
    moved.Transform.Rotate = [0, 0, 10]
    moved.UpdatePipeline()
    make("Filters", "RBF Image Warp", cloud, {"Landmarks": places, "Targets": moved})
    make("Filters", "RBF Surface", places, OutputSpacing=9)
    cuts = Slice(Input=places, SliceOffsetValues=[-40, -20, 0, 20, 40])
    cuts.UpdatePipeline()
    make("Filters", "Outlined Structures", cuts, Smoothing=0.5)

    assert not faults, "\n".join(faults)
    missing = set(os.environ[MENUS].split()) - set(made) - ELSEWHERE
    assert not missing, f"not made from the menu: {sorted(missing)}"


if lacuna_window.IS_INSIDE:
    lacuna_window.inside(test)
else:
    folder = os.path.dirname(os.path.abspath(__file__))
    menus = ElementTree.parse(os.path.join(folder, "..", "..", "Plugins", "Lacuna", "LacunaMenus.xml"))
    names = [entry.get("name")[len("Lacuna"):] for entry in menus.getroot().iter("Proxy")]
    lacuna_window.run(__file__, expected=ERROR, **{MENUS: " ".join(names)})
    print("ok")
