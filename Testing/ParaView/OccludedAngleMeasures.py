# SPDX-License-Identifier: BSD-3-Clause
"""Volume and area of closed surfaces (2-D: area and length) against those of ellipsoids, ellipses and blocks.

Off centre, on cubes and on voxels that are none, densely sampled: what is left is the error of the voxels.
"""
import math

import lacuna
import numpy as np
from lacuna import occlusion
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData


def make_image(size, spacing, values, name):
    image = vtkImageData()
    image.SetDimensions(*size)
    image.SetSpacing(*spacing)
    image.SetOrigin(5, -7, 11)
    array = numpy_to_vtk(values.ravel(), deep=1)
    array.SetName(name)
    image.GetPointData().SetScalars(array)
    return image


def make_ellipsoid(half_axes, spacing, shift, complete):
    """Voxels that its surface runs through; complete: with those inside, as an Object. Half axes in mm, shift in voxels."""
    flat = len(half_axes) == 2
    half = np.array(tuple(half_axes) + (1,) * flat, float)
    spacing = np.array(spacing)
    size = (2 * half / spacing).astype(int) + 24
    if flat:
        size[2] = 1
    centre = (0.5 * (size - 1) + shift) * spacing
    centre[2] *= not flat
    k, j, i = np.mgrid[:size[2], :size[1], :size[0]]
    p = np.stack((i, j, k), -1) * spacing - centre
    level = np.linalg.norm(p / half, axis=-1)
    slope = p / half ** 2
    steepness = np.maximum(np.linalg.norm(slope, axis=-1), 1e-9)
    distance = (level - 1) * level / steepness  # exact to first order
    width = 0.5 * np.linalg.norm(slope * spacing, axis=-1) / steepness  # half a voxel's, along the normal
    hit = distance <= width if complete else abs(distance) <= width
    return make_image(size, spacing, hit.astype(np.uint8), "Object" if complete else "Data")


def get_truth(half_axes):
    """Volume in ml and area in mm2 of an ellipsoid; area and length of an ellipse."""
    turn = 2 * math.pi * (np.arange(1000) + 0.5) / 1000
    if len(half_axes) == 2:
        a, b = half_axes
        return math.pi * a * b, 2 * math.pi * np.hypot(a * np.sin(turn), b * np.cos(turn)).mean()
    a, b, c = half_axes
    z = 2 * (np.arange(500) + 0.5)[:, None] / 500 - 1
    r = np.sqrt(1 - z ** 2)
    stretch = np.sqrt((b * c * r * np.cos(turn)) ** 2 + (a * c * r * np.sin(turn)) ** 2 + (a * b * z) ** 2)
    return 4 / 3 * math.pi * a * b * c / 1000, 4 * math.pi * stretch.mean()


def get_errors(surface, truth):
    return 100 * (surface.volume / truth[0] - 1), 100 * (surface.area / truth[1] - 1)


# half axes, voxels; most error of volume and area in % with the object given, and with that of Occluded Angle. Measured:
# up to 0.2 and 1.0 with both (circle of 20: 0.5); of voxels that are no cubes 0.2 and 1.9 with the object given, 1.4 and
# 2.7 with that of Occluded Angle, which then has some voxels too many.
ELLIPSOIDS = [
    ((20, 20, 20), (1, 1, 1), (0.3, 1.2), (0.3, 1.2)),
    ((20, 20, 20), (0.5, 0.5, 0.5), (0.1, 1.2), (0.1, 1.2)),
    ((24, 18, 14), (1, 1, 1), (0.3, 1.2), (0.3, 1.2)),
    ((24, 18, 14), (0.8, 1, 1.4), (0.3, 2.2), (1.7, 3.2)),
    ((20, 20), (1, 1, 1), (0.6, 1), (0.6, 1)),
    ((80, 50), (1, 1, 1), (0.2, 1), (0.3, 1)),
    ((80, 50), (0.8, 1.4, 1), (0.2, 2.1), (0.7, 2.3)),
]
for half_axes, spacing, most, most_found in ELLIPSOIDS:
    truth = get_truth(half_axes)
    for shift in ((0.3, -0.2, 0.45), (0.5, 0.1, 0.25)):
        given = get_errors(occlusion.closed_surface(make_ellipsoid(half_axes, spacing, shift, True)), truth)
        angle = lacuna.vtkLacunaOccludedAngle()
        angle.SetInputData(make_ellipsoid(half_axes, spacing, shift, False))
        angle.SetNumberOfDirections(200)
        angle.SetThresholdsOverPi(0, 2.7 if len(half_axes) == 3 else 1.3)
        found = get_errors(occlusion.closed_surface(angle), truth)
        print(f"{half_axes} of {spacing} mm: object {given[0]:+.2f} %, {given[1]:+.2f} %, "
              f"Occluded Angle {found[0]:+.2f} %, {found[1]:+.2f} %")
        assert all(abs(error) < limit for error, limit in zip(given + found, most + most_found)), (half_axes, spacing)

# Not moved inwards: half a voxel larger all round.
surface = occlusion.closed_surface(make_ellipsoid((20,) * 3, (1, 1, 1), (0.3, -0.2, 0.45), True), compensate=False)
errors = get_errors(surface, get_truth((20.5,) * 3))
assert abs(errors[0]) < 0.3 and abs(errors[1]) < 1.2, errors

# Blocks, between the centres of the outermost voxels: flat faces are exact, edges are rounded.
for size, spacing, most_area in (((20, 20, 20), (1, 1, 1), 2.6), ((20, 24, 28), (1, 1, 1), 2.3),
                                 ((30, 20, 40), (0.5, 1, 1.5), 1.6)):
    solid = np.zeros((60, 60, 60), np.uint8)
    solid[3:3 + size[2], 25:25 + size[1], 14:14 + size[0]] = 1
    x, y, z = (np.array(size) - 1) * spacing
    errors = get_errors(occlusion.closed_surface(make_image((60,) * 3, spacing, solid, "Object")),
                        (x * y * z / 1000, 2 * (x * y + y * z + z * x)))
    print(f"block of {size} voxels of {spacing} mm: {errors[0]:+.2f} %, {errors[1]:+.2f} %")
    assert abs(errors[0]) < 0.3 and -most_area < errors[1] < 0, (size, spacing, errors)
