# SPDX-License-Identifier: BSD-3-Clause
"""Probe Calibration through ParaView: a wall found by itself, wires and a point from tables, its file."""
import os
import xml.etree.ElementTree

import numpy as np
from paraview.simple import *
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy

import calibration_scans as scans
from lacuna_test import check_defaults, output

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna import vtkLacunaProbeCalibration
from lacuna.errors import PipelineError, raising

random = np.random.default_rng(5)


def result(proxy, port):
    return proxy.GetClientSideObject().GetOutputDataObject(port)


def field(data, name):
    return vtk_to_numpy(data.GetFieldData().GetArray(name))[0]


# A water bath, scanned from forty sides.
poses, pictures = [], []
for i in range(40):
    scan = scans.pose(scans.looking_down(random, 50), [*random.uniform(-40, 40, 2), 0])
    # the floor crosses the image's middle column at a random depth
    depth = random.uniform(0.3, 0.8) * scans.HEIGHT * scans.SPACING
    scan[2, 3] = -(scan[2, :2] @ [0.5 * scans.WIDTH * scans.SPACING, depth])
    poses.append(scans.probe_to_tracker(scan))
    pictures.append(scans.wall_picture(scan, random))
bath = scans.open_scan("CalibrationBath", np.array(pictures), poses)

proxy = ProbeCalibration(Input=bath)
own = vtkLacunaProbeCalibration()
check_defaults(proxy, own, ["PixelSpacing", "RowSpacing", "OutlierLimit"],
               {"Method": ["ThreeWires", "SingleWall", "PointTarget", "StylusPivot"]})
assert proxy.EstimateScale == 0 and not own.GetEstimateScale() and proxy.OutputFileName == ""

proxy.Method = "SingleWall"
try:
    with raising():
        proxy.UpdatePipeline()
    raise AssertionError("a pixel spacing was guessed")
except PipelineError as error:
    assert "PixelSpacing is 0" in str(error), error
proxy.PixelSpacing = scans.SPACING
file = output("CalibrationBath.xml")
if os.path.exists(file):
    os.remove(file)
proxy.OutputFileName = file
with raising():
    proxy.UpdatePipeline()
slices = result(proxy, 0)
found = field(slices, "ImageToProbe").reshape(4, 4)
error = scans.corner_error(found)
print("wall: corner error", error, "expected", field(slices, "ExpectedError"), "RMS", field(slices, "CalibrationRms"))
assert error < 0.5 and error < 3 * field(slices, "ExpectedError")
assert np.linalg.det(found[:3, :3]) > 0
reference = vtk_to_numpy(slices.GetFieldData().GetArray("ImageToReference")).reshape(-1, 4, 4)
assert np.abs(reference - np.array(poses) @ found).max() < 1e-9
# both spacings found, too
proxy.EstimateScale = 1
with raising():
    proxy.UpdatePipeline()
spacing = field(result(proxy, 0), "PixelSpacing")
assert np.abs(spacing / scans.SPACING - 1).max() < 0.01, spacing
proxy.EstimateScale = 0
with raising():
    proxy.UpdatePipeline()

# One calculation of a change, whichever outputs are fetched.
runs = []
proxy.GetClientSideObject().AddObserver("EndEvent", lambda *_: runs.append(1))
proxy.OutlierLimit = 4.5
with raising():
    proxy.UpdatePipeline()
for port in (0, 3, 1, 3, 4, 2):
    servermanager.Fetch(proxy, idx=port)
assert len(runs) == 1, runs
found = field(result(proxy, 0), "ImageToProbe").reshape(4, 4)

# The file is what the reader takes as calibration.
tree = xml.etree.ElementTree.parse(file)
(transform,) = tree.findall("CoordinateDefinitions/Transform")
assert (transform.get("From"), transform.get("To")) == ("Image", "Probe")
expected = field(result(proxy, 0), "ExpectedError")
assert abs(float(transform.get("Error")) - expected) < 1e-4
with open(file) as text:
    comment = text.read().split("-->")[0]
