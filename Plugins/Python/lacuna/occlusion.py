# SPDX-License-Identifier: BSD-3-Clause
"""Closed surfaces and volumes from Occluded Angle.

    from lacuna import occlusion
    shape = OccludedAngle(Input=data, **occlusion.scaled(occlusion.GROW_AND_SNAP, data))
    shape.NumberOfDirections = 400
    surface = occlusion.closed_surface(shape)  # 80 to 90 % missing; of denser data take occlusion.DENSE
    print(surface.volume, "ml", surface.area, "mm2")

Volumes are in ml and areas in mm2; of 2-D images, areas in mm2 and lengths in mm.
"""
import math

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_UNSIGNED_CHAR, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersCore import (vtkCleanPolyData, vtkFlyingEdges2D, vtkFlyingEdges3D, vtkMassProperties,
                                       vtkPolyDataConnectivityFilter, vtkPolyDataNormals, vtkReverseSense, vtkStripper)
from vtkmodules.vtkImagingCore import vtkImageConstantPad

# How often closed_surface smooths: the steps of digital planes go (they make the area of a sphere 9 % too large, this
# leaves 1 %), edges become round by about a voxel.
SMOOTHING = 10

# The published schedule for a cube of which up to 80 % of the surface is missing (Carr 1996, section 5.8).
CUBE = dict(Mode="Binary", Dilation=1 / 3, ThresholdsOverPi=[2.5, 2.5, 2.0, 2.0])

# The same with up to 90 % missing, its radii in voxels: see scaled(). For flat faces: it fills hollows.
SPARSE_CUBE = dict(Mode="Continuous", KeepData=1, ThresholdsOverPi=[0.5] * 2 + [2.4] * 2 + [3.9] * 2 + [2.25] * 8,
                   LocalRadii=[2] * 2 + [0] * 2 + [3] * 2 + [0] * 8)

# For surfaces of which 80 to 90 % is missing, single voxels, or about 60 % in patches, with few outliers, its radii in
# voxels: grow the data into a shell (two), fill it (one), shrink it again (two), grow to where the data are (nine).
# Of denser data it makes closed but too large shapes (40 % there: 8 to 10 % of the volume): for their volumes take
# Occlusion Surface after it, which stays right, or DENSE.
GROW_AND_SNAP = dict(Mode="Continuous", KeepData=1,
                     ThresholdsOverPi=[0.32] * 2 + [2.67] + [3.92] * 2 + [2.69] * 6 + [2.52] * 3,
                     LocalRadii=[1.5] * 2 + [0] + [1.5] * 2 + [0] * 9)

# For surfaces of which at least 40 % is there as single voxels, or 80 % in patches, also with outliers and complete
# ones; it finds nothing of sparser data.
DENSE = dict(Mode="Continuous", KeepData=1, ThresholdsOverPi=[2.69] * 3, LocalRadii=[0])


class Surface:
    """A closed surface (vtkPolyData), its volume and area; of 2-D data a closed curve, its area and length."""

    def __init__(self, data, volume, area):
        self.data, self.volume, self.area = data, volume, area


def _image(source):
    """vtkImageData of a proxy, an algorithm or an image."""
    if isinstance(source, vtkImageData):
        return source
    if hasattr(source, "GetOutputDataObject"):
        source.Update()
        return source.GetOutputDataObject(0)
    from lacuna.data import fetch
    source.UpdatePipeline()
    return fetch(source)


def scaled(schedule, source):
    """A schedule of this module for an image: its local radii, in voxels, become mm (of the shortest edge of a voxel)."""
    image = _image(source)
    edge = min([s for s, n in zip(image.GetSpacing(), image.GetDimensions()) if n > 1], default=1.0)
    return dict(schedule, LocalRadii=[radius * edge for radius in schedule.get("LocalRadii", [0])])


def _flat(image):
    return min(image.GetDimensions()) == 1


def _array(image, name):
    """A point array of Occluded Angle as numpy; of other inputs a ValueError that says so."""
    array = image.GetPointData().GetArray(name) if isinstance(image, vtkImageData) else None
    if array is None:
        raise ValueError(f"the source has no point array '{name}'; give the output of Occluded Angle")
    return vtk_to_numpy(array)


