# SPDX-License-Identifier: BSD-3-Clause
"""The command lacuna.implant closes the same hole on the same side of the head however the CT is stored: as a DICOM series, left-handed in
RAS, turned by its direction matrix, in values that are not Hounsfield units. The report's pictures and letters agree.
"""
import os
import shutil

import lacuna.plugin

lacuna.plugin.load()
import numpy as np
from ct_series_files import write_series
from lacuna import implant
from lacuna.data import fetch
from lacuna_test import output
from letter_block import rotation
from paraview.simple import Delete, GetSources, SkullPhantom, XMLPolyDataReader
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import reference
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator
from vtkmodules.vtkIOImage import vtkPNGReader

LARGE, SMALL = np.array([0.9, -0.2, 0.4]), np.array([-0.5, 0.5, 0.7])  # directions of the holes: left, and right behind
SMALL_ANGLE = 0.25  # radians from its middle to its edge
TISSUE = 40  # Hounsfield units

home = os.path.abspath(output("ImplantInputs"))
shutil.rmtree(home, ignore_errors=True)
os.makedirs(home)
said, errors = [], []
implant._say = lambda text: (said.append(text), print(text, flush=True))
implant.print = lambda *texts, **_: errors.append(" ".join(map(str, texts)))


def path(name):
    return os.path.join(home, name)


def run(*arguments):
    """The command: its exit code, and what it said."""
    said.clear()
    errors.clear()
    try:
        code = implant.main([str(each) for each in arguments])
    except SystemExit as end:
        code = end.code
    for proxy in list(GetSources().values()):
        Delete(proxy)
    return code, "\n".join(said + errors)


def chosen(text):
    """The line of the hole that the implant closes."""
    return text.split("  <- the implant closes this one")[0].splitlines()[-1]


def write_meta(name, values, matrix, kind="SHORT"):
    """values: by k, j, i. matrix: index -> LPS, which may be left-handed."""
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    header = ["ObjectType = Image", "NDims = 3", "DimSize = {} {} {}".format(*values.shape[::-1]),
              "TransformMatrix = " + " ".join(repr(float(x)) for x in (matrix[:3, :3] / spacing).T.ravel()),
              "Offset = " + " ".join(repr(float(x)) for x in matrix[:3, 3]),
              "ElementSpacing = " + " ".join(repr(float(x)) for x in spacing), f"ElementType = MET_{kind}", "ElementDataFile = LOCAL"]
    with open(name, "wb") as file:
        file.write(("\n".join(header) + "\n").encode() + values.tobytes())


def write_nrrd(name, values, matrix):
    """The same in RAS, as unsigned numbers."""
    signs = np.array([-1, -1, 1])
    header = ["NRRD0004", "type: uint16", "dimension: 3", "space: right-anterior-superior", "sizes: {} {} {}".format(*values.shape[::-1]),
              "space directions: " + " ".join("({},{},{})".format(*map(float, signs * matrix[:3, axis])) for axis in range(3)),
              "kinds: domain domain domain", "endian: little", "encoding: raw",
              "space origin: ({},{},{})".format(*map(float, signs * matrix[:3, 3]))]
    with open(name, "wb") as file:
        file.write(("\n".join(header) + "\n\n").encode() + values.astype("<u2").tobytes())


def read(name):
    return fetch(XMLPolyDataReader(FileName=[path(name)]))


def distances(points, surface):
    """RMS and largest distance of points from a surface, mm."""
    tree = vtkStaticCellLocator()
    tree.SetDataSet(surface)
    tree.BuildLocator()
    nearest, cell, sub, square = [0.0] * 3, reference(0), reference(0), reference(0.0)
    squares = []
    for point in points:
        tree.FindClosestPoint(point, nearest, cell, sub, square)
        squares.append(square.get())
    return np.sqrt(np.mean(squares)), np.sqrt(np.max(squares))


# The head: the phantom's hole on the left, and another one, smaller, on the right
phantom = SkullPhantom(Spacing=[2, 2, 2], DefectDirection=list(LARGE), DefectRadius=30)
image = fetch(phantom)
size = image.GetDimensions()
values = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(size[::-1]).astype("<i2")
straight = np.diag([*image.GetSpacing(), 1.0])
straight[:3, 3] = image.GetPoint(0)
k, j, i = np.indices(values.shape)
ray = np.stack([i, j, k], -1) * image.GetSpacing() + straight[:3, 3] - phantom.Center
angle = np.arccos(np.clip(ray @ SMALL / np.linalg.norm(SMALL) / np.maximum(np.linalg.norm(ray, axis=-1), 1e-9), -1, 1))
values = np.where(angle < SMALL_ANGLE, np.minimum(values, TISSUE), values)
middles = {name: np.array(phantom.Center) + 75 * way / np.linalg.norm(way) for name, way in (("large", LARGE), ("small", SMALL))}

