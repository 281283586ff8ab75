# SPDX-License-Identifier: BSD-3-Clause
"""Outlines in the ParaView application, drawn by somebody who clicks what is to be seen: menus, Apply, buttons by their words, the picture.

Five outlines of the phantom's organ give its volume in the panel within 1 %. Further: freehand, trace, copy, undo, moving a point, snapping,
keys, names, files.
The pictures outline-organ-*.png that it leaves in the tests' output are those of the page outline-an-organ.md.
"""
import os
import re

import lacuna_window
import numpy as np

PANEL = "pqLacunaOutlinePanel/"
CANVAS = PANEL + "OutlineCanvas"
TRUTH = 12.818  # ml, 4/3 pi 17 12 15 mm3


def test(window):
    from paraview.simple import FindSource, GetActiveSource
    from vtkmodules.vtkCommonCore import vtkPoints
    from lacuna import outlines, vtkLacunaOutlineTools

    def picture(name, widget=""):
        window.wait(300)
        window.save(os.path.join(os.environ["LACUNA_TEST_OUTPUT"], f"outline-organ-{name}.png"), widget)

    window.resize_view(992, 665)
    window.menu("Sources/Lacuna/Phantom Sweep")
    window.apply()
    window.menu("Filters/Lacuna/Slice Outliner")
    window.apply()
    window.wait(500)
    outliner = GetActiveSource()
    assert window.get("pqLacunaOutlinePanel", "visible") == "true"
    picture("1-open")

    def place(points):
        """Pixels of the widget that show places of the picture, which fits into it."""
        width, height = (int(window.get(CANVAS, name)) for name in ("width", "height"))
        scale = min(width / 320, height / 240)
        return np.array([width / 2, height / 2]) + scale * (np.asarray(points) + 0.5 - np.array([160, 120]))

    def click(point):
        window.drag([place(point)] * 2, CANVAS)

    def border(number, count):
        """What an eye sees: so many places on the border between grey levels 60 and 180."""
        line = vtkPoints()
        if not vtkLacunaOutlineTools.Trace(outlines._picture(outliner, number), 120, (float("nan"),) * 2, (60, 260, 40, 200), 1, line):
            return None
        points = np.array([line.GetPoint(i)[:2] for i in range(line.GetNumberOfPoints())])
        return points[np.arange(count) * len(points) // count]

    def show(number):
        window.type(PANEL + "SliceNumber/qt_spinbox_lineedit", number)
        window.key(0x01000004)  # Return
        window.wait(200)
        assert outliner.Slice == number, outliner.Slice

    def volume():
        found = re.fullmatch(r"(.*): ([0-9.]+) ml ± ([0-9.]+)", window.get(PANEL + "VolumeSummary"))
        assert found, window.get(PANEL + "VolumeSummary")
        return float(found[2])

    seen = [number for number in range(60) if (points := border(number, 16)) is not None and np.ptp(points, 0).min() > 6]
    middle, half = (seen[0] + seen[-1]) / 2, (seen[-1] - seen[0]) / 2
    chosen = [round(middle + part * half) for part in (-0.9, -0.5, 0, 0.5, 0.9)]
    for number in chosen:
        show(number)
        points = border(number, 16)
        for point in points:
            click(point)
            if number == chosen[2] and (point == points[10]).all():
                picture("2-points", "pqLacunaOutlinePanel")
        click(points[0])
        drawn = {outline["slice"]: outline["points"] for outline in outlines.get(outliner)}
        assert drawn[number].shape == (16, 2), drawn
        assert np.abs(drawn[number] - points).max() < 1, np.abs(drawn[number] - points).max()
    print(f"five outlines: {window.get(PANEL + 'VolumeSummary')}; truth {TRUTH}", flush=True)
    assert abs(volume() / TRUTH - 1) < 0.01, volume()
    structures = FindSource("Structures")
    assert structures is not None and abs(outlines.table(structures)["Structure 1"]["Volume (ml)"] - volume()) < 0.06
    picture("3-volume")

    # a further outline, by the freehand tool; undone and done again
    between = round(middle + 0.25 * half)
    show(between)
    window.press(PANEL + "Freehand")
    around = border(between, 60)
    window.drag(place([*around, around[0]]), CANVAS)
    assert len(outlines.get(outliner)) == 6
    assert abs(volume() / TRUTH - 1) < 0.01, volume()
    window.press(PANEL + "Undo")
    assert len(outlines.get(outliner)) == 5
    window.press(PANEL + "Redo")
    assert len(outlines.get(outliner)) == 6
    window.press(PANEL + "Delete outline")
    assert len(outlines.get(outliner)) == 5

    # copied from the nearest slice, a point of it moved
    window.press(PANEL + "Copy last outline")
    copied = [outline["points"] for outline in outlines.get(outliner) if outline["slice"] == between][0]
    assert any(np.array_equal(copied, outline["points"]) for outline in outlines.get(outliner) if outline["slice"] in chosen)
    window.press(PANEL + "Points")
    window.drag([place(copied[3]), place(copied[3] + [9, -6])], CANVAS)
    moved = [outline["points"] for outline in outlines.get(outliner) if outline["slice"] == between][0]
    assert np.abs(moved[3] - copied[3] - [9, -6]).max() < 1.5, moved[3] - copied[3]
    assert np.array_equal(np.delete(moved, 3, 0), np.delete(copied, 3, 0))
    window.press(PANEL + "Delete outline")

    # another structure, traced at the level by a click into it
    window.press(PANEL + "New")
    window.press(PANEL + "Trace")
    show(between)
    click(border(between, 60).mean(axis=0))
    picture("4-trace", "pqLacunaOutlinePanel")
    traced = [outline for outline in outlines.get(outliner) if outline["structure"] == "Structure 2"]
    assert len(traced) == 1 and traced[0]["slice"] == between, outlines.get(outliner)
    assert window.get(PANEL + "VolumeSummary") == "Structure 2: 1 of 3 slices outlined", window.get(PANEL + "VolumeSummary")
    assert window.get(PANEL + "SliceSlider", "value") == str(between)

    # drawn too far out, snapped to the border; undone
    window.press(PANEL + "Delete outline")
    window.press(PANEL + "Snap to edge")
    window.press(PANEL + "Points")
    true = border(between, 12)
    outwards = true - true.mean(axis=0)
    for point in [*(far := true + 3 * outwards / np.linalg.norm(outwards, axis=1, keepdims=True)), far[0]]:
        click(point)
    snapped = [outline["points"] for outline in outlines.get(outliner) if outline["structure"] == "Structure 2"][0]
    away = np.linalg.norm(snapped[:, None] - border(between, 400)[None], axis=2).min(axis=1)
    assert len(snapped) == 12 and away.max() < 1, away
    window.press(PANEL + "Snap to edge")

    # keys step through the slices while the picture has the focus
    window.key(0x01000014)  # Right
    window.wait(200)
    assert outliner.Slice == between + 1, outliner.Slice
    window.key(0x01000013)  # Up
    window.wait(200)
    assert outliner.Slice == between, outliner.Slice

    # a name, which another structure must not have
    def rename(name):
        def answer():
            window.paste("QLineEdit", name)
            window.press("OK")
        window.press(PANEL + "Rename", answer)
    rename("Structure 1")
    assert list(outliner.StructureNames) == ["Structure 1", "Structure 2"], list(outliner.StructureNames)
    rename("Zyste ö")
    assert list(outliner.StructureNames) == ["Structure 1", "Zyste ö"], list(outliner.StructureNames)

    # written, taken away and read again
    def choose(button):
        def answer():
            window.paste("fileNameEdit", path)
            window.press(button)
        return answer
    path = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "window-outlines.csv")
    if os.path.exists(path):
        os.remove(path)
    window.press(PANEL + "Save", choose("Save"))
    before = outlines.get(outliner)
    outliner.OutlinePoints = []
    outliner.UpdatePipeline()
    window.wait(200)
    window.press(PANEL + "Load", choose("Open"))
    after = outlines.get(outliner)
    assert [(one["structure"], one["slice"]) for one in after] == [(one["structure"], one["slice"]) for one in before], after
    assert max(np.abs(one["points"] - other["points"]).max() for one, other in zip(after, before)) < 1e-4


lacuna_window.main(test)