def _contour(image, largest):
    """The faces of the array Object's voxels, cut at edges and corners, in voxels."""
    solid = _array(image, "Object")
    if not solid.any():
        raise ValueError("no voxel reached the last threshold: there is no object to take the surface of")
    core = solid.reshape(image.GetDimensions()[::-1]) != 0
    for axis in range(3):
        if core.shape[axis] > 1:
            core = core.take(range(1, core.shape[axis]), axis) & core.take(range(core.shape[axis] - 1), axis)
    if not core.any():
        raise ValueError("the object is too small to take the surface of: nowhere is it two voxels wide along all axes")
    data = vtkImageData()
    data.SetExtent(image.GetExtent())
    data.GetPointData().SetScalars(numpy_to_vtk(solid != 0, deep=1, array_type=VTK_UNSIGNED_CHAR))
    pad = vtkImageConstantPad()  # an object at the edge of the image is closed there
    pad.SetInputData(data)
    extent = image.GetExtent()
    pad.SetOutputWholeExtent([e + (2 * (i % 2) - 1) * (extent[i // 2 * 2] < extent[i // 2 * 2 + 1])
                              for i, e in enumerate(extent)])
    contour = vtkFlyingEdges2D() if _flat(image) else vtkFlyingEdges3D()
    contour.SetInputConnection(pad.GetOutputPort())
    contour.SetValue(0, 0.5)
    if not _flat(image):
        contour.ComputeNormalsOff()
    contour.ComputeScalarsOff()
    regions = vtkPolyDataConnectivityFilter()
    regions.SetInputConnection(contour.GetOutputPort())
    if largest:
        regions.SetExtractionModeToLargestRegion()
    else:
        regions.SetExtractionModeToAllRegions()
    clean = vtkCleanPolyData()  # drops the points of the other regions
    clean.SetInputConnection(regions.GetOutputPort())
    clean.PointMergingOff()
    clean.Update()
    return clean.GetOutput()


def _smooth(points, mean):
    """Takes away steps of voxels: each time a point moves half of the way to the mean of its neighbours, and back by half
    of the way there is then: that leaves what is wider than some voxels where it is, curved or not."""
    for _ in range(SMOOTHING):
        for part in (0.5, -0.5):
            points = points + part * (mean(points) - points)
    return points


def _smooth_surface(surface):
    points = vtk_to_numpy(surface.GetPoints().GetData())
    corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    start, end = corners.ravel(), np.roll(corners, -1, 1).ravel()  # closed: each edge is there in both directions
    count = np.bincount(start, minlength=len(points))
    points[:] = _smooth(points.astype(float), lambda p: np.stack(
        [np.bincount(start, p[end, c], len(p)) / count for c in range(3)], 1))


def _shrink(surface):
    """Moves the points inwards along the normals by half a voxel.

    Inwards is into the object: the contour's triangles have their outsides where there is none, around holes too.
    """
    normals = vtkPolyDataNormals()
    normals.SetInputData(surface)
    normals.SplittingOff()
    normals.ConsistencyOff()
    normals.AutoOrientNormalsOff()
    normals.Update()
    moved = vtkPolyData()
    moved.DeepCopy(normals.GetOutput())
    vtk_to_numpy(moved.GetPoints().GetData())[:] -= 0.5 * vtk_to_numpy(moved.GetPointData().GetNormals())
    return moved


def _place(surface, image):
    """Moves points from voxels to where the image is; polygons keep their outsides outside."""
    matrix = image.GetDirectionMatrix()
    direction = np.array([[matrix.GetElement(i, j) for j in range(3)] for i in range(3)])
    spacing = np.array(image.GetSpacing())
    points = vtk_to_numpy(surface.GetPoints().GetData())
    points[:] = (points * spacing) @ direction.T + image.GetOrigin()
    normals = surface.GetPointData().GetNormals()
    if normals:
        vectors = vtk_to_numpy(normals)
        vectors[:] = (vectors / spacing) @ direction.T
        vectors /= np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-30)
    if np.linalg.det(direction) < 0 and surface.GetNumberOfPolys():
        reverse = vtkReverseSense()
        reverse.SetInputData(surface)
        reverse.ReverseCellsOn()
        reverse.Update()
        surface.ShallowCopy(reverse.GetOutput())
    surface.Modified()


def data_points(source):
    """The voxels whose scalars are not 0 as points (vtkPolyData), for pictures."""
    image = _image(source)
    points, data = vtkPoints(), vtkPolyData()
    for i in np.flatnonzero(vtk_to_numpy(image.GetPointData().GetScalars())):
        points.InsertNextPoint(image.GetPoint(int(i)))
    data.SetPoints(points)
    data.AllocateEstimate(1, points.GetNumberOfPoints())
    data.InsertNextCell(2, points.GetNumberOfPoints(), list(range(points.GetNumberOfPoints())))  # VTK_POLY_VERTEX
    return data


def _loops(curve):
    """Closed loops of points, each an array (n, 3)."""
    stripper = vtkStripper()
    stripper.SetInputData(curve)
    stripper.JoinContiguousSegmentsOn()
    stripper.SetMaximumLength(10 ** 9)
    stripper.Update()
    output = stripper.GetOutput()
    points = vtk_to_numpy(output.GetPoints().GetData()).astype(float)
    return [points[[output.GetCell(c).GetPointId(i) for i in range(output.GetCell(c).GetNumberOfPoints())]]
            for c in range(output.GetNumberOfCells())]


def _are_holes(loops, x, y):
    """Which of the loops bound holes: those within an odd number of others."""
    loops = [loop[:-1] if np.allclose(loop[0], loop[-1]) else loop for loop in loops]
    start, end = np.concatenate(loops), np.concatenate([np.roll(loop, -1, 0) for loop in loops])
    owner = np.repeat(np.arange(len(loops)), [len(loop) for loop in loops])
    holes = []
    for i, loop in enumerate(loops):
        a, b, p = start[owner != i], end[owner != i], loop[0]
        cross = (a[:, y] > p[y]) != (b[:, y] > p[y])  # the line through p along x
        a, b = a[cross], b[cross]
        beyond = a[:, x] + (p[y] - a[:, y]) / (b[:, y] - a[:, y]) * (b[:, x] - a[:, x]) > p[x]
        holes.append(bool(beyond.sum() % 2))
    return holes


def _inward(loop, hole, distance, x, y):
    """A closed loop smoothed and moved to the side of the object."""
    loop = loop[:-1] if np.allclose(loop[0], loop[-1]) else loop
    loop = _smooth(loop, lambda p: 0.5 * (np.roll(p, 1, 0) + np.roll(p, -1, 0)))
    tangent = np.roll(loop, -1, 0) - np.roll(loop, 1, 0)
    signed = np.sum(loop[:, x] * np.roll(loop[:, y], -1) - np.roll(loop[:, x], -1) * loop[:, y])
    outwards = math.copysign(1, signed) * (-1 if hole else 1)  # of the object
    length = np.hypot(tangent[:, x], tangent[:, y])
    keep = length > 0
    loop[np.ix_(keep, (x, y))] -= distance * outwards * np.stack(
        (tangent[keep, y], -tangent[keep, x]), 1) / length[keep, None]
    return loop


def _measure(loop, hole, x, y):
    """The area (of a hole: below 0) and length of a closed loop."""
    area = 0.5 * abs(np.sum(loop[:, x] * np.roll(loop[:, y], -1) - np.roll(loop[:, x], -1) * loop[:, y]))
    return -area if hole else area, float(np.linalg.norm(loop - np.roll(loop, 1, 0), axis=1).sum())


def closed_surface(source, largest=True, compensate=True):
    """The closed surface of the array Object of Occluded Angle.

    The contour runs along the faces of the object's voxels; their steps are smoothed away, without shrinking it.
    Opaque voxels mark the surface at their centres: with compensate the contour is moved inwards by half a voxel (Carr
    1996 does not; it makes a sphere of radius 20 by 7.7 % too large).

    An object that the image's border cuts is closed there by a flat face.

    largest: the largest region only, without what outliers made and with its holes filled; otherwise all regions, and
    the volume is without holes. Returns a Surface; raises ValueError when there is no object or it is nowhere two voxels
    wide.
    """
    image = _image(source)
    surface = _contour(image, largest)
    if _flat(image):
        area = length = 0
        points, loops = vtkPoints(), []
        found = _loops(surface)
        axes = [c for c in range(3) if c != int(np.argmin(image.GetDimensions()))]
        for loop, hole in zip(found, _are_holes(found, *axes)):
            moved = _inward(loop, hole, 0.5 * bool(compensate), *axes)
            loops.append([points.InsertNextPoint(p) for p in moved])
            a, l = _measure(moved * image.GetSpacing(), hole, *axes)
            area, length = area + a, length + l
        curve = vtkPolyData()
        curve.SetPoints(points)
        curve.AllocateEstimate(len(loops), 100)
        for ids in loops:
            curve.InsertNextCell(4, len(ids) + 1, ids + ids[:1])  # VTK_POLY_LINE
        _place(curve, image)
        return Surface(curve, area, length)
    _smooth_surface(surface)
    if compensate:
        surface = _shrink(surface)
    _place(surface, image)
    mass = vtkMassProperties()
    mass.SetInputData(surface)
    mass.Update()
    return Surface(surface, mass.GetVolume() / 1000, mass.GetSurfaceArea())


def volume_against_threshold(source, thresholds_over_pi=None):
    """How much the answer depends on the last threshold: arrays (threshold / pi, volume in ml or area in mm2).

    Counts the voxels whose OccludedAngle is at or above each threshold. A flat stretch means that the shape does not
    depend on the choice; how large it is says closed_surface: counted voxels are half a voxel too large all round, and
    data that KeepData adds to the shape are not in the count.
    """
    image = _image(source)
    angle = _array(image, "OccludedAngle") / math.pi
    if thresholds_over_pi is None:
        thresholds_over_pi = np.linspace(0.1, 1.99 if _flat(image) else 3.99, 79)
    voxel = math.prod(s for s, n in zip(image.GetSpacing(), image.GetDimensions()) if n > 1)
    unit = voxel if _flat(image) else voxel / 1000
    order = np.sort(angle)
    counts = len(order) - np.searchsorted(order, np.asarray(thresholds_over_pi))
    return np.asarray(thresholds_over_pi, float), unit * counts


def suggested_threshold(source, iteration=0):
    """The threshold over pi that Occluded Angle suggests after an iteration; 0 if none.

    iteration: counted from 0, the one that sees the data themselves. Later ones (-1: the last) are of the shape before
    and do not say which threshold suits the data.
    """
    array = _image(source).GetFieldData().GetArray("SuggestedThresholdOverPi")
    if array is None:
        raise ValueError("the source has no field array 'SuggestedThresholdOverPi'; give the output of Occluded Angle")
    count = array.GetNumberOfTuples()
    if not -count <= iteration < count:
        raise ValueError(f"there is no iteration {iteration}: the source has {count}, counted from 0")
    return array.GetValue(iteration % count)


def plot_volume(source, file_name=None, **options):
    """Shows the volume against the threshold in a ParaView line chart; file_name: saves it as PNG. Returns the view."""
    import paraview.simple as pv
    from vtkmodules.vtkCommonDataModel import vtkTable
    from lacuna import pictures
    thresholds, volumes = volume_against_threshold(source, **options)
    table = vtkTable()
    for name, values in (("Threshold / pi", thresholds), ("Volume", volumes)):
        array = numpy_to_vtk(values, deep=1)
        array.SetName(name)
        table.AddColumn(array)
    producer = pv.TrivialProducer()
    producer.GetClientSideObject().SetOutput(table)
    producer.UpdatePipeline()
    flat = _flat(_image(source))
    view = pictures.new_chart("last threshold / pi", "area of voxels / mm2" if flat else "volume of voxels / ml")
    display = pv.Show(producer, view)
    display.UseIndexForXAxis = 0
    display.XArrayName = "Threshold / pi"
    display.SeriesVisibility = ["Volume"]
    if file_name:
        pictures.save(view, file_name)
    return view
