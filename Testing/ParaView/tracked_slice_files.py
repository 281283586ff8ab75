# SPDX-License-Identifier: BSD-3-Clause
"""Tracked slices as files, for tests of what is made of them."""
import numpy as np
from paraview import servermanager
from paraview.simple import XMLImageDataReader
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

from lacuna_test import output


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
    path = output(name + ".vti")
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
