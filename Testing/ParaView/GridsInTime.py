# SPDX-License-Identifier: BSD-3-Clause
"""Grids that grow and shrink with time: never cut to those of an earlier time. The first update says so, the second has the whole."""
import lacuna.plugin
from lacuna.errors import raising
from paraview import simple as pv

lacuna.plugin.load()

TIMES = """
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
info = self.GetExecutive().GetOutputInformation(0)
info.Set(Pipeline.TIME_STEPS(), [1.0, 2.0, 3.0], 3)
info.Set(Pipeline.TIME_RANGE(), [1.0, 3.0], 2)
"""
NOW = """
import numpy as np
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.util.numpy_support import numpy_to_vtk
info = self.GetExecutive().GetOutputInformation(0)
time = info.Get(Pipeline.UPDATE_TIME_STEP()) if info.Has(Pipeline.UPDATE_TIME_STEP()) else 1.0
output = self.GetOutputDataObject(0)
output.GetInformation().Set(output.DATA_TIME_STEP(), time)
"""
POINTS = NOW + """
from vtkmodules.vtkCommonCore import vtkPoints
places = np.random.default_rng(1).random((60, 3))
places[:2] = [0, 0, 0], [1, 1, 1]
places *= 10 * time
points = vtkPoints()
points.SetData(numpy_to_vtk(places, deep=1))
output.SetPoints(points)
values = numpy_to_vtk(places[:, 0].copy(), deep=1)
values.SetName("Value")
output.GetPointData().SetScalars(values)
"""
DEFECT = NOW + """
map = self.GetInputDataObject(0, 0)
output.ShallowCopy(map)
columns, rows, _ = map.GetDimensions()
marks = np.zeros((rows, columns), np.uint8)
half = int(3 * time) + 1
marks[rows // 2 - half:rows // 2 + half, columns // 2 - half:columns // 2 + half] = 1
array = numpy_to_vtk(marks.ravel(), deep=1)
array.SetName("Defect")
output.GetPointData().AddArray(array)
"""


def interpolator(**properties):
    source = pv.ProgrammableSource(OutputDataSetType="vtkPolyData", ScriptRequestInformation=TIMES, Script=POINTS)
    return pv.OutputPort(pv.RBFInterpolator(Input=source, OutputSpacing=[1, 1, 1], **properties), 0)


def filled():
    caster = pv.BSplineIsoRayCaster(Input=pv.SkullPhantom(Spacing=[2, 2, 2]), IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9])
    marked = pv.ProgrammableFilter(Input=caster, RequestInformationScript=TIMES, Script=DEFECT)
    return pv.RBFHoleFiller(Input=marked, DefectArray="Defect", SupportMargin=12, OutputMargin=25)


def press():
    return pv.OutputPort(pv.PressOrientation(Input=filled(), PlateMargin=1, FlangeWidth=2), 0)


def model():
    return pv.OutputPort(pv.DefectModel(Input=filled()), 1)


def count_points(proxy, time):
    """Points of a surface behind an output, and with which error the first update has refused it."""
    surface = pv.ExtractSurface(Input=proxy)
    refused = ""
    try:
        with raising():
            surface.UpdatePipeline(time)
    except RuntimeError as error:
        refused = str(error)
        assert "has become one of" in refused and "update again" in refused, refused
        assert surface.GetDataInformation().GetNumberOfPoints() == 0
    with raising():
        surface.UpdatePipeline(time)
    return surface.GetDataInformation().GetNumberOfPoints(), refused


for make in (interpolator, press, model):
    # what filters that have seen no other time give
    fresh = {time: count_points(make(), time)[0] for time in (1.0, 2.0, 3.0)}
    print(make.__name__, fresh)
    assert 0 < fresh[1.0] < fresh[2.0] < fresh[3.0], fresh
    kept = make()
    for time in (1.0, 3.0, 2.0, 2.0, 1.0):
        points, refused = count_points(kept, time)
        assert points == fresh[time], (make.__name__, time, points, fresh, refused)
# a grid that does not depend on the points is never refused
fixed = interpolator(OutputBounds=[0, 12, 0, 12, 0, 12])
for time in (1.0, 3.0, 2.0):
    points, refused = count_points(fixed, time)
    assert not refused and points > 0, (time, points, refused)
print("ok")
