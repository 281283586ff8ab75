# SPDX-License-Identifier: BSD-3-Clause
"""Swept Volume through ParaView: defaults, arrays, state, and the real spine sweep."""
import os
import re
import sys
import xml.etree.ElementTree as ElementTree
import zlib

import numpy as np
from paraview.simple import *
from paraview import servermanager
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna import vtkLacunaSweptVolume


def tracked_slices(pixels, poses, status=None):
    """A stack (slice, row, column) with poses (n, 4, 4), as the data contract wants it."""
    n, height, width = pixels.shape
    stack = vtkImageData()
    stack.SetDimensions(width, height, n)
    grey = numpy_to_vtk(np.ascontiguousarray(pixels).ravel(), deep=1)
    grey.SetName("Grey")
    stack.GetPointData().SetScalars(grey)
    fields = {
        "ImageToReference": np.asarray(poses, float).reshape(n, 16),
        "Timestamp": 0.1 * np.arange(n),
        "SliceStatus": np.zeros(n, np.uint8) if status is None else np.array(status, np.uint8),
        "FrameNumber": np.arange(n, dtype=np.int32),
    }
    for name, values in fields.items():
        array = numpy_to_vtk(values, deep=1)
        array.SetName(name)
        stack.GetFieldData().AddArray(array)
    return stack


def open_slices(name, *arguments):
    """Tracked slices from a file, so that a state can find them again."""
    path = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], name + ".vti")
    writer = vtkXMLImageDataWriter()
    writer.SetDataModeToBinary()  # raw appended data is unreadable with recent libexpat
    writer.SetInputData(tracked_slices(*arguments))
    writer.SetFileName(path)
    writer.Write()
    return XMLImageDataReader(FileName=[path])


def array(proxy, name):
    """A point array as (z, y, x)."""
    data = servermanager.Fetch(proxy)
    shape = data.GetDimensions()[::-1]
    return vtk_to_numpy(data.GetPointData().GetArray(name)).reshape(shape)


def check_defaults():
    """The panel's defaults are the class's own."""
    source = open_slices("SweptVolumeFlat", np.zeros((2, 4, 4), np.uint8), [np.eye(4)] * 2)
    proxy = SweptVolume(Input=source)
    own = vtkLacunaSweptVolume()
    enumerations = {
        "PixelSampling": ["Footprint", "Bilinear", "Nearest"],
        "Interpolation": ["BetweenSlices", "NearestVoxel"],
        "Compounding": ["Mean", "Maximum"],
        "OutputScalarType": ["Input", "Float"],
    }
    for name in ("OutputSpacing", "OutputBounds", "PixelSampling", "Interpolation", "Compounding",
                 "MaximumSliceGap", "ClipRectangle", "OutputScalarType", "MemoryLimit"):
        default = getattr(own, "Get" + name)()
        if name in enumerations:
            default = enumerations[name][default]
            for text in enumerations[name]:
                setattr(proxy, name, text)
                assert getattr(proxy, name) == text
            setattr(proxy, name, default)
        value = proxy.GetProperty(name).GetData()
        value = tuple(value) if isinstance(default, tuple) else value
        assert value == default, (name, value, default)
    Delete(proxy)


def check_compounding():
    """Two sweeps, averaged; a slice marked invalid is left out; arrays, types, state."""
    def pose(z):
        matrix = np.diag([0.5, 0.5, 1, 1]).astype(float)
        matrix[2, 3] = z
        return matrix
    first = np.full((3, 9, 11), 10, np.uint8)
    first[1] = 200
    second = np.full((2, 9, 11), 40, np.uint8)
    proxy = SweptVolume(Input=[
        open_slices("SweptVolumeFirst", first, [pose(0), pose(1), pose(2)], [0, 2, 0]),
        open_slices("SweptVolumeSecond", second, [pose(0), pose(2)])])
    proxy.OutputSpacing = [0.5, 0.5, 0.5]
    proxy.UpdatePipeline()
    assert proxy.GetDataInformation().GetExtent() == (0, 10, 0, 8, 0, 4)
    assert proxy.GetDataInformation().GetBounds() == (0, 5, 0, 4, 0, 2)
    assert servermanager.Fetch(proxy).GetPointData().GetScalars().GetName() == "Intensity"
    assert array(proxy, "Intensity").dtype == np.uint8
    assert (array(proxy, "Intensity") == 25).all()
    assert (array(proxy, "Contributions") == 2).all()
    assert (array(proxy, "vtkValidPointMask") == 1).all()
    names = [proxy.FieldData[i].GetName() for i in range(proxy.FieldData.GetNumberOfArrays())]
    assert names == ["Provenance"], names
    proxy.Compounding = "Maximum"
    proxy.OutputScalarType = "Float"
    assert array(proxy, "Intensity").dtype == np.float32
    assert (array(proxy, "Intensity") == 40).all()

    state = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "SweptVolume.pvsm")
    SaveState(state)
    ResetSession()
    LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
    LoadState(state)
    loaded = FindSource("SweptVolume1")
    assert loaded.Compounding == "Maximum" and list(loaded.OutputSpacing) == [0.5] * 3
    assert (array(loaded, "Intensity") == 40).all()
    ResetSession()
    LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def read_spine():
    """The real sweep, by a small parser of its own: pixels and poses; None without the data."""
    folder = os.path.join(os.environ["LACUNA_TEST_DATA"], "ultrasound_spine")
    name = os.path.join(folder, "SpinePhantomFreehand.igs.mha")
    if not os.path.exists(name):
        return None
    with open(name, "rb") as file:
        raw = file.read()
    begin = raw.index(b"ElementDataFile = LOCAL\n") + 24
    header = raw[:begin].decode("latin1")
    size = [int(x) for x in re.search(r"DimSize = (.*)", header).group(1).split()]
    pixels = np.frombuffer(zlib.decompress(raw[begin:]), np.uint8).reshape(size[::-1])
    calibration = ElementTree.parse(os.path.join(
        folder, "PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml"))

    def matrix(text):
        return np.array([float(x) for x in text.split()]).reshape(4, 4)

    def transform(n, what):
        return matrix(re.search("Seq_Frame%04d_%sTransform = (.*)" % (n, what), header).group(1))
    image_to_probe = matrix(
        next(t.get("Matrix") for t in calibration.iter("Transform") if t.get("From") == "Image"))
    poses = [np.linalg.inv(transform(n, "ReferenceToTracker")) @ transform(n, "ProbeToTracker") @
             image_to_probe for n in range(size[2])]
    return pixels, poses


def check_spine():
    sweep = read_spine()
    if sweep is None:
        print("no spine sweep in", os.environ["LACUNA_TEST_DATA"])
        sys.exit(77)
    proxy = SweptVolume(Input=open_slices("SweptVolumeSpine", *sweep))
    proxy.OutputSpacing = [0.5, 0.5, 0.5]
    proxy.UpdatePipeline()
    data = servermanager.Fetch(proxy)
    assert data.GetDimensions() == (147, 106, 105), data.GetDimensions()
    np.testing.assert_allclose(data.GetOrigin(), (-74.5217, 165.573, 29.072), atol=5e-4)
    mask = array(proxy, "vtkValidPointMask")
    assert 0.5 < mask.mean() < 0.54, mask.mean()  # the sweep runs askew through its box
    grey = array(proxy, "Intensity")[mask == 1]
    assert abs(grey.mean() - sweep[0].mean()) < 3, (grey.mean(), sweep[0].mean())


check_defaults()
check_compounding()
check_spine()
print("ok")
