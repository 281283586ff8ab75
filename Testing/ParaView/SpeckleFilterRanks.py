# SPDX-License-Identifier: BSD-3-Clause
"""Speckle Filter and Contrast To Speckle under MPI: any number of ranks gives the same result together.

Run without arguments it is the test; it runs itself in pvbatch with the name of the volume and the
beginning of the names of what to write.
"""
import csv
import sys

import lacuna.plugin
import numpy as np
from lacuna_test import output, run_ranks
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter, vtkXMLPImageDataReader, vtkXMLPPolyDataReader

FILTERS = {
    "Median2D": dict(Operation="Median", KernelSize=[7, 6, 1]),
    "Median3D": dict(Operation="Median", KernelSize=[5, 5, 5]),
    "OpenClose": dict(Operation="OpenClose", KernelSize=[5, 4, 3], KernelShape="Ellipsoid"),
    "AdaptiveMedian": dict(Operation="AdaptiveMedian", KernelSize=[3, 3, 3], AdaptiveStrength=1),
    "Mean": dict(Operation="Mean", KernelSize=[5, 5, 5]),
    "Gaussian": dict(Operation="Gaussian", KernelSize=[3, 3, 3], StandardDeviation=1.5),
    "LaplacianOfGaussian": dict(Operation="LaplacianOfGaussian", KernelSize=[3, 3, 3], StandardDeviation=1.5),
}
ARRAYS = ("Grey", "Echo")  # bytes; float with NaN


def write_volume(name):
    """A ball in noise, its first sample not at 0, as bytes and as float with NaN."""
    nx, ny, nz = 47, 38, 29
    random = np.random.default_rng(2)
    z, y, x = np.mgrid[:nz, :ny, :nx]
    ball = (x - 25) ** 2 + (y - 17) ** 2 + (z - 13) ** 2 < 110
    grey = (60 + 90 * ball + 25 * random.standard_normal(ball.shape)).clip(0, 255).astype(np.uint8)
    echo = (grey / 7 + random.random(ball.shape)).astype(np.float32)
    echo[random.random(ball.shape) < 0.01] = np.nan
    volume = vtkImageData()
    volume.SetExtent(-5, nx - 6, 3, ny + 2, 0, nz - 1)
    volume.SetSpacing(0.5, 0.5, 0.75)
    for label, values in (("Grey", grey), ("Echo", echo), ("Ball", ball.astype(np.uint8))):
        array = numpy_to_vtk(values.ravel(), deep=1)
        array.SetName(label)
        volume.GetPointData().AddArray(array)
    volume.GetPointData().SetActiveScalars("Grey")
    writer = vtkXMLImageDataWriter()
    writer.SetDataModeToBinary()  # raw appended data is unreadable with recent libexpat
    writer.SetInputData(volume)
    writer.SetFileName(name)
    writer.Write()


def run(volume, prefix):
    """In pvbatch, on every rank."""
    lacuna.plugin.load()
    import paraview.simple as pv
    reader = pv.XMLImageDataReader(FileName=[volume])
    for label, properties in FILTERS.items():
        proxy = reader
        for array in ARRAYS:
            proxy = pv.SpeckleFilter(Input=proxy, ScalarArray=array, **properties)
        pv.SaveData(f"{prefix}{label}.pvti", proxy=proxy, DataMode="Binary")
        if label == "Median3D":
            # the contour asks for a layer of ghosts around each piece
            contour = pv.Contour(Input=proxy, ContourBy=["POINTS", "Grey"], Isosurfaces=[105.5])
            pv.SaveData(f"{prefix}Contour.pvtp", proxy=contour, DataMode="Binary")
        if label == "Median2D":
            contrast = pv.ContrastToSpeckle(Input=proxy, InsideArray="Ball", IsoValue=105)
            pv.SaveData(f"{prefix}Contrast.csv", proxy=contrast, Precision=17, UseScientificNotation=1)


def read_images(prefix):
    """(filter, array) -> values, put together from the ranks' pieces."""
    values = {}
    for label in FILTERS:
        reader = vtkXMLPImageDataReader()
        reader.SetFileName(f"{prefix}{label}.pvti")
        reader.Update()
        points = reader.GetOutput().GetPointData()
        for array in ARRAYS:
            values[label, array] = vtk_to_numpy(points.GetArray(array))
    return values


def triangles_of(name):
    """The corners of the triangles that are no ghosts, in an order of their own."""
    reader = vtkXMLPPolyDataReader()
    reader.SetFileName(name)
    reader.Update()
    mesh = reader.GetOutput()
    corners = vtk_to_numpy(mesh.GetPoints().GetData())[vtk_to_numpy(mesh.GetPolys().GetConnectivityArray())]
    triangles = corners.reshape(-1, 9)
    ghosts = mesh.GetCellData().GetArray("vtkGhostType")
    if ghosts:
        triangles = triangles[vtk_to_numpy(ghosts) == 0]
    return triangles[np.lexsort(triangles.T)]


def main():
    volume = output("SpeckleFilterRanks.vti")
    write_volume(volume)
    images, tables, surfaces = [], [], []
    for ranks in (1, 2, 3):
        prefix = output(f"SpeckleFilterRanks{ranks}")
        run_ranks(ranks, __file__, volume, prefix)
        for label in FILTERS:
            with open(f"{prefix}{label}.pvti") as file:
                assert file.read().count("<Piece") == ranks
        images.append(read_images(prefix))
        with open(f"{prefix}Contrast.csv") as file:
            tables.append(list(csv.DictReader(file)))  # the writer sorts the columns of several ranks
        surfaces.append(triangles_of(f"{prefix}Contour.pvtp"))
    for other in images[1:]:
        for key, values in images[0].items():
            assert values.dtype == other[key].dtype, key
            assert np.array_equal(values, other[key], equal_nan=values.dtype.kind == "f"), key
    assert np.isnan(images[0]["Median3D", "Echo"]).any() and images[0]["Median3D", "Grey"].std() > 20
    assert len(tables[0]) == 1 and len(tables[0][0]) == 11 and float(tables[0][0]["CSR"]) > 3, tables[0]
    assert tables[0] == tables[1] == tables[2], tables
    assert len(surfaces[0]) > 1000
    assert all(np.array_equal(surfaces[0], other) for other in surfaces[1:]), [len(s) for s in surfaces]
    print("ok:", tables[0][0])


if len(sys.argv) == 3:
    run(sys.argv[1], sys.argv[2])
else:
    main()
