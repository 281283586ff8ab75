# SPDX-License-Identifier: BSD-3-Clause
"""The button From Camera of the ray casters' panel, pressed in the ParaView application.

Run by pvpython, which starts paraview with this script and presses buttons by ParaView's own event player; what the
panel then has applied is compared with lacuna.views.camera_view.
"""
import json
import os
import subprocess
import sys

APPLICATION = os.environ.get("LACUNA_FROM_CAMERA")  # set within paraview: the kind of caster


def set_up(kind):
    """In paraview: a caster to be applied from the panel, and a record of what it then was given."""
    from paraview.simple import (BSplineIsoRayCaster, GetActiveViewOrCreate, PhantomSweep, Render, SetActiveSource,
                                 Show, SkullPhantom, SliceRayCaster)
    view = GetActiveViewOrCreate("RenderView")
    source = PhantomSweep(NumberOfSlices=12) if kind == "slices" else SkullPhantom(Spacing=[4, 4, 4])
    caster = SliceRayCaster(Input=source) if kind == "slices" else BSplineIsoRayCaster(Input=source)
    Show(caster, view)
    Render(view)  # the first one resets the camera
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [250, -300, 150], [5, -10, 15], [0.1, 0.2, 1]
    view.CameraParallelProjection, view.CameraParallelScale = 1, 120
    Render(view)
    SetActiveSource(caster)

    from lacuna import views

    def record(*_):
        parallel = view.CameraParallelProjection
        name = "parallel" if parallel else "perspective"
        names = [name for name in caster.ListProperties() if name in PROPERTIES]
        found = {name: getattr(caster, name) for name in names}
        with open(os.path.join(os.environ["LACUNA_TEST_OUTPUT"], f"FromCamera-{kind}-{name}.json"), "w") as file:
            json.dump({"size": list(view.ViewSize),
                       "found": {key: list(value) if hasattr(value, "__len__") else value
                                 for key, value in found.items()},
                       "map": list(caster.GetDataInformation().GetBounds()),
                       "expected": views.camera_view(view.GetActiveCamera(), view.ViewSize,
                                                     rows=list(caster.ImageSize)[1])}, file)
        # the buttons are pressed a second time with this camera
        view.CameraParallelProjection, view.CameraPosition = 0, [-200, -320, 90]

    caster.SMProxy.AddObserver("UpdateDataEvent", record)


PROPERTIES = ("ViewDirection", "ViewUp", "FocalPoint", "PlaneOrigin", "PixelSpacing", "ImageSize", "Projection",
              "EyePosition", "ViewAngle")
PANEL = ("pqClientMainWindow/propertiesDock/propertiesPanel/scrollArea/qt_scrollarea_viewport/"
         "scrollAreaWidgetContents/PropertiesFrame/ProxyPanel/ViewDirection/")
EVENTS = [(PANEL + "Resolution", "set_string", "1/4"), (PANEL + "FromCamera", "activate", ""),
          ("pqClientMainWindow/propertiesDock/propertiesPanel/Accept", "activate", ""),
          (PANEL + "FromCamera", "activate", ""), (PANEL + "Resolution", "set_string", "1/2"),
          ("pqClientMainWindow/propertiesDock/propertiesPanel/Accept", "activate", "")]


def press(kind):
    """Runs paraview; returns what it recorded for the first and for the second camera."""
    from lacuna_test import output
    events = output(f"FromCamera-{kind}.xml")
    with open(events, "w") as file:
        file.write("<pqevents>\n")
        for widget, command, argument in EVENTS:
            file.write(f'<pqevent object="{widget}" command="{command}" arguments="{argument}"/>\n')
        file.write("</pqevents>\n")
    records = [output(f"FromCamera-{kind}-{name}.json") for name in ("parallel", "perspective")]
    for name in records:
        if os.path.exists(name):
            os.remove(name)
    done = subprocess.run(
        [os.environ["LACUNA_PARAVIEW"], "--dr", "--script=" + os.path.abspath(__file__), "--test-script=" + events,
         "--test-directory=" + os.environ["LACUNA_TEST_OUTPUT"], "--exit"],
        env=dict(os.environ, LACUNA_FROM_CAMERA=kind, QT_LOGGING_RULES="*.debug=false"), timeout=300,
        capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert "WARN" not in done.stderr and "ERR" not in done.stderr, done.stderr[-3000:]
    found = []
    for name in records:
        with open(name) as file:
            found.append(json.load(file))
    return found


def close(a, b, tolerance=1e-9):
    pairs = zip(a, b) if isinstance(a, list) else [(a, b)]
    return all(abs(x - y) <= tolerance * (1 + abs(y)) for x, y in pairs)


def main():
    import math
    for kind in ("volume", "slices"):
        first, second = press(kind)
        for record, divisor in ((first, 4), (second, 2)):
            found, expected, size = record["found"], record["expected"], record["size"]
            rows = math.floor(size[1] / divisor + 0.5)
            assert found["ImageSize"] == [math.floor(size[0] * rows / size[1] + 0.5), rows], (found, size)
            for name in ("ViewDirection", "ViewUp", "FocalPoint", "PixelSpacing"):
                assert close(found[name], expected[name]), (kind, name, found[name], expected[name])
            place, eye = expected["FocalPoint"], expected["PlaneOrigin"]
            if kind == "volume" and record is second:
                assert found["Projection"] == ["Perspective"] and close(found["EyePosition"], eye), found
                shown = expected["PixelSpacing"] * rows
                angle = math.degrees(2 * math.atan(shown / 2 / math.dist(eye, place)))
                assert close(found["PlaneOrigin"], place) and close(found["ViewAngle"], angle), found
            else:
                assert found.get("Projection", ["Parallel"]) == ["Parallel"], found
                assert close(found["PlaneOrigin"], eye), (found, eye)
        assert first["found"]["ViewDirection"] != second["found"]["ViewDirection"]
        assert first["map"][0] < first["map"][1], first["map"]
        print(kind, "ok:", first["found"]["ImageSize"], second["found"]["ImageSize"])


if APPLICATION:
    set_up(APPLICATION)
elif not os.environ.get("DISPLAY"):
    print("skipped: the application needs a display")
    sys.exit(77)
else:
    main()
    print("ok")
