# SPDX-License-Identifier: BSD-3-Clause
"""RBF Hole Filler as a script sees it: properties, defaults, regions, and (with "real" as argument)
the hole of 30 mm radius cut into the CT head, filled and compared with the removed surface."""
import os
import sys
import zlib

import numpy as np
from paraview import servermanager
from paraview.simple import LoadPlugin, XMLImageDataReader
from vtkmodules.numpy_interface import dataset_adapter as dsa
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def write_map(name, depth, spacing, origin, right, down):
    """A depth map (rows x columns, NaN where there is none) as a file; returns a reader of it."""
    view = np.cross(right, down)
    image = vtkImageData()
    image.SetDimensions(depth.shape[1], depth.shape[0], 1)
    image.SetOrigin(*origin)
    image.SetSpacing(spacing, spacing, 1)
    direction = np.column_stack([right, down, view])
    image.SetDirectionMatrix(*direction.ravel())
    to_world = np.eye(4)
    to_world[:3, 0] = spacing * np.asarray(right)
    to_world[:3, 1] = spacing * np.asarray(down)
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
    path = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], name + ".vti")
    os.makedirs(os.path.dirname(path), exist_ok=True)
    writer = vtkXMLImageDataWriter()
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


def test_properties():
    import lacuna
    surface = lambda x, y: 40 + 0.2 * x - 0.1 * y + 0.002 * (x - 20) ** 2
    x, y = np.meshgrid(np.arange(70.0), np.arange(50.0))
    depth = surface(x, y)
    depth[20:30, 35:50] = np.nan
    source = write_map("RBFHoleFiller", depth, 1.0, (3, 4, 5), (1, 0, 0), (0, -1, 0))
    filler = RBFHoleFiller(Input=source)

    direct = lacuna.vtkLacunaRBFHoleFiller()
    for name in ("SupportMargin", "NodeSpacing", "Smoothing", "OutputMargin"):
        assert filler.GetPropertyValue(name) == getattr(direct, "Get" + name)(), name
    assert filler.Kernel == "ThinPlate" and direct.GetKernel() == direct.ThinPlate
    assert direct.GetDefectRegion() is None
    assert not filler.DefectRegion
    for name in ("DefectArray", "SupportArray"):
        assert filler.GetPropertyValue(name) in ("", "None", None), name
        assert getattr(direct, "Get" + name)() == ""

    points, fields = fetch(filler)  # the interior hole, by default
    filled = points["FilledMask"] == 1
    assert (filled == np.isnan(depth)).all()
    assert np.abs(points["Depth"] - surface(x, y))[filled].max() < 0.05
    assert (points["Depth"] == depth)[~filled].all()
    assert fields["NodeCount"][0] > 500
    assert "ImageToWorld" in fields

    for region in ("Sphere", "Box", "Cylinder", "Plane", "None"):
        filler.DefectRegion = region
    filler.DefectRegion = "Sphere"
    filler.DefectRegion.Center = [3 + 25, 4 - 20, 5 - surface(25, 20)]
    filler.DefectRegion.Radius = 6
    filled = fetch(filler)[0]["FilledMask"] == 1
    inside = np.hypot(x - 25, y - 20)
    assert filled[inside < 5].all() and not filled[inside > 6.01].any()

    filler.DefectRegion = "None"
    filler.DefectArray = "vtkValidPointMask"  # marks all but the hole: nothing is left to fit
    filler.SupportArray = "vtkValidPointMask"
    filler.DefectArray = "None"
    filled = fetch(filler)[0]["FilledMask"] == 1
    assert (filled == np.isnan(depth)).all()
    for kernel in ("Linear", "Cubic", "ThinPlate"):
        filler.Kernel = kernel
        assert np.isfinite(fetch(filler)[0]["Depth"]).all()


def head_map(path, iso_value):
    """Depths at which rays from the top, one per column of voxels, first reach the iso-value."""
    with open(path, "rb") as file:
        raw = file.read()
    header, marker = raw, b"ElementDataFile = LOCAL\n"
    start = header.index(marker) + len(marker)
    voxels = np.frombuffer(zlib.decompress(raw[start:]), "<i2").reshape(140, 244, 180)
    column = voxels[::-1, ::-1, :].astype(float)  # from the top; rows from +y to -y
    above = column >= iso_value
    k = above.argmax(axis=0)
    depth = np.full(k.shape, np.nan)
    rows, columns = np.nonzero(above.any(axis=0) & (k > 0))
    k = k[rows, columns]
    before, after = column[k - 1, rows, columns], column[k, rows, columns]
    depth[rows, columns] = (k - 1) + (iso_value - before) / (after - before)
    return depth


def test_head():
    path = os.path.join(os.environ["LACUNA_TEST_DATA"], "ct_head", "head.mha")
    if not os.path.exists(path):
        print("skipped: no", path)
        sys.exit(77)
    spacing = 0.90234375
    depth = head_map(path, 500)
    source = write_map("RBFHoleFillerHead", depth, spacing, (0, 243 * spacing, 139),
                       (1, 0, 0), (0, -1, 0))
    filler = RBFHoleFiller(Input=source)
    filler.DefectRegion = "Cylinder"
    filler.DefectRegion.Center = [90.2, 97.5, 100]
    filler.DefectRegion.Axis = [0, 0, 1]
    filler.DefectRegion.Radius = 30
    figures = {}
    for kernel in ("Linear", "ThinPlate"):
        filler.Kernel = kernel
        points, fields = fetch(filler)
        filled = points["FilledMask"] == 1
        x, y = np.meshgrid(np.arange(180) * spacing, (243 - np.arange(244)) * spacing)
        assert (filled == (np.hypot(x - 90.2, y - 97.5) <= 30)).all()
        error = (points["Depth"] - depth)[filled]
        assert np.array_equal(error, points["Deviation"][filled])
        figures[kernel] = np.abs(error).max(), np.sqrt((error ** 2).mean())
        print("%s: %d nodes, max %.3f mm, RMS %.3f mm, condition %.2g, residual %.2g mm"
              % (kernel, fields["NodeCount"][0], *figures[kernel],
                 fields["ConditionEstimate"][0], fields["Residual"][0]))
    # A plain thin plate fit reaches 0.94 and 0.32.
    assert figures["ThinPlate"][0] <= 1.0
    assert figures["ThinPlate"][1] <= 0.35
    assert figures["Linear"][0] > figures["ThinPlate"][0]
    # The disc of 30 mm, inclined and domed, is larger than in projection.
    assert 2900 < fields["DefectArea"][0] < 3300
    assert np.isclose(np.linalg.norm(fields["PlaneNormal"]), 1) and fields["PlaneNormal"][2] < 0


if sys.argv[1:] == ["real"]:
    test_head()
else:
    test_properties()
