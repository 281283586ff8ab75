# SPDX-License-Identifier: BSD-3-Clause
"""Volumes and images of 2048^3 points and far more: refused with the number of bytes, or made by pieces in little memory.

The address space is limited, so that what cannot be had is not had on any machine.
"""
import os
import resource
import sys

import lacuna
import numpy as np
from lacuna_test import SANITIZED, memory_of_process, output
from vtkmodules.numpy_interface import dataset_adapter as dsa
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkSphere, vtkTable
from vtkmodules.vtkImagingCore import vtkImageShiftScale, vtkRTAnalyticSource

GIBIBYTE = 1 << 30
N = 2048


def errors_of(filter, update=None):
    said = []
    for each in (filter, filter.GetExecutive()):
        each.AddObserver("ErrorEvent", lambda *_: said.append(""))
    texts = []

    def listen(_, __, text):
        texts.append(text)
    listen.CallDataType = "string0"
    filter.AddObserver("ErrorEvent", listen)
    (update or filter.Update)()
    return "\n".join(texts)


def check_refused(name, filter, *parts):
    parts = parts or ("bytes",)
    before = memory_of_process("VmHWM")
    text = errors_of(filter)
    print(f"{name}: {text.strip()[:220]}", flush=True)
    assert all(part in text for part in parts), (name, text)
    output = filter.GetOutputDataObject(0)
    assert not hasattr(output, "GetNumberOfPoints") or output.GetNumberOfPoints() == 0, name
    assert SANITIZED or memory_of_process("VmHWM") - before < GIBIBYTE / 4, name


def check_piece(name, filter, extent, points):
    before = memory_of_process("VmRSS")
    with open("/proc/self/clear_refs", "w", encoding="ascii") as file:
        file.write("5")
    texts = errors_of(filter, lambda: filter.UpdateExtent(extent))
    assert not texts, (name, texts)
    output = filter.GetOutput()
    used = memory_of_process("VmHWM") - before
    print(f"{name}: piece {extent} of {points} points, {used / 2**20:.0f} MiB", flush=True)
    assert output.GetNumberOfPoints() >= points, (name, output.GetExtent())
    assert SANITIZED or used < GIBIBYTE / 2, (name, used)


def wavelet(n=N):
    source = vtkRTAnalyticSource()
    source.SetWholeExtent(0, n - 1, 0, n - 1, 0, n - 1)
    return source


def points(length):
    data = vtkPolyData()
    places = vtkPoints()
    places.SetData(numpy_to_vtk(length * np.random.default_rng(2).random((30, 3)), deep=1))
    data.SetPoints(places)
    values = numpy_to_vtk(np.arange(30.0), deep=1)
    values.SetName("Value")
    data.GetPointData().SetScalars(values)
    return data


def behind(filter, source=None, port=0):
    source = source or wavelet()  # keeps its output port alive
    filter.SetInputConnection(port, source.GetOutputPort())
    return filter


def sources():
    for spacing in (0.05, 1e-3, 1e-4):
        skull = lacuna.vtkLacunaSkullPhantom()
        skull.SetSpacing(spacing, spacing, spacing)
        check_refused(f"Skull Phantom {spacing}", skull)
    skull = lacuna.vtkLacunaSkullPhantom()
    skull.SetSpacing(0.08, 0.08, 0.08)
    check_piece("Skull Phantom", skull, (500, 699, 500, 699, 1000, 1009), 400000)
    for slices, size in ((N, (N, N)), (2**31 - 1, (2**31 - 1, 2**31 - 1))):
        sweep = lacuna.vtkLacunaPhantomSweep()
        sweep.SetNumberOfSlices(slices)
        sweep.SetImageSize(*size)
        check_refused(f"Phantom Sweep {slices}", sweep)
    for n in (N, 2**31 - 1):
        shape = lacuna.vtkLacunaIncompleteShape()
        shape.SetShape(shape.Cube)
        shape.SetDimensions(n, n, n)
        check_refused(f"Incomplete Shape {n}", shape)


