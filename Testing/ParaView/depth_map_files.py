# SPDX-License-Identifier: BSD-3-Clause
"""Depth maps from numpy arrays, for tests that need one with known values."""
import numpy as np
from lacuna_test import output
from paraview import servermanager
from paraview.simple import XMLImageDataReader
from vtkmodules.numpy_interface import dataset_adapter as dsa
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter


def write_map(name, depth, spacing, origin, right, down):
    """A depth map (rows x columns, NaN where there is none) as a file; returns a reader of it.

    spacing: mm, one number or those along right and down.
    """
    view = np.cross(right, down)
    spacing = np.broadcast_to(spacing, 2)
    image = vtkImageData()
    image.SetDimensions(depth.shape[1], depth.shape[0], 1)
    image.SetOrigin(*origin)
    image.SetSpacing(*spacing, 1)
    direction = np.column_stack([right, down, view])
    image.SetDirectionMatrix(*direction.ravel())
    to_world = np.eye(4)
    to_world[:3, 0] = spacing[0] * np.asarray(right)
    to_world[:3, 1] = spacing[1] * np.asarray(down)
    to_world[:3, 2] = view
    to_world[:3, 3] = origin
    arrays = [("Depth", depth.ravel().astype(float)),
              ("vtkValidPointMask", np.isfinite(depth).ravel().astype(np.int8)),
              ("Normals", np.tile(-view, (depth.size, 1)).astype(np.float32))]
    for array_name, values in arrays:
        array = numpy_to_vtk(values, deep=1)
        array.SetName(array_name)
        image.GetPointData().AddArray(array)
    image.GetPointData().SetActiveScalars("Depth")
    matrix = numpy_to_vtk(to_world.reshape(1, 16), deep=1)
    matrix.SetName("ImageToWorld")
    image.GetFieldData().AddArray(matrix)
    path = output(name + ".vti")
    writer = vtkXMLImageDataWriter()
    writer.SetDataModeToBinary()  # raw appended data is unreadable with recent libexpat
    writer.SetFileName(path)
    writer.SetInputData(image)
    assert writer.Write() == 1
    return XMLImageDataReader(FileName=[path])


def fetch(proxy):
    """Arrays of the output as rows x columns, and its field data."""
    proxy.UpdatePipeline()
    data = servermanager.Fetch(proxy)
    columns, rows, _ = data.GetDimensions()
    wrapped = dsa.WrapDataObject(data)
    names = wrapped.PointData.keys()
    points = {n: np.asarray(wrapped.PointData[n]).reshape(rows, columns, -1).squeeze(-1)
              for n in names if n != "Normals"}
    fields = {n: np.asarray(wrapped.FieldData[n]).ravel()
              for n in wrapped.FieldData.keys() if n != "Provenance"}
    return points, fields


def spread(mask, radius):
    """Pixels whose centres are at most so many pixels from one of mask."""
    grown = mask.copy()
    for i in range(-radius, radius + 1):
        for j in range(-radius, radius + 1):
            if i * i + j * j <= radius * radius:
                grown |= np.roll(mask, (j, i), (0, 1))
    return grown


def find_unsound(depth, spacing):
    """What the saw and the drill left: depth steps over 63 degrees, holes, 3 pixels around them."""
    unsound = ~np.isfinite(depth)
    filled = np.where(unsound, 1e9, depth)
    for axis in (0, 1):
        step = np.abs(np.diff(filled, axis=axis)) > 2 * spacing
        before, after = [(0, 1), (0, 0)], [(1, 0), (0, 0)]
        if axis:
            before, after = before[::-1], after[::-1]
        unsound |= np.pad(step, before) | np.pad(step, after)
    return spread(unsound, 3)
