# SPDX-License-Identifier: BSD-3-Clause
"""Both main jobs in the ParaView application by what is on the screen alone, in at most 12 clicks each, ending on a picture.

By words that are seen: File > Open, Apply, the menu Lacuna. The sweep is a real one where there are real data (LACUNA_TEST_DATA).
"""
import os
import shutil

import lacuna_window

SPINE = os.path.join(os.environ.get("LACUNA_TEST_DATA", ""), "ultrasound_spine")


class Clicks:
    def __init__(self, window):
        self.window, self.number = window, 0

    def open(self, path):
        self.number += 3  # Open, the file, OK
        self.window.open_file(path)

    def apply(self):
        self.number += 1
        self.window.press(lacuna_window.ACCEPT)

    def menu(self, path, *dialogs):
        self.number += 1 + path.count("/")
        self.window.menu(path, *dialogs)


def shown(view):
    return [each for each in view.Representations if each.GetProperty("Input") and each.Input is not None and each.Visibility
            and each.Input.GetXMLName() != "TextSource"]


def test(window):
    import numpy as np
    from lacuna import window as shows
    from lacuna.data import fetch
    from paraview.simple import (FindSource, GetActiveSource, GetActiveView, GetDisplayProperties, HideAll, PhantomSweep, SaveData, SetActiveSource,
                                 SkullPhantom)
    folder = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "WindowAtHome")
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    skull, sweep = os.path.join(folder, "skull.vti"), os.path.join(folder, "sweep.igs.mha")
    for path, source in ((skull, SkullPhantom(Spacing=[2, 2, 2])), (sweep, PhantomSweep(NumberOfSlices=30, ImageSize=[160, 120], PixelSpacing=0.4))):
        SaveData(path, proxy=source)
    window.take_messages()
    window.resize_view(992, 665)

    # From a CT to an implant, and to a file for the printer
    clicks = Clicks(window)
    clicks.open(skull)
    clicks.apply()
    view = GetActiveView()
    assert GetDisplayProperties(GetActiveSource(), view).Representation == "Volume"
    window.compare("AtHomeBone", likeness=0.9)
    assert window.has_menu("Lacuna/Skull and implant/Skull alone: Skull Bone"), "ParaView's own menu of filters was not opened"
    clicks.menu("Lacuna/CT to Implant")
    window.take_messages()
    implant = GetActiveSource()
    names = "Bone surface of skull.vti", "Scale, 50 mm", "Facts of the implant"
    assert implant.GetXMLName() == "LacunaSkullImplant" and {each.Input for each in shown(view)} == {implant, *map(FindSource, names)}
    ruler = FindSource("Scale, 50 mm")
    assert abs(np.linalg.norm(np.array(ruler.Point2) - np.array(ruler.Point1)) - 50) < 1e-6
    window.compare("AtHomeImplant", likeness=0.9)
    solid = os.path.join(folder, "implant.stl")

    clicks.menu("Lacuna/Save Solid (STL, PLY, 3MF, STEP)...", lambda: window.choose_file(solid))
    clicks.number += 1  # Save
    assert os.path.getsize(solid) > 10000 and os.path.exists(solid + ".json")
    print(f"CT to a file for the printer: {clicks.number} clicks", flush=True)
    assert clicks.number <= 12
    window.take_messages()

    # From a sweep to a surface
    HideAll(view)
    real = os.path.isdir(SPINE)
    if real:
        for name in os.listdir(SPINE):
            shutil.copy(os.path.join(SPINE, name), folder)
        sweep = os.path.join(folder, "SpinePhantomFreehand.igs.mha")
    clicks = Clicks(window)
    clicks.open(sweep)
    assert bool(GetActiveSource().CalibrationFileName) == real, "that beside the sweep"
    clicks.apply()
    assert "skewed" in window.take_messages() or not real
    source = GetActiveSource()
    assert GetDisplayProperties(source, view).Representation == shows.SLICES
    poses = shows.demo_ultrasound.slice_poses(fetch(source))
    camera = view.GetActiveCamera()
    distance = np.linalg.norm(np.array(camera.GetFocalPoint()) - (poses[len(poses) // 2] @ (*np.array(fetch(source).GetDimensions()[:2]) / 2, 0, 1))[:3])
    assert distance < 30, "the slices are in the middle"
    clicks.menu("Lacuna/Sweep to Surface")
    window.take_messages()
    surface = GetActiveSource()
    assert surface.GetXMLName() == "Contour" and len(shown(view)) == 2
    bounds = np.array(surface.GetDataInformation().GetBounds()).reshape(3, 2)
    assert (bounds[:, 1] - bounds[:, 0] > 10).all() and (bounds[:, 1] - bounds[:, 0] < 120).all(), bounds
    print(f"sweep to a surface: {clicks.number} clicks", flush=True)
    assert clicks.number <= 12

    # From the same sweep to the bone in it
    if real:
        clicks.number -= 2
        HideAll(view)
        SetActiveSource(source)
        clicks.menu("Lacuna/Sweep to Bone")
        window.take_messages()
        bone = GetActiveSource()
        assert FindSource("Bone surface of SpinePhantomFreehand.igs.mha") == bone and {each.Input for each in shown(view)} == {bone, source}
        window.save(os.path.join(folder, "bone.png"))
        window.compare("AtHomeSpine", likeness=0.9)
        print(f"sweep to bone: {clicks.number} clicks", flush=True)
        assert clicks.number <= 12

    # Filters by what they are for; those that do not fit the selection cannot be chosen
    filler = "Lacuna/Skull and implant/Fill a hole of a depth map: RBF Hole Filler"
    assert not window.has_menu("Lacuna/Making it/Milling path: Milling Tool Path")
    SetActiveSource(FindSource("skull.vti"))
    window.wait(200)
    window.menu("Lacuna/Skull and implant/Depth map of a skull: B-Spline Iso Ray Caster")
    assert GetActiveSource().GetXMLName() == "LacunaBSplineIsoRayCaster"
    clicks.apply()
    assert window.has_menu(filler)

    # What is wrong is said in one sentence
    SetActiveSource(surface)
    window.menu("Lacuna/CT to Implant")
    said = window.take_messages()
    assert "is no volume; select a CT Series Reader" in said and "Traceback" not in said, said
    for sample, kind in (("Sample CT: Skull with a Hole", "LacunaSkullPhantom"), ("Sample Sweep: Ultrasound", "LacunaPhantomSweep")):
        window.menu("Lacuna/" + sample)
        assert [each.Input.GetXMLName() for each in shown(view)] == [kind]
    window.check_messages()


if lacuna_window.IS_INSIDE:
    lacuna_window.inside(test)
else:
    lacuna_window.run(__file__, expected="is no volume; select a CT Series Reader")
    print("ok")
