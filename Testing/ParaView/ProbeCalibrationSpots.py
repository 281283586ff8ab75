# SPDX-License-Identifier: BSD-3-Clause
"""Probe Calibration of slices that show wires or a point: found by itself, corrected, and picked by selection."""
import os

import numpy as np
from paraview.simple import *
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy

import calibration_scans as scans
from lacuna_test import check_defaults

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna import vtkLacunaProbeCalibration
from lacuna.errors import PipelineError, raising

SLICES = 36  # of each wire
RANGES = "X 0-35, Y 36-71, Z 72-107"


def result(proxy, port):
    return proxy.GetClientSideObject().GetOutputDataObject(port)


def field(data, name):
    return vtk_to_numpy(data.GetFieldData().GetArray(name))[0]


def column(table, name):
    array = table.GetColumnByName(name)
    return np.array([array.GetValue(i) for i in range(table.GetNumberOfRows())])


def corner_error(proxy):
    return scans.corner_error(field(result(proxy, 0), "ImageToProbe").reshape(4, 4))


def make_scan(seed):
    random = np.random.default_rng(seed)
    poses, pixels, pictures = [], [], []
    for wire in range(3):
        sweep, seen = scans.wire_sweep(wire, SLICES, random)
        poses += [scans.probe_to_tracker(scan) for scan in sweep]
        pixels += seen
        pictures += [scans.wire_picture(scan, random) for scan in sweep]
    return scans.open_scan("CalibrationSpots%d" % seed, np.array(pictures), poses), np.array(pixels), poses


errors = []
for seed in range(5):
    scan, truth, poses = make_scan(seed)
    proxy = ProbeCalibration(Input=scan, WireRanges=RANGES, PixelSpacing=scans.SPACING)
    with raising():
        proxy.UpdatePipeline()
    table = result(proxy, 1)
    picked = np.column_stack([column(table, "Column"), column(table, "Row")])
    slices = column(table, "Slice")
    off = np.linalg.norm(picked - truth[slices], axis=1)
    used = column(table, "Used") == 1
    errors.append(corner_error(proxy))
    print("seed", seed, "corner error", errors[-1], "mm; expected", field(result(proxy, 0), "ExpectedError"),
          "RMS", field(result(proxy, 0), "CalibrationRms"), "spots", len(off), "used", used.sum(), "wrong",
          (off > 3).sum(), "wrong and used", (off[used] > 3).sum(), "RMS error of the others",
          np.sqrt(np.mean(off[off < 3] ** 2)), "pixels")
    assert len(off) > 0.85 * 3 * SLICES
    # the other wires are in sight at times
    assert (off > 3).mean() < 0.05 and not (off[used] > 3).any()
    assert np.sqrt(np.mean(off[off < 3] ** 2)) < 0.4
print("median corner error", np.median(errors), "mm")
assert np.median(errors) < 0.5 and max(errors) < 1

# The picks can be seen on the slices.
marks = result(proxy, 4)
points = vtk_to_numpy(marks.GetPoints().GetData())
assert np.abs(points - np.column_stack([picked, slices])).max() < 1e-9
assert marks.GetNumberOfVerts() == len(off) and marks.GetPointData().GetArray("Score") is not None
score = column(table, "Score")
assert ((score > 0) & (score <= 1)).all()
check_defaults(proxy, vtkLacunaProbeCalibration(), ["FindSpots", "OutlierLimit"])

