# SPDX-License-Identifier: BSD-3-Clause
"""A probe is calibrated by picks of three wires: how far off each is, and what error to expect where in the image.

    pvpython in_paraview.py [folder for picture and state file, default: .]

Writes calibration.png and calibration.pvsm, for File > Load State.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import pictures, states
from paraview.simple import *

# A simulated scan: thirty poses of the tracker, and the wires as picked in each slice with errors of up to 1 mm.
# Of your own: TrackedSliceReader(FileName="bath.igs.mha"), and CSVReader(FileName=["picks.csv"]) or WireRanges
SCAN = """
import numpy as np


def rotation(axis, degrees):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    cross, angle = np.cross(np.eye(3), -axis), np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def pose(turn, origin):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, origin
    return matrix


random = np.random.default_rng(4)
image_to_probe, bath_to_tracker = pose(rotation([1, 2, -0.5], 70), [30, -95, 150]), pose(rotation([0.3, -1, 0.4], 130), [200, -80, 350])
poses, picks = [], []
for i in range(30):
    wire = i % 3
    across, place, axis = [(wire + 1) % 3, (wire + 2) % 3], np.zeros(3), np.zeros(3)
    place[wire], axis[across] = random.uniform(-60, 60), random.normal(size=2)
    turn = rotation(axis, 60 * np.sqrt(random.random())) @ np.eye(3)[:, [*across, wire]] @ rotation([0, 0, 1], random.uniform(-160, 160))
    pixel = random.uniform([15, 15], [285, 225])
    scan = pose(turn, place - turn[:, :2] @ (0.3 * pixel))  # the image, in mm, to the bath
    poses.append((bath_to_tracker @ scan @ np.linalg.inv(image_to_probe)).ravel())
    picks.append((i, *(pixel + random.uniform(-1, 1, 2) / 0.3), "XYZ"[wire]))
"""
slices = ProgrammableSource(registrationName="Scan", OutputDataSetType="vtkImageData", Script=SCAN + """
from vtkmodules.util.numpy_support import numpy_to_vtk
output.SetDimensions(300, 240, 30)
arrays = {"Intensity": np.zeros(300 * 240 * 30, np.uint8), "ProbeToTracker": np.array(poses), "SliceStatus": np.zeros(30, np.uint8),
          "FrameNumber": np.arange(30, dtype=np.int32), "Timestamp": np.arange(30.0)}
for name, values in arrays.items():
    array = numpy_to_vtk(values, deep=1)
    array.SetName(name)
    (output.GetPointData().SetScalars if name == "Intensity" else output.GetFieldData().AddArray)(array)
""", ScriptRequestInformation="""
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
self.GetOutputInformation(0).Set(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT(), 0, 299, 0, 239, 0, 29)
""")
table = ProgrammableSource(registrationName="Picks", OutputDataSetType="vtkTable", Script=SCAN + """
from vtkmodules.vtkCommonCore import vtkStringArray
for k, name in enumerate(("Slice", "Column", "Row")):
    output.RowData.append(np.array([float(pick[k]) for pick in picks]), name)
names = vtkStringArray()
names.SetName("Wire")
for pick in picks:
    names.InsertNextValue(pick[3])
output.VTKObject.AddColumn(names)
""")
calibration = ProbeCalibration(registrationName="Calibration", Input=slices, Picks=table, PixelSpacing=0.3)

wires = pictures.new_view((760, 640))
picked = Glyph(registrationName="Picks in the bath", Input=OutputPort(calibration, 2), GlyphType="Sphere", ScaleArray=["POINTS", "No scale array"],
               ScaleFactor=3, GlyphMode="All Points")
pictures.show_surface(OutputPort(calibration, 2), wires, (0.4, 0.4, 0.45)).LineWidth = 2
pictures.color_by(pictures.show_surface(picked, wires, pictures.METAL), wires, "Error", "Distance from its wire (mm)", (0, 1.5), "Viridis")
pictures.add_title(wires, "Picks and wires")
pictures.look(wires, (-0.7, 1, -0.5), (0, 0, 1), 1.5)
expected = pictures.new_view((760, 640))
pictures.show_image(OutputPort(calibration, 3), expected, "ExpectedError", "Expected error (mm)", (0, 1), "Viridis")
pictures.add_title(expected, "Error to expect, over the image")
pictures.look(expected, (0, 0, 1), (0, -1, 0), 1)
views = [wires, expected]
layout = pictures.lay_out(views, "Calibration")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "calibration.png"))
states.save(os.path.join(folder, "calibration.pvsm"))
