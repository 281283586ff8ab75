# SPDX-License-Identifier: BSD-3-Clause
"""The button From Camera of the ray casters' panel, pressed in the ParaView application.

What the panel then has applied is compared with lacuna.views.camera_view, and the map with what the view shows; it
can be undone.
"""
import math

import lacuna_window

PROPERTIES = ("ViewDirection", "ViewUp", "FocalPoint", "PlaneOrigin", "PixelSpacing", "ImageSize", "Projection",
              "EyePosition", "ViewAngle")
ACCEPT = "propertiesPanel/Accept"


def close(a, b, tolerance=1e-9):
    pairs = zip(a, b) if hasattr(a, "__len__") else [(a, b)]
    return all(abs(x - y) <= tolerance * (1 + abs(y)) for x, y in pairs)


def read(caster):
    values = {name: getattr(caster, name) for name in PROPERTIES if name in caster.ListProperties()}
    return {name: list(value) if hasattr(value, "__len__") else value for name, value in values.items()}


def compare(kind, caster, view, divisor):
    """What the caster has been given, and lacuna.views would give it."""
    from lacuna import views
    found, size = read(caster), list(view.ViewSize)
    rows = math.floor(size[1] / divisor + 0.5)
    assert found["ImageSize"] == [math.floor(size[0] * rows / size[1] + 0.5), rows], (found, size)
    expected = views.camera_view(view.GetActiveCamera(), size, rows=rows)
    for name in ("ViewDirection", "ViewUp", "FocalPoint", "PixelSpacing"):
        assert close(found[name], expected[name]), (kind, name, found[name], expected[name])
    place, eye = expected["FocalPoint"], expected["PlaneOrigin"]
    if kind == "volume" and not view.CameraParallelProjection:
        assert found["Projection"] == ["Perspective"] and close(found["EyePosition"], eye), found
        angle = math.degrees(2 * math.atan(expected["PixelSpacing"] * rows / 2 / math.dist(eye, place)))
        assert close(found["PlaneOrigin"], place) and close(found["ViewAngle"], angle), found
    else:
        assert found.get("Projection", ["Parallel"]) == ["Parallel"], found
        assert close(found["PlaneOrigin"], eye), (found, eye)
    return found


def compare_pictures(caster, surface, view):
    """How much of the map is hit where the view shows the surface, and not where it does not."""
    from paraview import servermanager
    from paraview.simple import Hide, Render, Show
    from vtkmodules.util.numpy_support import vtk_to_numpy
    Hide(caster, view)
    shown = Show(surface, view)
    shown.ColorArrayName = ["POINTS", ""]
    shown.Ambient, shown.Diffuse, shown.AmbientColor = 1, 0, [1, 0, 0]
    view.UseColorPaletteForBackground, view.Background, view.OrientationAxesVisibility = 0, [0, 0, 1], 0
    Render(view)
    picture = view.SMProxy.CaptureWindow(1)
    columns, rows = picture.GetDimensions()[:2]
    seen = vtk_to_numpy(picture.GetPointData().GetScalars()).reshape(rows, columns, -1)[::-1, :, 0] > 127
    Hide(surface, view)
    Show(caster, view)
    image = servermanager.Fetch(caster)
    wide, high = image.GetDimensions()[:2]
    hit = vtk_to_numpy(image.GetPointData().GetArray("Depth")).reshape(high, wide)
    hit = hit == hit
    places = [[min(int((i + 0.5) * size / count), size - 1) for i in range(count)]
              for size, count in ((rows, high), (columns, wide))]
    seen = seen[places[0]][:, places[1]]
    assert 0.05 < seen.mean() < 0.95, seen.mean()
    same = (seen == hit).mean()
    assert same > 0.98, same
    for other in (seen[::-1], seen[:, ::-1]):  # an upright, unmirrored one
        assert (other == hit).mean() < same - 0.02, "the picture is symmetric"
    print(f"{100 * same:.2f} % of the map as in the view", flush=True)


def test(window):
    from paraview.simple import (BSplineIsoRayCaster, Contour, GetActiveViewOrCreate, PhantomSweep, Render, SetActiveSource,
                                 Show, SkullPhantom, SliceRayCaster)
    view = GetActiveViewOrCreate("RenderView")
    for kind in ("volume", "slices"):
        source = PhantomSweep(NumberOfSlices=12) if kind == "slices" else SkullPhantom(Spacing=[4, 4, 4])
        caster = SliceRayCaster(Input=source) if kind == "slices" else BSplineIsoRayCaster(Input=source)
        Show(caster, view)
        Render(view)  # the first one resets the camera
        view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [250, -300, 150], [5, -10, 15], [0.1, 0.2, 1]
        view.CameraParallelProjection, view.CameraParallelScale = 1, 120
        Render(view)
        SetActiveSource(caster)
        window.wait_for_text("FromCamera", "true", "visible")
        before = read(caster)
        window.choose("Resolution", "1/4")
        window.press("FromCamera")
        assert read(caster) == before  # until it is applied
        window.press(ACCEPT)
        first = compare(kind, caster, view, 4)
        surface = Contour(Input=source, ContourBy=["POINTS", "HounsfieldUnits"], Isosurfaces=[500]) if kind == "volume" else None
        if surface:
            compare_pictures(caster, surface, view)
            SetActiveSource(caster)
        bounds = caster.GetDataInformation().GetBounds()
        assert bounds[0] < bounds[1], bounds

        view.CameraParallelProjection, view.CameraPosition = 0, [-200, -320, 90]
        Render(view)
        window.press("FromCamera")
        window.choose("Resolution", "1/2")
        window.press(ACCEPT)
        second = compare(kind, caster, view, 2)
        assert first["ViewDirection"] != second["ViewDirection"]

        window.press("actionEditUndo")
        assert read(caster) == first, (read(caster), first)
        window.press("actionEditRedo")
        assert read(caster) == second, (read(caster), second)
        if surface:
            compare_pictures(caster, surface, view)
        window.choose("Resolution", "Full")
        print(kind, "ok:", first["ImageSize"], second["ImageSize"], flush=True)


lacuna_window.main(test)
