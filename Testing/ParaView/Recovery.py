# SPDX-License-Identifier: BSD-3-Clause
"""After an error the output is empty, and once its cause is mended the result is whole: for every
algorithm, in ParaView and for the classes alone. Also: what a filter makes of divided or damaged input."""
import os

import lacuna
import lacuna.plugin
import numpy as np
import paraview.simple as pv
from lacuna.data import fetch
from lacuna.errors import PipelineError, raising
from lacuna_test import output
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkSphere
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

lacuna.plugin.load()


def points(proxy):
    with raising():
        proxy.UpdatePipeline()
    return proxy.GetDataInformation().GetNumberOfPoints()


def recovers(proxy, name, bad, good):
    """bad gives an error, then every value of good its number of points."""
    setattr(proxy, name, bad)
    try:
        points(proxy)
        raise AssertionError(f"{proxy} accepts {name} = {bad}")
    except PipelineError:
        pass
    assert proxy.GetDataInformation().GetNumberOfPoints() == 0
    for value, expected in good:
        setattr(proxy, name, value)
        found = points(proxy)
        assert found == expected, (name, value, found, expected)


sweep = pv.PhantomSweep(NumberOfSlices=12, ImageSize=[40, 30], PixelSpacing=1.0)
recovers(sweep, "NumberOfSlices", 0, [(5, 6000), (12, 14400), (3, 3600), (12, 14400)])
volume = pv.SweptVolume(Input=sweep, OutputSpacing=[2, 2, 2])
whole = points(volume)
volume.OutputSpacing = [3, 3, 3]
coarse = points(volume)
assert 0 < coarse < whole
recovers(volume, "OutputSpacing", [-2, 2, 2], [([3, 3, 3], coarse), ([2, 2, 2], whole), ([3, 3, 3], coarse)])

skull = pv.SkullPhantom(Spacing=[4, 4, 4])
voxels = points(skull)
recovers(skull, "Spacing", [-1, 4, 4], [([4, 4, 4], voxels)])
caster = pv.BSplineIsoRayCaster(Input=skull, IsoValues=[500], PixelSpacing=9)
pixels = points(caster)
caster.PixelSpacing = 5
recovers(caster, "ViewUp", [0, 0, 0], [([0, 1, 0], points(pv.BSplineIsoRayCaster(Input=skull, IsoValues=[500],
                                                                                 PixelSpacing=5)))])
caster.PixelSpacing = 9
assert points(caster) == pixels < 1000
shader = pv.DepthMapShader(Input=caster)
recovers(shader, "Lights", [0, 0, 0, 0, 1], [([0, 0, 1, 0, 1], pixels), ([], pixels)])
recovers(shader, "DepthArray", "Fitted", [("Depth", pixels)])

# what was announced as too large leaves nothing behind either, also in what comes after
for proxy, name, huge, small, other in (
        (pv.BSplineIsoRayCaster(Input=skull, IsoValues=[500]), "PixelSpacing", 1e-4, 5, 9),
        (pv.SliceRayCaster(Input=sweep, IsoValue=100), "PixelSpacing", 1e-5, 2, 3)):
    expected = []
    for value in (small, other):
        setattr(proxy, name, value)
        expected.append((value, points(proxy)))
    assert expected[0][1] > expected[1][1] > 0, (proxy, expected)
    recovers(proxy, name, huge, expected)

# a reader says what is wrong each time it is asked, not only when a script makes it
with open(output("RecoveryCut.igs.mha"), "wb") as file:
    file.write(b"ObjectType = Image\nNDims = 3\n")
for name, word in ("RecoveryNone.igs.mha", "RecoveryNone"), ("RecoveryCut.igs.mha", "RecoveryCut"):
    for make in (lambda reader: reader, lambda reader: pv.SweptVolume(Input=reader),
                 lambda reader: pv.SpeckleFilter(Input=reader), lambda reader: pv.GateSlices(Input=reader)):
        proxy = make(pv.TrackedSliceReader(FileName=output(name)))
        try:
            points(proxy)
            raise AssertionError(f"{proxy} has nothing to say of {name}")
        except PipelineError as error:
            assert word in str(error), (proxy, str(error))