# Straight; a DICOM series of the same slices gives the same
write_meta(path("straight.mha"), values, straight)
code, text = run(path("straight.mha"), "--output", path("straight.vtp"), "--hole", *middles["small"])
assert code == 0 and "2 holes found" in text and chosen(text).endswith("mm"), text  # MetaImage does not say whose coordinates it has
area = 2 * np.pi * (1 - np.cos(SMALL_ANGLE)) * phantom.GetClientSideObject().IntersectOuterSurface(phantom.Center, SMALL / np.linalg.norm(SMALL)) ** 2
assert abs(float(chosen(text).split()[2]) - area / 100) < 0.8, (area, text)  # cm²
os.makedirs(path("series"))
write_series(path("series"), values, straight)
code, text = run(path("series"), "--output", path("series.vtp"), "--hole", *middles["small"])
assert code == 0 and "right" in chosen(text), text
first, same = read("straight.vtp"), read("series.vtp")
points = vtk_to_numpy(first.GetPoints().GetData())
assert np.linalg.norm(points.mean(axis=0) - middles["small"]) < 15, points.mean(axis=0)
assert points.shape[0] > 1000 and np.abs(points - vtk_to_numpy(same.GetPoints().GetData())).max() < 1e-3

# The head turned in the scanner: a point of the patient's coordinates chooses, and the implant is turned with it
turn = np.eye(4)
turn[:3, :3], turn[:3, 3] = rotation([1, -0.4, 0.3], 0.5), [30, -200, 700]
write_meta(path("turned.mha"), values, turn @ straight)
place = (turn @ [*middles["small"], 1])[:3]
code, text = run(path("turned.mha"), "--output", path("turned.vtp"), "--hole", *place)
assert code == 0, text
rms, largest = distances(points @ turn[:3, :3].T + turn[:3, 3], read("turned.vtp"))
print(f"turned: {rms:.4f} mm RMS, largest {largest:.4f}", flush=True)
assert rms < 0.02 and largest < 0.05, (rms, largest)

# Stored left-handed, in another order, in RAS and from 0 on: the level has to be given, and the largest hole is on the left
flipped = straight.copy()
flipped[:3, 3] += (size[0] - 1) * flipped[:3, 0]
flipped[:3, 0] *= -1
stored = np.flip(values, 2).transpose(2, 0, 1) + 1024  # columns are now along y, rows along z, slices along -x
flipped = flipped[:, [1, 2, 0, 3]]
assert np.linalg.det(flipped[:3, :3]) < 0 and stored.min() >= 0
write_nrrd(path("left-handed.nrrd"), stored, flipped)
code, text = run(path("left-handed.nrrd"), "--output", path("none.stl"), "--report", path("report"))
assert code == 1 and "these are no Hounsfield units" in text and "--level" in text, text
assert not os.path.exists(path("none.stl"))
# /proc/self is a folder into which not even root can write
code, text = run(path("straight.mha"), "--output", "/proc/self/none.stl")
assert code == 1 and "nothing can be written into /proc/self" in text and "designing" not in text, text
for report in ("/proc/self", "/proc/self/report"):
    code, text = run(path("straight.mha"), "--output", path("none.stl"), "--report", report)
    assert code == 1 and f"nothing can be written into {report}" in text and "designing" not in text, text
assert not os.path.exists(path("none.stl"))
code, text = run(path("left-handed.nrrd"), "--output", path("left.vtp"), "--level", 1324, "--report", path("report"))
assert code == 0 and "left" in chosen(text), text
points = vtk_to_numpy(read("left.vtp").GetPoints().GetData())
assert np.linalg.norm(points.mean(axis=0) - middles["large"]) < 15, points.mean(axis=0)


def picture(name):
    """Colours of the report's picture, rows from the bottom."""
    reader = vtkPNGReader()
    reader.SetFileName(path(f"report/{name}.png"))
    reader.Update()
    shape = reader.GetOutput().GetDimensions()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(shape[1], shape[0], -1)[..., :3].astype(int)


def is_l(name, side):
    """Whether the letter at the left or right edge of a picture is an L and no R: nothing is dark at its upper right."""
    pixels = picture(name)
    dark = pixels.max(axis=2) < 110
    height, width = dark.shape
    dark = dark[int(0.45 * height):int(0.55 * height), slice(0, 40) if side == "left" else slice(width - 40, width)]
    rows, columns = np.flatnonzero(dark.any(axis=1)), np.flatnonzero(dark.any(axis=0))
    assert 8 < len(rows) < 30 and 5 < len(columns) < 30, (name, side, len(rows), len(columns))
    letter = dark[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1]
    return not letter[letter.shape[0] // 2 + 1:, letter.shape[1] // 2 + 1:].any()


def blue(name):
    """Where the implant is seen: number of pixels in the left and right half."""
    pixels = picture(name)
    seen = pixels[..., 2] > pixels[..., 0] + 40
    return seen[:, :seen.shape[1] // 2].sum(), seen[:, seen.shape[1] // 2:].sum()


assert is_l("front", "right") and not is_l("front", "left") and is_l("back", "left") and not is_l("back", "right")
assert blue("front")[1] > 300 > 30 > blue("front")[0], blue("front")  # as one looks at a face
assert blue("back")[0] > 30 > blue("back")[1], blue("back")  # its rear edge
assert sum(blue("left")) > 5000 and sum(blue("right")) < 500, (blue("left"), blue("right"))
with open(path("report/index.html"), encoding="utf-8") as file:
    page = file.read()
assert "left" in page and "does not say how the patient lay" not in page