# Corrected, the table is taken back: a pick that is moved, others that are left out.
rows = [[s, *p, "XYZ"[s // SLICES]] for s, p in zip(slices, picked)]
rows[3][1:3] = truth[slices[3]] + 30
corrected = ProbeCalibration(Input=scan, PixelSpacing=scans.SPACING, FindSpots=0,
                             Picks=scans.open_table("CalibrationCorrected", ["Slice", "Column", "Row", "Target"],
                                                    rows[:-5]))
with raising():
    corrected.UpdatePipeline()
table = result(corrected, 1)
assert table.GetNumberOfRows() == len(rows) - 5
assert not column(table, "Used")[3] and (column(table, "Score") == 1).all()
# With FindSpots the slices without a pick get their spots back.
corrected.FindSpots = 1
corrected.WireRanges = RANGES
with raising():
    corrected.UpdatePipeline()
table = result(corrected, 1)
assert table.GetNumberOfRows() >= len(rows) - 1
assert (column(table, "Score")[:len(rows) - 5] == 1).all() and column(table, "Score")[-1] < 1

# Picks by selecting points of the slices: (column, row, slice) are their coordinates.
chosen = range(0, 3 * SLICES, 3)
ids = []
for s in chosen:
    c, r = np.round(truth[s]).astype(int)
    ids += [0, (s * scans.HEIGHT + r) * scans.WIDTH + c]
selection = IDSelectionSource(FieldType="POINT", IDs=ids)
picks = ExtractSelection(Input=scan, Selection=selection)
by_hand = ProbeCalibration(Input=scan, Picks=picks, WireRanges=RANGES, FindSpots=0, PixelSpacing=scans.SPACING)
with raising():
    by_hand.UpdatePipeline()
print("by selection: corner error", corner_error(by_hand), "mm")
assert result(by_hand, 1).GetNumberOfRows() == len(chosen) and corner_error(by_hand) < 1
# as the mouse selects them in the view of a slice
number = 40
shown = ExtractSubset(Input=scan, VOI=[0, scans.WIDTH - 1, 0, scans.HEIGHT - 1, number, number])
view = CreateView("RenderView")
view.ViewSize = [2 * scans.WIDTH, 2 * scans.HEIGHT]
Show(shown, view).Representation = "Surface"
Render(view)
view.CameraParallelProjection = 1
view.CameraFocalPoint = [*truth[number], number]
view.CameraPosition = [*truth[number], number - 100]
view.CameraViewUp = [0, -1, 0]
view.CameraParallelScale = 8
Render(view)
middle = [scans.WIDTH, scans.HEIGHT]  # of the view, where the wire is
SelectSurfacePoints(Rectangle=[m - 30 for m in middle] + [m + 30 for m in middle], View=view)
clicked = ExtractSelection(Input=shown)
clicked.UpdatePipeline()
selected = servermanager.Fetch(clicked)
points = np.array([selected.GetPoint(i) for i in range(selected.GetNumberOfPoints())])
assert len(points) and (points[:, 2] == number).all(), points
assert np.abs(points[:, :2] - truth[number]).max() < 3, (points, truth[number])
# or by the points of a line placed on the slices
line = PolyLineSource(Points=[v for s in chosen for v in (*truth[s], s)])
by_hand.Picks = line
with raising():
    by_hand.UpdatePipeline()
assert corner_error(by_hand) < 0.05, corner_error(by_hand)
by_hand.WireRanges = "X 0-35, Y 36-71"
try:
    with raising():
        by_hand.UpdatePipeline()
    raise AssertionError("a wire was guessed")
except PipelineError as error:
    assert "name the wire of slice 72 in WireRanges" in str(error), error

# A point is found in all slices.
random = np.random.default_rng(9)
poses, pictures = [], []
for i in range(40):
    turn = scans.looking_down(random, 50)
    pixel = random.uniform([15, 25], [scans.WIDTH - 15, scans.HEIGHT - 15])
    scan_pose = scans.pose(turn, -turn[:, :2] @ (scans.SPACING * pixel))
    poses.append(scans.probe_to_tracker(scan_pose))
    across = scans.pose(np.eye(3), [0, 0, 0]).copy()
    across[:2, 3] = -scans.SPACING * pixel
    pictures.append(scans.wire_picture(across, random))
point = ProbeCalibration(Input=scans.open_scan("CalibrationBall", np.array(pictures), poses), Method="PointTarget",
                         PixelSpacing=scans.SPACING)
with raising():
    point.UpdatePipeline()
print("point: corner error", corner_error(point), "mm of", result(point, 1).GetNumberOfRows(), "picks")
assert result(point, 1).GetNumberOfRows() >= 36 and corner_error(point) < 0.3

# What cannot be is said.
for settings, words in [
        ({"WireRanges": ""}, "neither picks (second input) nor WireRanges"),
        ({"WireRanges": "X 0-40, Y 36-71"}, "only one wire can be followed"),
        ({"WireRanges": "X 0-108"}, "the sweep has slices 0 to 107"),
        ({"WireRanges": RANGES, "FindSpots": 0}, "FindSpots is off")]:
    bad = ProbeCalibration(Input=scan, PixelSpacing=scans.SPACING, **settings)
    try:
        with raising():
            bad.UpdatePipeline()
        raise AssertionError("taken: " + words)
    except PipelineError as error:
        assert words in str(error), (words, error)
