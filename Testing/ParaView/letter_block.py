# SPDX-License-Identifier: BSD-3-Clause
"""The block with letters F in its faces that MakeLetterBlock.cxx scans, in patient coordinates (LPS, mm)."""
import numpy as np
from paraview.simple import TrivialProducer
from vtkmodules.util.numpy_support import numpy_to_vtk

HALF = 28.0  # from the middle, which is the origin, to the faces
BARS = np.array([[-8, -3.5, -10, 10], [-8, 8, 5.5, 10], [-8, 4, -2.5, 2]])  # a0 a1 b0 b1 of the letter


def rotation(axis, angle):
    k = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


AXES = rotation([0.3, -1, 0.5], 0.35)  # of the block, in columns


def face_axes(face):
    """Directions of a face 0..4: along the letter's bars (a), up its stem (b), and outwards."""
    axis, sign = face // 2, -1.0 if face % 2 else 1.0
    return sign * AXES[:, (axis + 1) % 3], AXES[:, (axis + 2) % 3], sign * AXES[:, axis]


def letter_distance(a, b):
    """Distance from the letter, 0 inside."""
    return np.min([np.hypot(np.maximum(np.maximum(x0 - a, a - x1), 0), np.maximum(np.maximum(y0 - b, b - y1), 0))
                   for x0, x1, y0, y1 in BARS], axis=0)


def with_mask(image, name, mask):
    """A source of the map with one more array, 1 where mask is true."""
    array = numpy_to_vtk(mask.astype(np.int8).ravel(), deep=True)
    array.SetName(name)
    image.GetPointData().AddArray(array)
    source = TrivialProducer()
    source.GetClientSideObject().SetOutput(image)
    return source
