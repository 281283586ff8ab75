# SPDX-License-Identifier: BSD-3-Clause
"""Tracker Self Test through ParaView: two receivers on a stick, near a piece of iron whose effect is known."""
import os

import numpy as np
from paraview.simple import *
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy

import calibration_scans as scans
from lacuna_test import check_defaults

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna import vtkLacunaTrackerSelfTest
from lacuna.errors import PipelineError, raising

random = np.random.default_rng(5)
SECOND_TO_FIRST = scans.pose(scans.rotation([1, 2, -0.5], 70), [260, -110, 90])
IRON = np.array([450, 250, -150])


def shift(place):
    return np.exp(-np.sum((place - IRON) ** 2) / (2 * 130 ** 2)) * np.array([14, -6, 9])


def measure(pose):
    return scans.pose(pose[:3, :3], pose[:3, 3] + shift(pose[:3, 3]))


def euler(pose):
    """Azimuth, elevation, roll in degrees."""
    r = pose[:3, :3]
    return np.degrees([np.arctan2(r[1, 0], r[0, 0]), -np.arcsin(r[2, 0]), np.arctan2(r[2, 1], r[2, 2])])


# 250 places, twice each
truth = [scans.pose(scans.rotation(random.normal(size=3), random.uniform(-60, 60)), random.uniform([200, -250, -150], [500, 200, 150]))
         for _ in range(250)] * 2
first, second = ([measure(pose @ fixed) for pose in truth] for fixed in (np.eye(4), SECOND_TO_FIRST))
rows = []
for i, poses in enumerate(zip(first, second)):
    for station, pose in enumerate(poses, 1):
        rows.append([30 * i + 0.0083 * station, station, *(pose[:3, 3] / 10), *euler(pose)])
records = scans.open_table("TrackerSelfTest", ["Time", "Station", "x", "y", "z", "azimuth", "elevation", "roll"], rows)
proxy = TrackerSelfTest(Input=records)
names = ["SpeedLimit", "RevisitDistance", "RevisitAngle", "TranslationAccuracy", "AngularAccuracy", "RangeLimit",
         "FirstReceiver", "SecondReceiver"]
check_defaults(proxy, vtkLacunaTrackerSelfTest(), names, {"PoseFormat": ["Matrix", "Quaternion", "Euler"],
                                                          "LengthUnit": ["mm", "m", "cm", "inch"]})
assert list(proxy.Stations) == [1, 2]
proxy.LengthUnit = "cm"
with raising():
    proxy.UpdatePipeline()
points = servermanager.Fetch(proxy)
fields = points.GetFieldData()
assert points.GetNumberOfPoints() == len(truth)


def figure(name):
    return fields.GetArray(name).GetValue(0)


found = vtk_to_numpy(fields.GetArray("SecondToFirst")).reshape(4, 4)
assert np.abs(found - SECOND_TO_FIRST).max() < 0.5, found
deviation = vtk_to_numpy(points.GetPointData().GetArray("Deviation"))
expected = np.array([shift((pose @ SECOND_TO_FIRST)[:3, 3]) - shift(pose[:3, 3]) for pose in truth])
print("largest error of a deviation", np.abs(deviation - expected).max(), "mm; largest deviation", figure("PositionMaximum"))
assert np.abs(deviation - expected).max() < 0.6 and np.abs(expected).max() > 8
separation = vtk_to_numpy(points.GetPointData().GetArray("SeparationError"))
measured = np.array([np.linalg.norm(b[:3, 3] - a[:3, 3]) for a, b in zip(first, second)])
assert np.abs(separation + figure("Separation") - measured).max() < 1e-9
assert abs(figure("SeparationRange") - np.ptp(measured)) < 1e-9
assert figure("RevisitedPlaces") == figure("Places") and figure("Repeatability") < 0.2 * figure("Warp")
advice = fields.GetAbstractArray("Advice")
advice = [advice.GetValue(i) for i in range(advice.GetNumberOfValues())]
print("\n".join(advice))
assert "in some places" in advice[0] and any("metal" in sentence for sentence in advice)
tables = [servermanager.Fetch(proxy, idx=port) for port in (1, 2)]
counts = vtk_to_numpy(tables[0].GetColumnByName("Pairs"))
assert counts.sum() == len(truth)
change = vtk_to_numpy(tables[1].GetColumnByName("PositionChange"))
assert change[0] < change[2]

# the same as slices, which name the receivers themselves
slices = scans.open_scan("TrackerSelfTest", np.zeros((len(first), 2, 2), np.uint8), first)
programmable = ProgrammableFilter(Input=slices, Script="""
output.DeepCopy(inputs[0].VTKObject)
array = numpy.array(%r).reshape(-1, 16)
output.FieldData.append(array, "SecondToTracker")
""" % np.array(second).ravel().tolist())
programmable.OutputDataSetType = "vtkImageData"
own = TrackerSelfTest(Input=programmable, SpeedLimit=0)
with raising():
    own.UpdatePipeline()
again = servermanager.Fetch(own)
assert np.abs(vtk_to_numpy(again.GetPointData().GetArray("Deviation")) - deviation).max() < 1e-6

own.SecondReceiver = "PenToTracker"
try:
    with raising():
        own.UpdatePipeline()
    raise AssertionError("a transform that is not there was taken")
except PipelineError as error:
    assert "'PenToTracker' is missing" in str(error), error
