# SPDX-License-Identifier: BSD-3-Clause
"""Handles in the 3-D view of the ParaView application, dragged with the mouse: the panel follows, and Apply uses it.

Plane, box, sphere and cylinder of a cut-away, the plane of Mirror, a spline loop, a poly line, a line.
"""
import lacuna_window
import numpy as np
from lacuna_window import PANEL

REGION = PANEL + "CutAway/comboBox"
MOVED = np.array([60, -30])  # pixels to the right and down, on the screen
SMALL = MOVED / 4


def place(view, point):
    """Pixels from the upper left corner of the view."""
    from vtkmodules.vtkRenderingCore import vtkCoordinate
    coordinate = vtkCoordinate()
    coordinate.SetCoordinateSystemToWorld()
    coordinate.SetValue(*point)
    x, y = coordinate.GetComputedDoubleDisplayValue(view.GetRenderer())
    return np.array([x, view.ViewSize[1] - y])


def test(window):
    from paraview.simple import GetActiveSource, GetActiveView, Render

    def make(menu, **settings):
        window.menu(menu)
        for name, values in settings.items():
            for k, value in enumerate(values):
                window.type(f"{PANEL}{name}/DoubleLineEdit{k}", value)

    def drag(proxy, start, name, field=None, way=MOVED):
        """Drags what is at a point in space along a way on the screen; the property that follows, before and after Apply."""
        Render()
        view = GetActiveView()
        before = np.array(getattr(proxy, name), float)
        shown = field and window.get(field)
        begin = place(view, start)
        window.drag([begin, begin + way])
        assert window.get(lacuna_window.ACCEPT, "enabled") == "true", f"{name}: nothing has moved"
        assert np.array_equal(np.array(getattr(proxy, name), float), before), "before Apply"
        assert field is None or window.get(field) != shown, f"{field} does not follow"
        window.apply()
        after = np.array(getattr(proxy, name), float)
        assert after.shape == before.shape and not np.array_equal(after, before), (name, before)
        print(f"{name}: {before.round(1).tolist()} -> {after.round(1).tolist()}", flush=True)
        return before, after

    def check_moved(before, after, expected=MOVED):
        """A point has gone as far as the mouse, as seen in the view."""
        view = GetActiveView()
        way = place(view, after) - place(view, before)
        assert np.abs(way - expected).max() < 8, way

    window.resize_view(992, 665)
    make("Sources/Lacuna/Skull Phantom", Spacing=(4, 4, 4))
    window.apply()
    window.look_from_above()
    make("Filters/Lacuna/B-Spline Iso Ray Caster", ViewDirection=(-0.4, 0.2, -0.9), PixelSpacing=(6,))
    window.apply()
    caster, view = GetActiveSource(), GetActiveView()
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [200, -100, 450], [0, 0, 0], [0, 1, 0]
    view.CameraParallelProjection, view.CameraParallelScale = 1, 160

    window.choose(REGION, "Plane")
    window.apply()
    window.compare("HandlesPlane")
    plane = caster.CutAway
    before, after = drag(plane, plane.Origin, "Origin", PANEL + "CutAway/originZ")

    window.choose(REGION, "Box")
    window.apply()
    box = caster.CutAway
    center = np.array(box.Position) + np.array(box.Length) / 2
    before, after = drag(box, center, "Position", PANEL + "CutAway/translateX")
    check_moved(before, after)
    center = np.array(box.Position) + np.array(box.Length) / 2
    drag(box, center + [box.Length[0] / 2, 0, 0], "Length", PANEL + "CutAway/scaleX")
    window.compare("HandlesBox")

    window.choose(REGION, "Sphere")
    window.apply()
    sphere = caster.CutAway
    before, after = drag(sphere, sphere.Center, "Center")
    check_moved(before, after)

    window.choose(REGION, "Cylinder")
    window.apply()
    cylinder = caster.CutAway
    drag(cylinder, cylinder.Center, "Center")
    drag(cylinder, np.array(cylinder.Center) + 60 * np.array(cylinder.Axis), "Axis")

    window.choose(REGION, "None")
    window.apply()
    window.menu("Filters/Lacuna/RBF Hole Filler")
    window.type(PANEL + "NodeSpacing/DoubleLineEdit0", 5)
    filler = GetActiveSource()
    window.choose(PANEL + "DefectRegion/comboBox", "Spline Loop")
    window.press(lacuna_window.ACCEPT)
    window.take_messages()  # pixels of 6 mm are too coarse to find the hole
    loop = filler.DefectRegion
    corners = [place(view, point) for point in np.reshape(loop.Points, (-1, 3))]
    width, height = view.ViewSize
    assert all(0 < x < width and 0 < y < height for x, y in corners) and np.ptp(corners, 0).min() > 50, "does not begin in the map"
    center = np.array([0.4, -0.2, 0.9]) / np.linalg.norm([0.4, -0.2, 0.9])
    across = np.cross(center, [0, 1, 0])
    around = [74 * center + 50 * (np.cos(a) * across + np.sin(a) * np.cross(center, across)) for a in np.arange(6) * np.pi / 3]
    loop.Points = np.concatenate(around).tolist()
    Render()
    view.InteractionMode = "3D"
    window.compare("HandlesLoop")
    before, after = drag(loop, loop.Points[:3], "Points", way=SMALL)
    check_moved(before[:3], after[:3], SMALL)
    assert np.array_equal(before[3:], after[3:])

    window.menu("Sources/Geometric Shapes/Poly Line Source")
    line = GetActiveSource()
    line.Points = [-60, 90, 100, 20, 90, 100, 60, 60, 100]
    window.apply()
    before, after = drag(line, line.Points[3:6], "Points")
    check_moved(before[3:6], after[3:6])
    assert np.array_equal(before[:3], after[:3])

    window.select("pipelineBrowser", "SkullPhantom1")
    window.menu("Filters/Lacuna/Mirror")
    window.choose(PANEL + "PlaneMethod/ComboBox", "Given")
    window.apply()
    mirror = GetActiveSource()
    drag(mirror, mirror.Origin, "Origin", PANEL + "originY")
    window.compare("HandlesMirror")


lacuna_window.main(test, "no surface to fit within")
