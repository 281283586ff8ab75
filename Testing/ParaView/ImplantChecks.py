# SPDX-License-Identifier: BSD-3-Clause
"""The checks at the end of the way from a CT to an implant: no false alarm, and files that are wrong are named so."""
import importlib.util
import os
import sys

import numpy as np
from lacuna.errors import PipelineError
from lacuna_test import output
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData

path = os.path.join(os.path.dirname(os.path.abspath(__file__)),
                    "../../Documentation/Examples/11-implant-to-mould/implant_to_mould.py")
spec = importlib.util.spec_from_file_location("walk", path)
walk = importlib.util.module_from_spec(spec)
spec.loader.exec_module(walk)


def make_map(depth, extent, image_to_world):
    image = vtkImageData()
    image.SetExtent(*extent)
    array = numpy_to_vtk(depth.ravel(), deep=True)
    array.SetName("Fitted")
    image.GetPointData().AddArray(array)
    matrix = numpy_to_vtk(image_to_world.reshape(1, 16), deep=True)
    matrix.SetName("ImageToWorld")
    image.GetFieldData().AddArray(matrix)
    return image


# A ball of 12 mm radius in pixels of 1 x 0.8 mm, with a part that is not known, turned and moved in space.
RADIUS, SPACING, FIRST = 12.0, np.array([1.0, 0.8]), np.array([5, 7])
rows, columns = np.indices((25, 19))
x, y = SPACING[0] * (columns - 9), SPACING[1] * (rows - 12)
depth = RADIUS - np.sqrt(RADIUS ** 2 - np.minimum(x ** 2 + y ** 2, 100))
depth[x ** 2 + y ** 2 > 80] = np.nan
turn = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], dtype=float)
matrix = np.eye(4)
matrix[:3, :3] = turn @ np.diag([*SPACING, 1])
matrix[:3, 3] = [3, -40, 20]
image = make_map(depth, (FIRST[0], FIRST[0] + 18, FIRST[1], FIRST[1] + 24, 0, 0), matrix)
center = matrix[:3, :3] @ [FIRST[0] + 9, FIRST[1] + 12, RADIUS] + matrix[:3, 3]
fine = walk.fine_depths(image)
assert fine.shape == (walk.FINER * 24 + 1, walk.FINER * 18 + 1)
assert np.array_equal(fine[::walk.FINER, ::walk.FINER], depth, equal_nan=True)
surface = walk.fitted_surface(image)
assert surface.GetNumberOfCells() > 2 * walk.FINER ** 2 * 200

# Points of the ball between the pixels, and others 0.7 mm within: flat triangles of the pixels are 0.014 mm off.
direction = np.random.default_rng(5).normal(size=(2000, 3))
direction /= np.linalg.norm(direction, axis=1)[:, None]
direction = direction[direction @ turn[:, 2] < -0.85]
assert len(direction) > 100
assert walk.distances(center + RADIUS * direction, surface).max() < 0.002
assert abs(walk.distances(center + (RADIUS - 0.7) * direction, surface) - 0.7).max() < 0.002
behind = walk.depths_behind(image, center + RADIUS * direction + 0.25 * turn[:, 2])
assert abs(behind - 0.25).max() < 0.002, (behind.min(), behind.max())
# A hole that was marked too narrowly: beside what is filled there is nothing, or what is seen through it.
def add(name, values):
    array = numpy_to_vtk(values.ravel(), deep=True)
    array.SetName(name)
    image.GetPointData().AddArray(array)


distance = x ** 2 + y ** 2
add("FilledMask", (distance < 25).astype(np.uint8))
add("Depth", depth + 0.4 * (x > 0))
assert abs(walk.gap_beside(image) - 0.4) < 1e-12
for beyond, expected in (depth + 40, 40), (np.full_like(depth, np.nan), np.inf):
    add("Depth", np.where((distance < 30) & (y > 0), beyond, depth))
    assert walk.gap_beside(image) == expected or abs(walk.gap_beside(image) - expected) < 1e-12

# Polynomials of degree 3 to rounding, straight lines beside what is missing.
cubic = (np.arange(9) / 4.0)[:, None] ** 3
values = walk.finer(cubic)
assert abs(values[:, 0] - (np.arange(33) / 16) ** 3)[4:-4].max() < 1e-13
cubic[4] = np.nan
values = walk.finer(cubic)[:, 0]
assert np.isnan(values[13:20]).all() and np.isfinite(np.delete(values, np.s_[13:20])).all()
assert abs(values[10] - (cubic[2, 0] + cubic[3, 0]) / 2) < 1e-15

# A cylinder that misses the head, or runs past all of its bone: said, with the numbers given, and nothing is made.
ct, nothing = output("ImplantChecks.vti"), output("ImplantChecksNothing")
walk.SaveData(ct, proxy=walk.SkullPhantom(Spacing=[4, 4, 4]), DataMode="Binary")
for hole in (["300", "5", "0", "10"], ["-13.5", "-400", "20", "30"]):
    sys.argv = ["implant_to_mould.py", "--output", nothing, "--ct", ct, "--hole", *hole]
    try:
        walk.main()
        raise RuntimeError("no error")
    except PipelineError as error:
        assert "nothing is filled" in str(error), error
        for number in hole[:3]:
            assert f"{float(number):g}" in str(error), (number, error)
        assert "--hole and --view are in mm" in str(error), error
    assert os.listdir(nothing) == []

# When a check fails nothing is left under a name that one would make something from.
folder = output("ImplantChecks")
sys.argv = ["implant_to_mould.py", "--output", folder]


def fail(*_):
    assert set(walk.MADE) <= set(os.listdir(folder))
    raise AssertionError("as if")


walk.check = fail
walk.make_pictures = lambda *_: sys.exit("went on")
for _ in range(2):  # also over an older failure
    try:
        walk.main()
        raise RuntimeError("no error")
    except AssertionError as error:
        assert str(error) == "as if", error
    left = [name for name in os.listdir(folder) if not name.startswith("WRONG-")]
    assert left == ["filled.vti"], left
    assert {"WRONG-" + name for name in walk.MADE} <= set(os.listdir(folder))
    assert "WRONG-plate.3mf.json" in os.listdir(folder)
print("done")