def freehand():
    sweep = lacuna.vtkLacunaPhantomSweep()
    sweep.SetNumberOfSlices(20)
    for spacing in (0.03, 1e-7, 1e-300):
        volume = behind(lacuna.vtkLacunaSweptVolume(), sweep)
        volume.SetOutputSpacing(spacing, spacing, spacing)
        check_refused(f"Swept Volume {spacing}", volume)
    volume = behind(lacuna.vtkLacunaSweptVolume(), sweep)
    volume.SetOutputSpacing(0.03, 0.03, 0.03)
    volume.SetMemoryLimit(0)
    volume.UpdateInformation()
    check_piece("Swept Volume", volume, (1000, 1099, 500, 599, 1000, 1009), 100000)
    for spacing in (1e-4, 1e-9):
        caster = behind(lacuna.vtkLacunaSliceRayCaster(), sweep)
        caster.SetIsoValue(100)
        caster.SetPixelSpacing(spacing)
        check_refused(f"Slice Ray Caster {spacing}", caster)


def whole_inputs():
    """Filters that need all of their input: nobody tries to load it."""
    angle = behind(lacuna.vtkLacunaOccludedAngle())
    check_refused("Occluded Angle", angle, "2048 x 2048 x 2048", "34359738368 bytes")
    check_refused("Mirror", behind(lacuna.vtkLacunaMirror()), "34359738368 bytes")
    check_refused("B-Spline Iso Ray Caster", behind(lacuna.vtkLacunaBSplineIsoRayCaster()), "34359738368 bytes")
    check_refused("Contrast To Speckle", behind(lacuna.vtkLacunaContrastToSpeckle()), "34359738368 bytes")
    warp = behind(lacuna.vtkLacunaRBFImageWarp())
    warp.SetInputData(1, points(100))
    warp.SetInputData(2, points(101))
    check_refused("RBF Image Warp", warp, "34359738368 bytes")
    check_refused("Swept Volume of a large stack", behind(lacuna.vtkLacunaSweptVolume()), "34359738368 bytes")
    surface = behind(lacuna.vtkLacunaOcclusionSurface())
    behind(surface, port=1)
    check_refused("Occlusion Surface", surface, "34359738368 bytes")
    for made in (lacuna.vtkLacunaRBFInterpolator(), lacuna.vtkLacunaRBFHoleFiller(), lacuna.vtkLacunaDepthMapSurface(), lacuna.vtkLacunaDepthMapShader(),
                 lacuna.vtkLacunaImplantPlate(), lacuna.vtkLacunaDefectModel(), lacuna.vtkLacunaPressOrientation(), lacuna.vtkLacunaSpeckleFilter()):
        check_refused(made.GetClassName(), behind(made), "34359738368 bytes")
    poses = vtkTable()
    for made in (lacuna.vtkLacunaAssembleTrackedSlices(), lacuna.vtkLacunaGateSlices(), lacuna.vtkLacunaSlicePlanes(), lacuna.vtkLacunaScanRegion(),
                 lacuna.vtkLacunaProbeCalibration(), lacuna.vtkLacunaTemporalCalibration(), lacuna.vtkLacunaTrackerSelfTest()):
        if made.GetNumberOfInputPorts() > 1:
            made.SetInputData(1, poses)
        check_refused(made.GetClassName(), behind(made), "34359738368 bytes")
    for made, ending in (lacuna.vtkLacunaIGESWriter(), "igs"), (lacuna.vtkLacunaTrackedSliceWriter(), "mha"):
        made.SetFileName(output("HugeRequests." + ending))
        text = errors_of(behind(made), made.Write)
        assert "34359738368 bytes" in text, (ending, text)
        assert not os.path.exists(output("HugeRequests." + ending))
    # nor what lies before the filter upstream, which has had no request yet and would make all of it
    for made in (lacuna.vtkLacunaOccludedAngle(), lacuna.vtkLacunaMirror(), lacuna.vtkLacunaBSplineIsoRayCaster(),
                 lacuna.vtkLacunaContrastToSpeckle(), lacuna.vtkLacunaSweptVolume()):
        check_refused(f"{made.GetClassName()} behind another filter", behind(made, behind(vtkImageShiftScale())), "34359738368 bytes")


