# SPDX-License-Identifier: BSD-3-Clause
"""The IGES Writer in ParaView: Save Data of depth maps, structured grids, lines, points and groups of them."""
import os

import numpy as np
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkObject, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkStructuredGrid

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
import lacuna

OUTPUT = os.environ["LACUNA_TEST_OUTPUT"]
os.makedirs(OUTPUT, exist_ok=True)


def producer(data):
    source = TrivialProducer()
    source.GetClientSideObject().SetOutput(data)
    source.UpdatePipeline()
    return source


def depth(i, j):
    """Asymmetric, mm; i and j are pixels."""
    return 0.002 * (i - 30) ** 2 + 0.003 * (j - 20) ** 2 + np.sin(0.1 * i + 0.05 * j) + 10


def depth_map(hole):
    """80 x 60 pixels of 0.5 x 0.75 mm seen along -y; Fitted on columns 10-59, rows 5-44."""
    i, j = np.meshgrid(np.arange(80.0), np.arange(60.0))
    fitted = np.where((i >= 10) & (i < 60) & (j >= 5) & (j < 45), depth(i, j), np.nan)
    measured = np.where(np.hypot(i - 30, j - 20) < 8, np.nan, depth(i, j))
    if hole:
        fitted[20, 30:33] = np.nan
    # right, down and view of a viewer in front of the patient who looks along -y
    right, down, view = np.array([1.0, 0, 0]), np.array([0, 0, 1.0]), np.array([0, -1.0, 0])
    origin = np.array([-20.0, 130.0, 40.0])
    world = np.eye(4)
    world[:3, 0], world[:3, 1], world[:3, 2], world[:3, 3] = right * 0.5, down * 0.75, view, origin
    image = vtkImageData()
    image.SetDimensions(80, 60, 1)
    image.SetOrigin(origin)
    image.SetSpacing(0.5, 0.75, 1)
    image.SetDirectionMatrix(*np.column_stack([right, down, view]).ravel())
    for name, values in (("Depth", measured), ("Fitted", fitted)):
        array = numpy_to_vtk(values.ravel(), deep=True)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    matrix = numpy_to_vtk(world.reshape(1, 16), deep=True)
    matrix.SetName("ImageToWorld")
    image.GetFieldData().AddArray(matrix)
    return image, world


def read_surface(path):
    """Knots and control points (v, u, xyz) of the 128 in a file."""
    with open(path, encoding="ascii") as file:
        lines = file.read().splitlines()
    assert all(len(line) == 80 for line in lines)
    assert "".join(line[:72] for line in lines if line[72] == "G").count("2HMM") == 1
    entry = [line for line in lines if line[72] == "D" and line[:8].strip() == "128"][0]
    number = int(entry[73:])
    data = "".join(
        line[:64].rstrip() for line in lines if line[72] == "P" and int(line[65:72]) == number)
    tokens = data.rstrip(";").split(",")
    k1, k2 = int(tokens[1]), int(tokens[2])
    numbers = np.array([float(t) for t in tokens[10:]])
    knots_u, knots_v = np.split(numbers[: k1 + k2 + 10], [k1 + 5])
    first = k1 + k2 + 10 + (k1 + 1) * (k2 + 1)
    points = numbers[first : first + 3 * (k1 + 1) * (k2 + 1)].reshape(k2 + 1, k1 + 1, 3)
    return knots_u, knots_v, points


def basis(knots, x):
    """All B-splines at x, by the recursive definition."""
    n = len(knots) - 1
    span = min(np.searchsorted(knots, x, side="right") - 1, n - 4)
    b = (np.arange(n) == span).astype(float)
    for q in range(1, 4):
        for i in range(n - q):
            left, right = knots[i + q] - knots[i], knots[i + q + 1] - knots[i + 1]
            b[i] = ((x - knots[i]) / left * b[i] if left > 0 else 0) + (
                (knots[i + q + 1] - x) / right * b[i + 1] if right > 0 else 0)
    return b[: n - 3]


def deviation(path, points):
    """Largest distance of samples (rows, columns, xyz) from the surface in a file."""
    knots_u, knots_v, control = read_surface(path)
    rows, columns = points.shape[:2]
    u = np.array([basis(knots_u, float(i)) for i in range(columns)])
    v = np.array([basis(knots_v, float(j)) for j in range(rows)])
    surface = np.einsum("jb,bac,ia->jic", v, control, u)
    return np.linalg.norm(surface - points, axis=2).max()


image, world = depth_map(hole=False)
i, j = np.meshgrid(np.arange(10.0, 60), np.arange(5.0, 45))
expected = np.stack([i, j, depth(i, j), np.ones_like(i)], axis=2) @ world.T
expected = expected[:, :, :3]
source = producer(image)

