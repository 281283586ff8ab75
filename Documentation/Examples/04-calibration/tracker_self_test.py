# SPDX-License-Identifier: BSD-3-Clause
"""Two receivers on a wooden bar are carried through a room in which an iron trolley bends the tracker's field.

    pvpython tracker_self_test.py [folder for the picture, default: .]

tracker-self-test.png: on the left by how much a point 300 mm from the receiver is off, in the room; on the right how much that
changes over the length of a sweep.
"""
import os
import sys

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
import scans
from lacuna import pictures
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

TROLLEY = np.array([560.0, 330.0, -120.0])  # mm from the transmitter
SECOND_TO_FIRST = scans.pose(scans.rotation([1, 2, -0.5], 30), [270, -100, 80])


def measured(pose, random):
    """What a tracker says near the trolley: pushed away from it, and noise of 0.1 mm and 0.02 degrees."""
    away = pose[:3, 3] - TROLLEY
    distance = np.linalg.norm(away)
    push = 16 * np.exp(-(distance / 210) ** 2) * away / distance
    turn = scans.rotation(random.normal(size=3), random.normal(0, 0.02))
    return scans.pose(turn @ pose[:3, :3], pose[:3, 3] + push + random.normal(0, 0.1, 3))


def walk(random, count):
    """Lanes to and fro through a working volume of 400 x 560 x 240 mm, the bar turned a little in each; there and back again."""
    poses = []
    for z in (-160, -80, 0, 80):
        turn = scans.rotation(random.normal(size=3), random.uniform(-35, 35))
        for lane, x in enumerate(np.linspace(180, 480, 4)):
            way = np.linspace(-260, 260, count) * (1 if lane % 2 else -1)
            poses += [scans.pose(turn, [x, y, z]) for y in way]
    return poses + poses[::-1]


def main(folder):
    os.makedirs(folder, exist_ok=True)
    random = np.random.default_rng(2)
    poses = walk(random, 24)
    columns = {"Time": [], **{f"{receiver}:{i}": [] for receiver in ("First", "Second") for i in range(16)}}
    for number, pose in enumerate(poses):
        columns["Time"].append(0.6 * number)
        for receiver, own in (("First", pose), ("Second", pose @ SECOND_TO_FIRST)):
            for i, value in enumerate(measured(own, random).ravel()):
                columns[f"{receiver}:{i}"].append(value)
    test = TrackerSelfTest(Input=scans.table(columns), PoseFormat="Matrix", FirstReceiver="First", SecondReceiver="Second")
    test.UpdatePipeline()
    found = scans.fetch(test)
    sentences = scans.advice(found)
    print("\n".join(sentences), flush=True)
    figures = {name: scans.figure(found, name) for name in ("PositionRms", "PositionMaximum", "PositionExpected", "SeparationRange",
                                                             "Repeatability", "Warp", "RevisitedPlaces", "Places", "TooFast")}
    print(", ".join(f"{name} {value:.2f}" for name, value in figures.items()), flush=True)
    assert figures["Repeatability"] < 0.2 * figures["Warp"] and any("metal" in sentence for sentence in sentences)
    assert figures["SeparationRange"] > 5 and figures["TooFast"] < 40  # when it goes on to the next lane

    change = scans.fetch(test, 2)
    start, end, differs = (vtk_to_numpy(change.GetColumnByName(key)) for key in ("From", "To", "PositionChange"))
    chart = pictures.chart_pixels([("RMS difference of two places", 0.5 * (start + end), differs, (40, 90, 190), "line"),
                                   ("RMS of all", [0, 800], [figures["PositionRms"]] * 2, (110, 120, 130), "dashes")],
                                  ("distance between the places (mm)", "difference (mm)"), (480, 400), ((0, 800), (0, 10)))
    view = pictures.new_view((700, 560))
    view.OrientationAxesVisibility = 0
    balls = Glyph(Input=test, GlyphType="Sphere", ScaleFactor=17, GlyphMode="All Points", ScaleArray=["POINTS", "No scale array"])
    display = pictures.show_surface(balls, view, (1, 1, 1))
    pictures.color_by(display, view, "PositionError", "off by (mm)", (0, 8), "Viridis")
    bar = GetScalarBar(display.LookupTable, view)
    bar.LabelFormat = bar.RangeLabelFormat = pictures.number_format("{:.0f}", bar.LabelFormat)
    bar.WindowLocation = "Lower Left Corner"  # right is the trolley
    pictures.show_surface(Box(XLength=53, YLength=53, ZLength=58), view, (0.25, 0.3, 0.38))
    trolley = Box(Center=list(TROLLEY + [60, 20, -70]), XLength=90, YLength=160, ZLength=120)
    pictures.show_surface(trolley, view, (0.72, 0.3, 0.22))
    pictures.look(view, (-0.55, 0.6, -0.58), (0, 0, 1), 1.15)
    pictures.add_scale_bar(view, 200)
    name = os.path.join(folder, "tracker-self-test.png")
    pictures.save(view, name)
    chart = np.pad(chart, ((80, 80), (0, 0), (0, 0)), constant_values=255)
    titles = "grey: transmitter, red: iron trolley; points midway between the receivers", "what changes along a sweep"
    pictures.write_pixels(name, pictures.side_by_side([(titles[0], pictures.read_pixels(name)), (titles[1], chart)], gap=14))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else ".")