def files():
    """A sweep that the limit allows and the memory does not, and the preview by default."""
    width, height, slices = 640, 480, 8000
    frames = "".join(f"Seq_Frame{k:04}_ImageToReferenceTransform = 1 0 0 0 0 1 0 0 0 0 1 {k} 0 0 0 1\nSeq_Frame{k:04}_ImageToReferenceTransformStatus = OK\n"
                     for k in range(slices))
    header = (f"ObjectType = Image\nNDims = 3\nDimSize = {width} {height} {slices}\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\n"
              f"UltrasoundImageOrientation = MF\n{frames}ElementDataFile = LOCAL\n").encode()
    path = output("HugeRequests.mha")
    with open(path, "wb") as file:
        file.write(header)
        file.truncate(len(header) + width * height * slices)  # sparse
    reader = lacuna.vtkLacunaTrackedSliceReader()
    reader.SetFileName(path)
    reader.SetMemoryLimit(4000)
    check_refused("Tracked Slice Reader", reader, f"{width * height * slices} bytes")
    reader.SetMemoryLimit(0)  # a share of all addresses that the process may have
    assert SANITIZED or not errors_of(reader) and 0 < reader.GetOutput().GetNumberOfPoints() < width * height * slices
    os.remove(path)


def depth_map(spacing, *direction):
    """A coarse skull, seen from the top or along a direction."""
    skull = lacuna.vtkLacunaSkullPhantom()
    skull.SetSpacing(4, 4, 4)
    caster = behind(lacuna.vtkLacunaBSplineIsoRayCaster(), skull)
    caster.SetIsoValue(0, 500)
    caster.SetPixelSpacing(spacing)
    caster.SetViewDirection(*(direction or (0, 0, -1)))
    return caster