# The defaults of the proxy are those of the class.
path = os.path.join(OUTPUT, "IGESWriter.igs")
writer = CreateWriter(path, source)
assert writer.GetXMLLabel() == "IGES Writer", writer.GetXMLLabel()
for name in ("Tolerance", "DefectOutline", "Coordinates", "AllowMirrored", "SkipUnsupported"):
    default = getattr(lacuna.vtkLacunaIGESWriter(), "Get" + name)()
    assert writer.SMProxy.GetProperty(name).GetElement(0) == default, name

# File > Save Data, and what was achieved
writer.UpdatePipeline()
writer.UpdatePropertyInformation()
achieved = writer.GetPropertyValue("MaximumDeviation")
assert 0 < achieved <= 0.001, achieved
assert abs(deviation(path, expected) - achieved) < 1e-9
assert writer.GetPropertyValue("FileSize") == os.path.getsize(path)
size = list(writer.GetPropertyValue("NumberOfControlPoints"))
assert size == list(read_surface(path)[2].shape[1::-1]), size

for name, tolerance in (("exact.igs", 0), ("coarse.iges", 0.02)):
    path = os.path.join(OUTPUT, "IGESWriter-" + name)
    SaveData(path, source, Tolerance=tolerance)
    assert deviation(path, expected) <= max(tolerance, 1e-9)

# A structured grid
grid = vtkStructuredGrid()
grid.SetDimensions(50, 40, 1)
points = vtkPoints()
points.SetData(numpy_to_vtk(expected.reshape(-1, 3).copy(), deep=True))
grid.SetPoints(points)
path = os.path.join(OUTPUT, "IGESWriter-grid.igs")
SaveData(path, producer(grid))
assert deviation(path, expected) <= 0.001

# The class without ParaView's proxies
writer = lacuna.vtkLacunaIGESWriter()
writer.SetInputData(image)
path = os.path.join(OUTPUT, "IGESWriter-class.igs")
writer.SetFileName(path)
assert writer.Write() == 1
assert deviation(path, expected) <= 0.001 and writer.GetMaximumDeviation() <= 0.001

# The outline of the defect as the edge of the surface, and an asymmetric group: names, points, lines, screws
def entities(path):
    """Types of the entities that do not belong to others, and all the text."""
    with open(path, encoding="ascii") as file:
        lines = file.read().splitlines()
    first = [line for line in lines if line[72] == "D"][::2]
    return sorted(int(line[:8]) for line in first if line[64:72] == "00000000"), "".join(line[:72] for line in lines)


filled = vtkImageData()
filled.ShallowCopy(image)
i, j = np.meshgrid(np.arange(80.0), np.arange(60.0))
mask = numpy_to_vtk((np.hypot(i - 33, 1.5 * (j - 24)) < 15).astype(np.uint8).ravel(), deep=True)
mask.SetName("FilledMask")
filled.GetPointData().AddArray(mask)
implant = producer(filled)
path = os.path.join(OUTPUT, "IGESWriter-trim.igs")
SaveData(path, implant, DefectOutline="Trim")
types, text = entities(path)
assert types.count(144) == 1 and 128 not in types and 126 not in types, types
SaveData(path, implant, DefectOutline="None")
assert entities(path)[0].count(128) == 1 and 126 not in entities(path)[0]
grouped = GroupDatasets(Input=[implant, Line(Point1=[0, 0, 0], Point2=[1, 2, 3], Resolution=1), Ellipse(),
                               PointSource(NumberOfPoints=3, Radius=0)])
SaveData(path, grouped)
types, text = entities(path)
assert [types.count(t) for t in (128, 126, 110, 102, 116)] == [1, 1, 1, 1, 3], types
writer = CreateWriter(path, grouped)
writer.UpdatePipeline()
writer.UpdatePropertyInformation()
assert [writer.GetPropertyValue(f"NumberOf{n}") for n in ("Surfaces", "Curves", "Points")] == [1, 3, 3]

# A map with a hole, triangles, a mirror image: no file.
vtkObject.GlobalWarningDisplayOff()
path = os.path.join(OUTPUT, "IGESWriter-refused.igs")
mirrored = vtkImageData()
mirrored.ShallowCopy(image)
mark = numpy_to_vtk(np.array([1]), deep=True)
mark.SetName("Mirrored")
mirrored.GetFieldData().AddArray(mark)
for refused in (producer(depth_map(hole=True)[0]), Sphere(), producer(mirrored)):
    if os.path.exists(path):
        os.remove(path)
    SaveData(path, refused)
    assert not os.path.exists(path), refused
SaveData(path, producer(mirrored), AllowMirrored=1)
assert os.path.exists(path)
SaveData(path.replace("refused", "group"), GroupDatasets(Input=[implant, Sphere()]), SkipUnsupported=1)
assert entities(path.replace("refused", "group"))[0].count(128) == 1
print("ok")
