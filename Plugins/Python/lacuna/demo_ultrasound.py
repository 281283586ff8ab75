# SPDX-License-Identifier: BSD-3-Clause
"""The ultrasound half of the demo: tracked slices -> volume -> closed surface."""
import os

import numpy as np
import paraview.simple as pv
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties, vtkTriangleFilter

from lacuna import pictures
from lacuna.data import fetch
from lacuna.files import save_data

PHANTOM = dict(NumberOfSlices=120, Motion="Arbitrary", Anatomy="Ellipsoids", SpeckleLevel=0.15)


def run(options, report):
    """All stages; options are demo.py's, report its Report."""
    report.section("Freehand ultrasound")
    with report.stage("read the sweep" if options.sweep else "make the phantom sweep"):
        sweep = read(options)
        width, height, slices = dimensions(sweep)
        report.add("sweep", options.sweep or "Phantom Sweep (truth known)")
        report.add("slices", f"{slices} of {width} × {height} pixels")
    with report.stage("reconstruct the volume"):
        volume = pv.SweptVolume(Input=sweep, OutputSpacing=[options.spacing] * 3)
        if options.clip:
            volume.ClipRectangle = options.clip
        volume.UpdatePipeline()
        report.add("volume, voxels", " × ".join(map(str, dimensions(volume))))
        report.add("voxel, mm", f"{options.spacing:g}")
        report.add("origin, mm", " ".join(f"{b:.3f}" for b in volume.GetDataInformation().GetBounds()[::2]))
        save_data(os.path.join(options.output, "volume.vti"), volume, DataMode="Binary")
    with report.stage("filter and contour"):
        truth = None if options.sweep else sweep.GetClientSideObject()
        if options.level is not None:
            level = options.level
        else:
            level = truth.GetTrueIsoValue() if truth else surface_level(volume)
        surface = closed_surface(sweep, volume, level, options.median)
        surface.UpdatePipeline()
        save_data(os.path.join(options.output, "surface.stl"), surface)
        millilitres, open_edges = measure(surface)
        report.add("surface level, grey", f"{level:.1f}")
        report.add("enclosed volume, ml", f"{millilitres:.3f}")
        report.add("open edges of the surface", open_edges)
        if truth:
            exact = truth.GetTrueVolume() / 1000
            report.add("true volume, ml", f"{exact:.3f} (error {100 * (millilitres / exact - 1):+.2f} %)")
    with report.stage("picture of slices and surface"):
        picture(sweep, surface, os.path.join(options.output, "ultrasound.png"))


def read(options):
    if options.sweep:
        sweep = pv.TrackedSliceReader(FileName=options.sweep)
        if options.calibration:
            sweep.CalibrationFileName = options.calibration
    else:
        sweep = pv.PhantomSweep(**PHANTOM)
    sweep.UpdatePipeline()
    return sweep


def dimensions(image):
    extent = image.GetDataInformation().GetExtent()
    return tuple(high - low + 1 for low, high in zip(extent[::2], extent[1::2]))


def surface_level(volume):
    """Otsu's threshold of the voxels that have a grey level: the best split into dark and bright."""
    data = fetch(volume).GetPointData()
    grey = vtk_to_numpy(data.GetArray("Intensity"))[vtk_to_numpy(data.GetArray("vtkValidPointMask")) > 0]
    counts, edges = np.histogram(grey, 256)
    centers = (edges[:-1] + edges[1:]) / 2
    dark, bright = np.cumsum(counts)[:-1], np.cumsum(counts[::-1])[::-1][1:]
    sums = np.cumsum(counts * centers)
    between = np.where((dark > 0) & (bright > 0),
                       (sums[:-1] / np.maximum(dark, 1) - (sums[-1] - sums[:-1]) / np.maximum(bright, 1)) ** 2
                       * dark * bright, 0)
    return float(edges[1:-1][between.argmax()])


def closed_surface(sweep, volume, level, median):
    """Contour of the median-filtered volume. A rim of empty voxels around the sweep closes it there."""
    bounds = volume.GetDataInformation().GetBounds()
    rim = [median * s for s in volume.OutputSpacing]
    grown = [b + side * rim[i] for i in range(3) for b, side in ((bounds[2 * i], -1), (bounds[2 * i + 1], 1))]
    padded = pv.SweptVolume(Input=sweep, OutputSpacing=list(volume.OutputSpacing), OutputBounds=grown,
                            ClipRectangle=list(volume.ClipRectangle))
    smooth = pv.SpeckleFilter(Input=padded, Operation="Median", KernelSize=[median] * 3)
    contour = pv.Contour(Input=smooth, ContourBy=["POINTS", "Intensity"], Isosurfaces=[level],
                         ComputeNormals=1, ComputeScalars=0)
    largest = pv.Connectivity(Input=contour, ExtractionMode="Extract Largest Region", ColorRegions=0)
    return pv.ExtractSurface(Input=largest)


def measure(surface):
    """Enclosed volume in ml, and the number of edges that only one triangle has (0 = closed)."""
    triangles = vtkTriangleFilter()
    triangles.SetInputData(fetch(surface))
    mass = vtkMassProperties()
    mass.SetInputConnection(triangles.GetOutputPort())
    mass.Update()
    edges = vtkFeatureEdges()
    edges.SetInputConnection(triangles.GetOutputPort())
    edges.FeatureEdgesOff()
    edges.NonManifoldEdgesOff()
    edges.BoundaryEdgesOn()
    edges.Update()
    return mass.GetVolume() / 1000, edges.GetOutput().GetNumberOfCells()


def slice_poses(image):
    """ImageToReference of all slices, N x 4 x 4."""
    return vtk_to_numpy(image.GetFieldData().GetArray("ImageToReference")).reshape(-1, 4, 4)


def slice_frames(image, step):
    """Outlines of every step-th slice, as lines in the reference frame."""
    x0, x1, y0, y1 = image.GetBounds()[:4]
    points, lines = vtkPoints(), vtkCellArray()
    for pose in slice_poses(image)[::step]:
        if np.isfinite(pose).all():
            corners = [points.InsertNextPoint((pose @ (x, y, 0, 1))[:3])
                       for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
            lines.InsertNextCell(5, corners + corners[:1])
    frames = vtkPolyData()
    frames.SetPoints(points)
    frames.SetLines(lines)
    return frames


def picture(sweep, surface, name):
    """The surface among the outlines of the slices that it was made from."""
    render = pictures.new_view()
    pictures.show_surface(surface, render, pictures.TISSUE)
    image = fetch(sweep)
    frames = pv.TrivialProducer()
    frames.GetClientSideObject().SetOutput(slice_frames(image, max(1, dimensions(sweep)[2] // 20)))
    display = pictures.show_surface(frames, render, (0.35, 0.45, 0.6))
    display.LineWidth = 1.5
    # from the probe into the tissue, a little from the side
    middle = slice_poses(image)[dimensions(sweep)[2] // 2][:3, :2]
    lateral, depth = (middle / np.linalg.norm(middle, axis=0)).T
    travel = np.cross(lateral, depth)
    pictures.look(render, depth + 0.35 * lateral + 0.5 * travel, travel - 0.5 * depth, 1.1)
    pictures.add_scale_bar(render, 10)
    pictures.save(render, name)
