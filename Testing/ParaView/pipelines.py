# SPDX-License-Identifier: BSD-3-Clause
"""Compares what pipelines made: all that is in the pipeline browser, value by value."""
import numpy as np
from lacuna.data import fetch
from paraview import servermanager
from paraview.simple import GetSources
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkCellArray

NOT_COMPARED = ("FitTime",)  # measured


def sort_polygons(data):
    """VTK 9.6 finds the polygons of Extract Surface by several threads, in an order that changes from run to run."""
    starts, corners = (vtk_to_numpy(array) for array in (data.GetPolys().GetOffsetsArray(), data.GetPolys().GetConnectivityArray()))
    polygons = vtkCellArray()
    for polygon in sorted(each.tolist() for each in np.split(corners, starts[1:-1])):
        polygons.InsertNextCell(len(polygon), polygon)
    data.SetPolys(polygons)


def outputs():
    """(name, port): a copy of the data, of each source and filter that is registered."""
    found = {}
    for (name, _), source in GetSources().items():
        source.UpdatePipeline()
        for port in range(source.SMProxy.GetNumberOfOutputPorts()):
            data = fetch(servermanager.OutputPort(source, port))
            if data is not None:
                copy = data.NewInstance()
                copy.DeepCopy(data)
                if source.SMProxy.GetXMLName() == "DataSetSurfaceFilter" and copy.IsA("vtkPolyData") and not copy.GetCellData().GetNumberOfArrays():
                    sort_polygons(copy)
                found[name, port] = copy
    return found


def values(data):
    """Every array of a data set or table by name: points, cells and topology included."""
    found = {}
    if data.IsA("vtkPointSet") and data.GetPoints():
        found["points"] = vtk_to_numpy(data.GetPoints().GetData())
    if data.IsA("vtkImageData"):
        found["geometry"] = np.array([*data.GetExtent(), *data.GetOrigin(), *data.GetSpacing(), *data.GetDirectionMatrix().GetData()])
    if data.IsA("vtkDataSet"):
        found["counts"] = np.array([data.GetNumberOfPoints(), data.GetNumberOfCells()])
    if data.IsA("vtkPolyData"):
        for kind in ("Verts", "Lines", "Polys", "Strips"):
            cells = getattr(data, "Get" + kind)()
            found[kind] = vtk_to_numpy(cells.GetConnectivityArray())
            found[kind + " offsets"] = vtk_to_numpy(cells.GetOffsetsArray())
    if data.IsA("vtkStructuredGrid"):
        found["extent"] = np.array(data.GetExtent())
    for kind in ("PointData", "CellData", "RowData", "FieldData"):
        getter = getattr(data, "Get" + kind, None)
        arrays = getter() if getter else None
        for index in range(arrays.GetNumberOfArrays() if arrays else 0):
            array = arrays.GetAbstractArray(index)
            if array.GetName() in NOT_COMPARED:
                continue
            if array.IsA("vtkDataArray"):
                found[kind, array.GetName()] = vtk_to_numpy(array)
            else:
                found[kind, array.GetName()] = np.array([str(array.GetVariantValue(i)) for i in range(array.GetNumberOfValues())])
    return found


def differences(before, after):
    """What differs between two data objects, as texts."""
    if before.GetClassName() != after.GetClassName():
        return [f"{before.GetClassName()} became {after.GetClassName()}"]
    old, new = values(before), values(after)
    texts = [f"{name} is there once" for name in sorted(set(old) ^ set(new), key=str)]
    for name in set(old) & set(new):
        a, b = old[name], new[name]
        if a.shape != b.shape or not np.array_equal(a, b, equal_nan=a.dtype.kind == "f"):
            texts.append(f"{name} differs: {a.ravel()[:4]} became {b.ravel()[:4]}")
    return texts


def check_same(before, after, what):
    """Each output of one session is there in the other, with the same values bit for bit."""
    assert set(before) == set(after), (what, sorted(set(before) ^ set(after)))
    found = {key: texts for key in before if (texts := differences(before[key], after[key]))}
    assert not found, (what, found)
