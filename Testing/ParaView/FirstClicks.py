# SPDX-License-Identifier: BSD-3-Clause
"""The clicks of Documentation/UserGuide/first-clicks.md that are Lacuna's, in the ParaView application.

The icons in the toolbar "Common" make the filters, defaults suffice, a new ray caster looks as the view does (one that a
script made, or that was applied, is left alone), and names of sequences open Tracked Slice Reader.
"""
import math

import lacuna_window

ACCEPT = "propertiesPanel/Accept"


def added(window, name):
    """The filter that an icon of the toolbar adds, applied."""
    from paraview.simple import GetActiveSource
    window.wait_for_text(name, "true", "enabled")
    window.press(name)
    window.wait(300)  # the panel of a new proxy is filled by a timer
    source = GetActiveSource()
    assert source.GetXMLName() == name, (source.GetXMLName(), name)
    window.press(ACCEPT)
    window.wait(300)
    return source


def ct_to_iges(window):
    from paraview.simple import BSplineIsoRayCaster, GetActiveViewOrCreate, Render, SetActiveSource, Show, SkullPhantom
    view = GetActiveViewOrCreate("RenderView")
    skull = SkullPhantom(Spacing=[2, 2, 3])
    Show(skull, view)
    view.CameraFocalPoint, view.CameraPosition, view.CameraViewUp = [0, 0, 0], [200, -80, 460], [0.2, 0.9, 0.1]
    Render(view)
    SetActiveSource(skull)
    caster = added(window, "LacunaBSplineIsoRayCaster")
    camera = view.GetActiveCamera()
    for name, expected in (("ViewDirection", camera.GetDirectionOfProjection()), ("ViewUp", camera.GetViewUp())):
        found = list(getattr(caster, name))
        assert math.dist(found, expected) < 1e-12, (name, found, expected)
    assert list(caster.IsoValues) == [500] and list(caster.ImageSize) == [0, 0] and caster.Projection == "Parallel"
    filled = added(window, "LacunaRBFHoleFiller")
    mask = filled.PointData["FilledMask"].GetRange()  # that of the array is not, once ParaView 5.13 has colours for it
    assert mask == (0, 1), mask

    given = list(caster.ViewDirection)
    view.CameraPosition = [-300, 100, 50]
    Render(view)
    SetActiveSource(caster)
    window.wait(300)
    assert list(caster.ViewDirection) == given  # it was applied
    made = BSplineIsoRayCaster(Input=skull, PixelSpacing=3)
    SetActiveSource(made)
    window.wait(300)
    made.PixelSpacing = 4
    window.wait(300)
    assert list(made.ViewDirection) == [0, 0, -1], list(made.ViewDirection)


def sweep_to_surface(window):
    from paraview import servermanager
    from paraview.simple import GetActiveViewOrCreate, PhantomSweep, SetActiveSource, Show
    sweep = PhantomSweep(NumberOfSlices=20, ImageSize=[80, 60], PixelSpacing=0.8)
    Show(sweep, GetActiveViewOrCreate("RenderView"))
    SetActiveSource(sweep)
    volume = added(window, "LacunaSweptVolume")
    surface = added(window, "Contour")
    low, high = volume.PointData["Intensity"].GetRange()
    assert list(surface.ContourBy) == ["POINTS", "Intensity"] and low < surface.Isosurfaces[0] < high
    assert servermanager.Fetch(surface).GetNumberOfCells() > 100
    settings, name = servermanager.vtkSMSettings.GetInstance(), ".settings.RepresentedArrayListSettings.ReaderDetails"
    assert "*.igs.mha" in settings.GetSettingAsString(name, 0, "")
    assert settings.GetSettingAsString(name, 2, "") == "LacunaTrackedSliceReader"


def test(window):
    ct_to_iges(window)
    sweep_to_surface(window)


lacuna_window.main(test)
