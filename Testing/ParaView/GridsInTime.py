# SPDX-License-Identifier: BSD-3-Clause
"""Grids that grow and shrink with time: never cut to those of an earlier time, but refused until VTK asks anew."""
import os

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
SLICES = NOW + """
from vtkmodules.util.numpy_support import vtk_to_numpy
output.ShallowCopy(self.GetInputDataObject(0, 0))
output.GetInformation().Set(output.DATA_TIME_STEP(), time)
for name in "ImageToReference", "ProbeToReference":
    poses = vtk_to_numpy(output.GetFieldData().GetArray(name)).copy()
    poses[:, 3] += 10 * time * np.linspace(0, 1, len(poses)) # x of the translation
    array = numpy_to_vtk(poses, deep=1)
    array.SetName(name)
    output.GetFieldData().AddArray(array)
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


def sweep():
    slices = pv.PhantomSweep(Motion="Arbitrary", NumberOfSlices=20, ImageSize=[80, 60], PixelSpacing=0.8)
    return pv.ProgrammableFilter(Input=slices, RequestInformationScript=TIMES, Script=SLICES)


def swept(**properties):
    return pv.SweptVolume(Input=sweep(), OutputSpacing=[2, 2, 2], **properties)


def ray_cast(**properties):
    return pv.SliceRayCaster(Input=sweep(), IsoValue=100, ViewDirection=[0.2, 1, 0.3], PixelSpacing=1, **properties)


def count_points(output, time):
    """Points of a surface behind an output, and what was said instead."""
    surface = pv.ExtractSurface(Input=output)
    try:
        with raising():
            surface.UpdatePipeline(time)
    except RuntimeError as error:
        assert "was announced" in str(error), error
        assert surface.GetDataInformation().GetNumberOfPoints() == 0
        return 0, str(error)
    return surface.GetDataInformation().GetNumberOfPoints(), ""


def tell(output):
    """As by a change of a property: VTK asks anew what the filter makes, of the data at hand."""
    output.GetClientSideObject().Modified()


for make in (interpolator, press, model, swept, ray_cast):
    sizes = []
    kept = make()
    for time in (1.0, 3.0, 2.0, 1.0):
        points, said = count_points(kept, time)
        assert (points > 0) == (not said) == (not sizes), (make.__name__, time, points, said)
        tell(kept)
        points, said = count_points(kept, time)
        assert not said and points > 0, (make.__name__, time, said)
        sizes.append(points)
    print(make.__name__, sizes)
    assert sizes[0] == sizes[3] and len(set(sizes)) == 3, sizes

# a grid that does not depend on what is in it is never refused
bounds = [0, 12, 0, 12, 0, 12]
for fixed in (interpolator(OutputBounds=bounds), swept(OutputBounds=bounds),
              ray_cast(FocalPoint=[0, 0, 0], PlaneOrigin=[0, -50, 0], ImageSize=[60, 60])):
    for time in (1.0, 3.0, 2.0):
        points, said = count_points(fixed, time)
        assert points > 0 and not said, (time, said)

# files of all times: VTK's writer would ask for ever if it failed
series = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "GridsInTime.vtp")
said = ""
try:
    with raising():
        pv.SaveData(series, pv.ExtractSurface(Input=interpolator()), Writetimestepsasfileseries=1, DataMode="Binary")
except RuntimeError as error:
    said = str(error)
assert "since the grid was announced" in said, said
saved = []
for number in range(3):
    file = pv.XMLPolyDataReader(FileName=series.replace(".vtp", f"_{number}.vtp"))
    file.UpdatePipeline()
    saved.append(file.GetDataInformation().GetNumberOfPoints())
assert saved == [602, 0, 0], saved

# an error at one time does not take away what is made at another
flaky = pv.RBFInterpolator(OutputSpacing=[1, 1, 1], Input=pv.ProgrammableSource(
    OutputDataSetType="vtkPolyData", ScriptRequestInformation=TIMES, Script=POINTS.replace("places *= 10 * time", "places *= np.nan if time == 2 else 10")))
for time in (1.0, 2.0, 1.0, 1.0):
    try:
        with raising():
            flaky.UpdatePipeline(time)
    except RuntimeError:
        assert time == 2.0
    assert flaky.GetDataInformation().GetNumberOfPoints() == (0 if time == 2.0 else 11**3), time
print("ok")