# A file that Lacuna writes again while something is wrong stays as it was, and each try says what is wrong: of
# announcements as of data, of the filter itself as of one upstream.
skull = pv.SkullPhantom(Spacing=[4] * 3)
caster = pv.BSplineIsoRayCaster(Input=skull, IsoValues=[500], PixelSpacing=3, ViewDirection=[-0.4, 0.2, -0.9])
filler = pv.RBFHoleFiller(Input=caster, NodeSpacing=4, DefectRegion="Sphere")
filler.DefectRegion.Center = [28, -14, 63]
filler.DefectRegion.Radius = 39
shader = pv.DepthMapShader(Input=filler)
pixels = points(shader)
saved = output("RecoverySaved.igs")
for proxy, name, bad, good, word in ((skull, "Spacing", [-1] * 3, [4] * 3, "Spacing is -1"),
                                     (skull, "Spacing", [1e-3] * 3, [4] * 3, "bytes"),
                                     (caster, "PixelSpacing", 1e-4, 3, "is too large"),
                                     (caster, "ViewUp", [0, 0, 0], [0, 1, 0], "view-up"),
                                     (filler, "SupportMargin", -1, 12, "SupportMargin is -1")):
    pv.SaveData(saved, proxy=filler)
    before = open(saved, "rb").read()
    setattr(proxy, name, bad)
    for update in (shader.UpdatePipeline, *[lambda: pv.SaveData(saved, proxy=filler)] * 2):
        try:
            with raising():
                update()
            raise AssertionError(f"{name} = {bad}: nothing is said")
        except PipelineError as error:
            assert word in str(error), (name, bad, str(error))
    assert open(saved, "rb").read() == before, (name, bad)
    fields = pv.servermanager.Fetch(shader).GetFieldData()
    assert word in fields.GetAbstractArray("LacunaError").GetValue(0), (name, bad)
    setattr(proxy, name, good)
    assert points(shader) == pixels, (name, good, points(shader))
    assert not pv.servermanager.Fetch(shader).GetFieldData().HasArray("LacunaError"), (name, good)

# What ParaView's own filters make of the rest passes for the whole: raising() looks behind it, fetch() into its blocks.
planes = pv.SlicePlanes(Input=pv.PhantomSweep(NumberOfSlices=4, ImageSize=[20, 20], PixelSpacing=1))
ball = pv.Sphere()
joined = [make(Input=both) for make in (pv.AppendGeometry, pv.AppendDatasets, pv.GroupDatasets) for both in ([planes, ball], [ball, planes])]
for stride, expected in (1, 1600 + 50), (0, 50), (2, 800 + 50):
    planes.Stride = stride
    for each in (planes, *joined):
        for _ in range(2):  # what has failed before does not say so again
            try:
                with raising(proxies=[each]):
                    each.UpdatePipeline()
                assert stride, f"{each}: nothing is said"
            except PipelineError as error:
                assert str(error) == "Stride is 0; it must be 1 or more" and not stride, (each, stride, str(error))
        assert each == planes or each.GetDataInformation().GetNumberOfPoints() == expected, (each, stride)
    for group in joined[-2:]:
        try:
            fetch(group)
            assert stride, "fetch says nothing"
        except PipelineError as error:
            assert "Stride" in str(error) and not stride, error

# a writer that takes blocks does not leave out the one that has failed
model = pv.GroupDatasets(Input=[pv.Ellipse(), filler])
saved = output("RecoveryBlocks.igs")
pv.SaveData(saved, proxy=model)
before = open(saved, "rb").read()
filler.SupportMargin = -1
try:
    with raising():
        pv.SaveData(saved, proxy=model)
    raise AssertionError("nothing is said of the block that has failed")
except PipelineError as error:
    assert "SupportMargin is -1" in str(error), error
assert open(saved, "rb").read() == before
filler.SupportMargin = 12

# of times an error belongs to its own
class Sweeps(VTKPythonAlgorithmBase):
    """Slices without poses at time 1."""

    def __init__(self):
        super().__init__(nInputPorts=0, outputType="vtkImageData")
        self.Sweep = lacuna.vtkLacunaPhantomSweep()
        self.Sweep.SetNumberOfSlices(6)
        self.Sweep.SetImageSize(30, 20)
        self.Sweep.SetPixelSpacing(1)
        self.Sweep.Update()

    def RequestInformation(self, _request, _inputs, outputs):
        info = outputs.GetInformationObject(0)
        info.Set(Pipeline.WHOLE_EXTENT(), self.Sweep.GetOutput().GetExtent(), 6)
        info.Set(Pipeline.TIME_STEPS(), [0.0, 1.0], 2)
        info.Set(Pipeline.TIME_RANGE(), [0.0, 1.0], 2)
        return 1

    def RequestData(self, _request, _inputs, outputs):
        info = outputs.GetInformationObject(0)
        time = info.Get(Pipeline.UPDATE_TIME_STEP()) if info.Has(Pipeline.UPDATE_TIME_STEP()) else 0
        image = vtkImageData.GetData(outputs, 0)
        image.DeepCopy(self.Sweep.GetOutput())
        if time == 1:
            image.GetFieldData().RemoveArray("ImageToReference")
        image.GetInformation().Set(image.DATA_TIME_STEP(), time)
        return 1


for filter in lacuna.vtkLacunaSweptVolume(), lacuna.vtkLacunaSliceRayCaster():
    slices = Sweeps()
    filter.SetInputConnection(slices.GetOutputPort())
    if filter.GetClassName() == "vtkLacunaSweptVolume":
        filter.SetOutputSpacing(2, 2, 2)
    else:
        filter.SetIsoValue(100)
    filter.UpdateTimeStep(0)
    whole = filter.GetOutput().GetNumberOfPoints()
    assert whole > 0
    for time in (1, 1, 0, 0, 1, 0):
        said = ""
        try:
            with raising():
                filter.UpdateTimeStep(time)
        except PipelineError as error:
            said = str(error)
        assert ("ImageToReference" in said) == (time == 1), (filter.GetClassName(), time, said)
        assert filter.GetOutput().GetNumberOfPoints() == (0 if time else whole), (filter.GetClassName(), time)