assert f"ExpectedError {expected:.3f} mm" in comment and "Advice: none" in comment, comment
written = np.array([float(x) for x in transform.get("Matrix").split()]).reshape(4, 4)
assert (written == found).all()
# It also serves a recording that has ProbeToTracker only.
recording = output("CalibrationTrackerOnly.igs.mha")
with open(recording, "wb") as out:
    header = ["ObjectType = Image", "NDims = 3", "BinaryData = True", "CompressedData = False",
              "UltrasoundImageOrientation = MFA", "UltrasoundImageType = BRIGHTNESS",
              "DimSize = 8 6 3", "ElementSpacing = 1 1 1", "ElementType = MET_UCHAR"]
    for i, pose in enumerate(poses[:3]):
        header += [f"Seq_Frame{i:04d}_ProbeToTrackerTransform = " + " ".join(f"{x:.9f}" for x in pose.ravel()),
                   f"Seq_Frame{i:04d}_ProbeToTrackerTransformStatus = OK", f"Seq_Frame{i:04d}_Timestamp = {0.1 * i}"]
    out.write("\n".join(header + ["ElementDataFile = LOCAL", ""]).encode() + bytes(8 * 6 * 3))
sweep = TrackedSliceReader(FileName=recording, CalibrationFileName=file, ReferenceFrame="Tracker")
with raising():
    sweep.UpdatePipeline()
reference = vtk_to_numpy(result(sweep, 0).GetFieldData().GetArray("ImageToReference")).reshape(-1, 4, 4)
assert np.abs(reference - np.array(poses[:3]) @ found).max() < 1e-6
# A hopeless result is an error, and does not take the good one's place.
with open(file) as text:
    good = text.read()
proxy.PixelSpacing = 3 * scans.SPACING
try:
    with raising():
        proxy.UpdatePipeline()
    raise AssertionError("a hopeless calibration was written")
except PipelineError as error:
    assert "is not written" in str(error), error
with open(file) as text:
    assert text.read() == good
proxy.PixelSpacing = scans.SPACING
with raising():
    proxy.UpdatePipeline()

# The floor is flat in a volume of the calibrated slices.
volume = SweptVolume(Input=OutputPort(proxy, 0), OutputSpacing=[1, 1, 1], PixelSampling="Nearest",
                     Interpolation="NearestVoxel", Compounding="Maximum")
with raising():
    volume.UpdatePipeline()
image = servermanager.Fetch(volume)
grey = vtk_to_numpy(image.GetPointData().GetArray("Intensity"))
bright = np.flatnonzero(grey > 180)
points = np.array([image.GetPoint(int(i)) for i in bright])
points -= points.mean(axis=0)
thickness = np.linalg.svd(points, compute_uv=False)[-1] / np.sqrt(len(points))
print("floor in the volume:", thickness, "mm RMS")
assert len(points) > 1000 and thickness < 1

# Three wires, from a table; one pick in the wrong place.
poses, rows = [], []
for i in range(30):
    wire = i % 3
    place = np.zeros(3)
    place[wire] = random.uniform(-40, 40)
    across = np.linalg.qr(np.column_stack([np.eye(3)[wire], random.normal(size=(3, 2))]))[0]
    turn = np.column_stack([across[:, 1], across[:, 2], np.cross(across[:, 1], across[:, 2])])
    turn = scans.rotation(random.normal(size=3), random.uniform(-35, 35)) @ turn
    pixel = random.uniform([10, 10], [scans.WIDTH - 10, scans.HEIGHT - 10])
    scan = scans.pose(turn, place - turn[:, :2] @ (scans.SPACING * pixel))
    poses.append(scans.probe_to_tracker(scan))
    picked = pixel + random.uniform(-0.5, 0.5, 2) / scans.SPACING + (40 if i == 7 else 0)
    rows.append([i, *picked, "XYZ"[wire]])
