# SPDX-License-Identifier: BSD-3-Clause
"""Milling Tool Path and G-Code Writer in ParaView: defaults, a mould, its map, Save Data, refusals."""
import os

import numpy as np
from gcode_files import read_gcode
from lacuna.errors import raising
from lacuna_test import output
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkObject, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkStructuredGrid

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
import lacuna


def producer(data):
    source = TrivialProducer()
    source.GetClientSideObject().SetOutput(data)
    source.UpdatePipeline()
    return source


def mould(height):
    """61 x 41 points at 1 mm."""
    x, y = np.meshgrid(np.arange(61.0), np.arange(41.0))
    grid = vtkStructuredGrid()
    grid.SetDimensions(61, 41, 1)
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.stack([x, y, height(x, y)], axis=2).reshape(-1, 3), deep=True))
    grid.SetPoints(points)
    matrix = numpy_to_vtk(np.eye(4).reshape(1, 16), deep=True)
    matrix.SetName("PressToPatient")
    grid.GetFieldData().AddArray(matrix)
    return producer(grid)


def array(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def field(data, name):
    return vtk_to_numpy(data.GetFieldData().GetArray(name))[0]


def distinct(steps):
    """Without motions to where the tool is."""
    keep = np.ones(len(steps), bool)
    keep[1:] = np.any(np.abs(np.diff(steps[:, :3], axis=0)) > 1e-9, axis=1)
    return steps[keep]


# The defaults of the proxies are those of the classes.
skull = mould(lambda x, y: -0.004 * (x - 25) ** 2 - 0.003 * (y - 15) ** 2 + 0.3 * np.sin(x / 5 + y / 9) - 4)
path = MillingToolPath(Input=skull)
reference = lacuna.vtkLacunaMillingToolPath()
for name in ("ToolRadius", "StepOver", "ScallopHeight", "Overrun", "Direction", "RoughingStep", "RoughingStepOver", "StockAllowance",
             "StockTop", "SafeHeight", "LeadRadius", "PathStep", "Tolerance", "FeedRate", "PlungeFeedRate",
             "RapidFeedRate", "SpindleSpeed", "MapSpacing", "LeftOverLimit", "Finishing"):
    assert getattr(path, name) == getattr(reference, "Get" + name)(), name
assert path.ToolShape == "Ball" and path.Pattern == "ZigZag" and reference.GetToolShape() == reference.GetPattern() == 0

# A path and its map
path.RoughingStep = 3
path.StockTop = 1
path.UpdatePipeline()
lines = servermanager.Fetch(path, idx=0)
surface = servermanager.Fetch(path, idx=1)
assert field(lines, "LargestGouge") <= 0.001
assert field(lines, "Levels") >= 2 and set(array(lines, "Motion")) == {0, 1, 2, 3}
assert np.all(np.diff(array(lines, "Time")) >= 0)
assert abs(array(lines, "Time")[-1] - field(lines, "MachiningTime")) < 1e-9
assert set(array(lines, "FeedRate")) == {200, 800, 5000}
assert lines.GetFieldData().GetArray("PressToPatient").GetNumberOfComponents() == 16
scallop = 4 - np.sqrt(16 - 0.25)
points = vtk_to_numpy(surface.GetPoints().GetData())
inside = np.all((points[:, :2] > 5) & (points[:, :2] < (55, 35)), axis=1)
largest = array(surface, "LeftOver")[inside].max()
assert 0.9 * scallop < largest < 1.3 * scallop, largest
assert np.all(array(surface, "MachinedHeight") > points[:, 2] - 0.001)
assert array(surface, "Unreachable")[inside].max() < 0.01

# A flat part: the scallops of the formula, everywhere within 5 % of the highest
flat = MillingToolPath(Input=mould(lambda x, y: 0 * x - 2), MapSpacing=0.125)
flat.UpdatePipeline()
surface = servermanager.Fetch(flat, idx=1)
points = vtk_to_numpy(surface.GetPoints().GetData())
away = np.abs(points[:, 1] - np.round(points[:, 1]))
middle = (points[:, 0] > 1) & (points[:, 0] < 59)
error = np.abs(array(surface, "LeftOver") - (np.sqrt(16 + away**2) - 4))[middle].max()
print(f"scallop {array(surface, 'LeftOver').max():.6f} mm, formula {scallop:.6f} mm, map within {error:.1e} mm", flush=True)
assert abs(array(surface, "LeftOver").max() - scallop) < 0.05 * scallop and error < 1e-6

# Time for animations: what has been cut after a while
threshold = Threshold(Input=path, Scalars=["POINTS", "Time"], LowerThreshold=0, UpperThreshold=30)
threshold.UpdatePipeline()
assert 0 < threshold.GetDataInformation().GetNumberOfPoints() < lines.GetNumberOfPoints()

# Save Data, both extensions; the file reproduces the path
for name in ("MillingToolPath.nc", "MillingToolPath.gcode"):
    file = output(name)
    SaveData(file, path, ToolNumber=3, AcceptWarnings=1)  # of the border
    steps = distinct(read_gcode(file))
    expected = np.column_stack([vtk_to_numpy(lines.GetPoints().GetData()),
                                np.where(array(lines, "Motion") == 0, 0, array(lines, "FeedRate"))])
    expected[0, 3] = 0
    expected = distinct(expected)
    assert len(steps) == len(expected), (len(steps), len(expected))
    assert np.abs(steps - expected).max() < 1e-9
with open(output("MillingToolPath.nc"), encoding="ascii") as file:
    text = file.read()
assert "T03 M06" in text and "(T3 BALL END, DIAMETER 8 MM)" in text and "S6000 M03" in text
writer = CreateWriter(output("Options.nc"), path)
assert writer.GetXMLLabel() == "G-Code Writer", writer.GetXMLLabel()
plain = lacuna.vtkLacunaGCodeWriter()
for name in ("ProgramNumber", "ToolNumber", "WorkOffset", "SpindleSpeed", "LineNumbers", "AcceptWarnings", "AllowMirrored",
             "ArcTolerance"):
    assert getattr(writer, name) == getattr(plain, "Get" + name)(), name
assert list(writer.Envelope) == list(plain.GetEnvelope()) and not writer.Header and not writer.Footer
writer.LineNumbers = 1
writer.AcceptWarnings = 1
writer.Header = "G21 G90 (MINE)\nT{TOOL} M06\nS{SPEED} M03"
warnings = []
with raising(warnings):
    writer.UpdatePipeline()
assert len(warnings) == 1 and "Header has no G43" in warnings[0], warnings
writer.UpdatePropertyInformation()
assert writer.GetPropertyValue("FileSize") == os.path.getsize(output("Options.nc"))
with open(output("Options.nc"), encoding="ascii") as file:
    assert "\nN10 G21 G17 G40 G49 G80 G90 G94 G54\nN20 G21 G90 (MINE)\nN30 T01 M06\n" in file.read()

# Motions joined to arcs: a shorter program
file = output("Arcs.nc")
SaveData(file, path, ArcTolerance=0.005, AcceptWarnings=1)
with open(file, encoding="ascii") as program:
    arcs = program.read()
assert len(arcs.splitlines()) < 0.7 * len(text.splitlines()) and "\nG18\nG0" in arcs and "G18" not in text

# Refused: outside of the envelope, inches and increments, a plunge at the end, a mirrored path, no path. No file is left.
vtkObject.GlobalWarningDisplayOff()
file = output("Refused.nc")
if os.path.exists(file):
    os.remove(file)
SaveData(file, path, Envelope=[0, 61, 0, 41, -50, 50], AcceptWarnings=1)
assert not os.path.exists(file)
for options in ({"Header": "G20 G91\nS{SPEED} M03"}, {"Footer": "G00 Z-50.\nM30"}):
    SaveData(file, path, AcceptWarnings=1, **options)
    assert not os.path.exists(file), options
moved = Transform(Input=path)
moved.Transform.Scale = [-1, 1, 1]  # PressToPatient would go along unchanged
SaveData(file, moved, AcceptWarnings=1)
assert not os.path.exists(file)
SaveData(file, Sphere())
assert not os.path.exists(file)
print("ok")