def mesh():
    """The surface of a map takes several times the map."""
    caster = depth_map(0.1)
    caster.Update()
    limit = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (memory_of_process("VmSize") + GIBIBYTE // 8, limit[1]))
    surface = behind(lacuna.vtkLacunaDepthMapSurface(), caster)
    check_refused("Depth Map Surface", surface, "pixels would need")
    resource.setrlimit(resource.RLIMIT_AS, limit)
    surface.Modified()
    assert not errors_of(surface) and surface.GetOutput().GetNumberOfPoints() > 1e6


def filled():
    """A map with a filled hole, of 1 mm."""
    filler = behind(lacuna.vtkLacunaRBFHoleFiller(), depth_map(1, -0.5, 0.2, -0.8))
    sphere = vtkSphere()
    sphere.SetCenter(37, -15, 60)
    sphere.SetRadius(34)
    filler.SetDefectRegion(sphere)
    filler.SetNodeSpacing(3)
    filler.SetSmoothing(5)
    return filler


def fabrication():
    """Steps so small that there would be too many of them."""
    for spacing in (1e-3, 1e-9):
        filler = filled()
        filler.SetOutputSpacing(spacing, spacing, spacing)
        check_refused(f"RBF Hole Filler {spacing}", filler, "raise OutputSpacing", "bytes")
        plate = behind(lacuna.vtkLacunaImplantPlate(), filled())
        plate.SetTriangleSize(spacing)
        check_refused(f"Implant Plate {spacing}", plate, "make TriangleSize larger")
        press = behind(lacuna.vtkLacunaPressOrientation(), filled())
        press.SetOutputSpacing(spacing)
        check_refused(f"Press Orientation {spacing}", press, "nodes", "bytes", "make it larger")
        for step in ("StepOver", "PathStep"):
            path = behind(lacuna.vtkLacunaMillingToolPath(), behind(lacuna.vtkLacunaPressOrientation(), filled()))
            getattr(path, "Set" + step)(spacing)
            check_refused(f"Milling Tool Path {step} {spacing}", path, step, "mm")
    press = behind(lacuna.vtkLacunaPressOrientation(), filled())
    press.SetBlockSize(1e9, 1e9, 50)
    check_refused("Press Orientation of a block of 1e9 mm", press, "nodes", "bytes", "make it larger")


def pieces():
    for kernel in ((5, 5, 1), (5, 5, 5)):
        speckle = behind(lacuna.vtkLacunaSpeckleFilter())
        speckle.SetKernelSize(*kernel)
        check_piece(f"Speckle Filter {kernel}", speckle, (100, 227, 200, 327, 300, 307), 128 * 128 * 8)
    for spacing in (0.04, 1e-6):
        interpolator = lacuna.vtkLacunaRBFInterpolator()
        interpolator.SetInputData(points(100))
        interpolator.SetOutputSpacing(spacing, spacing, spacing)
        check_refused(f"RBF Interpolator {spacing}", interpolator)
    # an accuracy that takes fast sums over the whole grid, whose boxes take most
    interpolator = lacuna.vtkLacunaRBFInterpolator()
    interpolator.SetInputData(points(100))
    interpolator.SetOutputBounds(0, 100, 0, 100, 0, 100)
    interpolator.SetOutputSpacing(100 / (N - 1), 100 / (N - 1), 100 / (N - 1))
    interpolator.UpdateInformation()
    check_refused("RBF Interpolator", interpolator)
    text = errors_of(interpolator, lambda: interpolator.UpdateExtent((500, 519, 510, 529, 800, 809)))
    assert "the boxes of a grid of 8589934592 points" in text and "bytes" in text, text
    interpolator.SetOutputSpacing(200 / (N - 1), 200 / (N - 1), 200 / (N - 1))
    check_refused("RBF Interpolator", interpolator)
    check_piece("RBF Interpolator", interpolator, (500, 519, 510, 529, 800, 809), 4000)
    step = interpolator.GetOutput().GetSpacing()[0]
    low = [step * first for first in (500, 510, 800)]
    exact = lacuna.vtkLacunaRBFInterpolator()
    exact.SetInputData(points(100))
    exact.SetAccuracy(0)
    exact.SetOutputBounds(low[0], low[0] + 19 * step, low[1], low[1] + 19 * step, low[2], low[2] + 9 * step)
    exact.SetOutputSpacing(step, step, step)
    exact.Update()
    values, expected = (dsa.WrapDataObject(each.GetOutput()).PointData["Value"] for each in (interpolator, exact))
    assert len(values) == 4000 and np.abs(values - expected).max() < 2 * interpolator.GetAccuracy() * 29, np.abs(values - expected).max()
    for size in ((200000, 200000), (2**31 - 1, 2**31 - 1)):
        caster = behind(lacuna.vtkLacunaBSplineIsoRayCaster(), wavelet(64))
        caster.SetImageSize(*size)
        caster.SetIsoValue(0, 150)
        check_refused(f"B-Spline Iso Ray Caster {size}", caster)
    caster = behind(lacuna.vtkLacunaBSplineIsoRayCaster(), wavelet(64))
    caster.SetImageSize(16000, 16000)
    caster.SetIsoValue(0, 150)
    check_refused("B-Spline Iso Ray Caster", caster, "256000000 pixels, would need 5376000000 bytes")
    caster.Modified()
    check_piece("B-Spline Iso Ray Caster", caster, (1000, 1199, 2000, 2199, 0, 0), 40000)


if __name__ == "__main__":
    limit = memory_of_process("VmSize") + 2 * GIBIBYTE
    resource.setrlimit(resource.RLIMIT_AS, (limit, resource.RLIM_INFINITY))
    for part in (sources, freehand, whole_inputs, files, mesh, fabrication, pieces):
        if len(sys.argv) < 2 or part.__name__ in sys.argv[1:]:
            part()