black = np.zeros((30, scans.HEIGHT, scans.WIDTH), np.uint8)
wires = scans.open_scan("CalibrationWires", black, poses)
table = scans.open_table("CalibrationWires", ["Slice", "Column", "Row", "Wire"], rows)
proxy = ProbeCalibration(Input=wires, Picks=table, PixelSpacing=scans.SPACING)
with raising():
    proxy.UpdatePipeline()
slices = result(proxy, 0)
error = scans.corner_error(field(slices, "ImageToProbe").reshape(4, 4))
print("wires: corner error", error, "expected", field(slices, "ExpectedError"))
assert error < 1 and error < 3 * field(slices, "ExpectedError")
residuals = result(proxy, 1)
assert [i for i in range(30) if not residuals.GetColumnByName("Used").GetValue(i)] == [7]
assert residuals.GetColumnByName("Error").GetValue(7) > 5
assert residuals.GetColumnByName("Target").GetValue(4) == "Y"
picture = result(proxy, 2)
assert picture.GetNumberOfVerts() == 30 and picture.GetNumberOfLines() == 3
rms = np.sqrt(np.mean([vtk_to_numpy(residuals.GetColumnByName("Error"))[i] ** 2 / 2 for i in range(30) if i != 7]))
assert abs(rms - field(slices, "CalibrationRms")) < 1e-9

# A point.
poses, rows = [], []
for i in range(25):
    turn = scans.looking_down(random, 50)
    pixel = random.uniform([10, 10], [scans.WIDTH - 10, scans.HEIGHT - 10])
    poses.append(scans.probe_to_tracker(scans.pose(turn, -turn[:, :2] @ (scans.SPACING * pixel))))
    rows.append([i, *pixel])
ball = scans.open_scan("CalibrationPoint", black[:25], poses)
table = scans.open_table("CalibrationPoint", ["Slice", "Column", "Row"], rows)
point = ProbeCalibration(Input=ball, Picks=table, Method="PointTarget", PixelSpacing=scans.SPACING)
with raising():
    point.UpdatePipeline()
found = field(result(point, 0), "ImageToProbe").reshape(4, 4)
assert scans.corner_error(found) < 1e-5

# The tip of a stylus, in a hole.
tip, hole = np.array([10, -20, 150]), np.array([200, 30, -60])
poses = []
for i in range(60):
    turn = scans.looking_down(random, 40)
    poses.append(scans.pose(turn, hole - turn @ tip + random.normal(0, 0.3, 3)))
stylus = ProbeCalibration(Input=scans.open_scan("CalibrationStylus", np.zeros((60, 2, 2), np.uint8), poses),
                          Method="StylusPivot")
with raising():
    stylus.UpdatePipeline()
fields = result(stylus, 0)
error = np.linalg.norm(field(fields, "StylusTip") - tip)
print("stylus: tip off by", error, "expected", field(fields, "ExpectedError"))
assert error < 0.4 and error < 3 * field(fields, "ExpectedError")

# What cannot be is said.
for rows, columns, words in [
        ([], ["Slice", "Column", "Row", "Wire"], "0 equations"),
        ([[0, 5, 5, "X"]], ["Slice", "Column", "Line", "Wire"], "has no column 'Row'"),
        ([[0, 5, 5, "Q"]], ["Slice", "Column", "Row", "Wire"], "row 0 of the table of picks has 'Q' as Wire"),
        ([[0, 5, 5, "X"], [30, 5, 5, "X"]], ["Slice", "Column", "Row", "Wire"], "has slices 0 to 29"),
        ([[0, 5, 5, "X"], [2, "five", 5, "X"]], ["Slice", "Column", "Row", "Wire"], "row 1")]:
    proxy.Picks = scans.open_table("CalibrationBad", columns, rows)
    try:
        with raising():
            proxy.UpdatePipeline()
        raise AssertionError("taken: " + words)
    except PipelineError as error:
        assert words in str(error), (words, error)