# classes alone: no older result passes for the one asked for
direct = lacuna.vtkLacunaSkullPhantom()
direct.SetSpacing(4, 4, 4)
direct.Update()
assert direct.GetOutput().GetNumberOfPoints() == voxels
direct.SetNoiseLevel(-1)
try:
    with raising():
        direct.Update()
    raise AssertionError("a negative noise was accepted")
except PipelineError:
    assert direct.GetOutput().GetNumberOfPoints() == 0
direct.SetNoiseLevel(0)
direct.SetSpacing(1e-3, 1e-3, 1e-3)
try:
    with raising():
        direct.Update()
    raise AssertionError("a skull of 10 petabytes was made")
except PipelineError:
    assert direct.GetOutput().GetNumberOfPoints() == 0
direct.SetSpacing(4, 4, 4)
direct.Update()
assert direct.GetOutput().GetNumberOfPoints() == voxels

# every piece of a filled map comes from the fit of the whole
cast = lacuna.vtkLacunaBSplineIsoRayCaster()
cast.SetInputConnection(direct.GetOutputPort())
cast.SetViewDirection(-0.4, 0.2, -0.9)
cast.SetPixelSpacing(3)
ball = vtkSphere()
ball.SetCenter(28, -14, 63)
ball.SetRadius(39)
filler = lacuna.vtkLacunaRBFHoleFiller()
filler.SetInputConnection(cast.GetOutputPort())
filler.SetDefectRegion(ball)
filler.SetNodeSpacing(4)
filler.Update()
image = filler.GetOutput()
width, height, _ = image.GetDimensions()
fitted = vtk_to_numpy(image.GetPointData().GetArray("Fitted")).reshape(height, width).copy()
assert np.isfinite(fitted).any()
covered = 0
for piece in range(2):
    filler.UpdateInformation()
    filler.UpdatePiece(piece, 2, 0)
    x0, x1, y0, y1, _, _ = filler.GetOutput().GetExtent()
    part = vtk_to_numpy(filler.GetOutput().GetPointData().GetArray("Fitted")).reshape(y1 - y0 + 1, x1 - x0 + 1)
    assert np.array_equal(part, fitted[y0:y1 + 1, x0:x1 + 1], equal_nan=True)
    covered += part.size
assert covered >= fitted.size

# a writer whose input fails says so, and an older file does not pass for a new one
writer = lacuna.vtkLacunaIGESWriter()
writer.SetInputConnection(filler.GetOutputPort())
writer.SetFileName(output("recovery.igs"))
filler.UpdateWholeExtent()
assert writer.Write() == 1
written = os.path.getmtime(output("recovery.igs"))
cast.SetViewUp(0, 0, 0)
try:
    with raising():
        assert writer.Write() == 0
    raise AssertionError("no error")
except PipelineError:
    assert os.path.getmtime(output("recovery.igs")) == written
cast.SetViewUp(0, 1, 0)
assert writer.Write() == 1


def refused(algorithm, data, text):
    algorithm.SetInputData(data)
    try:
        with raising():
            algorithm.Update()
    except PipelineError as error:
        assert text in str(error), (text, str(error))
        return
    raise AssertionError(f"{algorithm.GetClassName()} takes input with a wrong array ({text})")


def short(data, name):
    """A copy of data whose point array has five tuples."""
    copy = vtkImageData()
    copy.DeepCopy(data)
    old = vtk_to_numpy(copy.GetPointData().GetArray(name))
    array = numpy_to_vtk(old[:5].copy(), deep=True)
    array.SetName(name)
    copy.GetPointData().AddArray(array)
    if name == data.GetPointData().GetScalars().GetName():
        copy.GetPointData().SetActiveScalars(name)
    return copy


cast.Update()
for array in ("Depth", "vtkValidPointMask", "Normals"):
    refused(lacuna.vtkLacunaRBFHoleFiller(), short(cast.GetOutput(), array), "5 values")
    refused(lacuna.vtkLacunaDepthMapSurface(), short(cast.GetOutput(), array), "5 values")
phantom = lacuna.vtkLacunaPhantomSweep()
phantom.SetImageSize(40, 30)
phantom.Update()
stack = phantom.GetOutput()
refused(lacuna.vtkLacunaSweptVolume(), short(stack, stack.GetPointData().GetScalars().GetName()), "5 values")
resampled = vtkImageData()
resampled.DeepCopy(stack)
resampled.SetSpacing(1, 1, 0.5)
refused(lacuna.vtkLacunaSweptVolume(), resampled, "resampled it along z")
flagged = vtkImageData()
flagged.DeepCopy(stack)
status = numpy_to_vtk(np.full(stack.GetDimensions()[2], 256.0), deep=True)
status.SetName("SliceStatus")
flagged.GetFieldData().AddArray(status)
refused(lacuna.vtkLacunaSweptVolume(), flagged, "flags are whole numbers")
