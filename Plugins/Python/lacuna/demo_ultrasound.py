# SPDX-License-Identifier: BSD-3-Clause
"""The ultrasound half of the demo: tracked slices -> volume -> closed surface."""
import os

import numpy as np
import paraview.simple as pv
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties, vtkTriangleFilter

from lacuna import pictures
from lacuna.data import fetch
from lacuna.files import save_data

# fully developed speckle, in floating point so that no bright pixel is cut off
PHANTOM = dict(NumberOfSlices=90, Motion="Arbitrary", Anatomy="Ellipsoids", SpeckleLevel=0.52, OutputScalarType="Float")
BEAM = [5, 3, 1]  # pixels, across and along the beam: makes speckle of a scanner from noise of single pixels
# the sector of a curved probe: where its beams meet (column, row), their directions (degrees) and lengths (mm)
SECTOR = dict(FanOrigin=[160, -90], FanAngles=[-34, 34], FanRadii=[19.6, 65])
ALLOWED = 0.015  # of the volume


def run(options, report):
    """All stages; options are demo.py's, report its Report."""
    report.section("Freehand ultrasound")
    with report.stage("read the sweep" if options.sweep else "make the phantom sweep"):
        sweep, truth = read(options)
        width, height, slices = dimensions(sweep)
        report.add("sweep", options.sweep or "Phantom Sweep (truth known)")
        report.add("slices", f"{slices} of {width} × {height} pixels")
    with report.stage("reconstruct the volume"):
        volume = pv.SweptVolume(Input=sweep, OutputSpacing=[options.spacing] * 3, **(SECTOR if truth else {}))
        if options.clip:
            volume.ClipRectangle = options.clip
        volume.UpdatePipeline()
        report.add("volume, voxels", " × ".join(map(str, dimensions(volume))))
        report.add("voxel, mm", f"{options.spacing:g}")
        report.add("origin, mm", " ".join(f"{b:.3f}" for b in volume.GetDataInformation().GetBounds()[::2]))
        save_data(os.path.join(options.output, "volume.vti"), volume, DataMode="Binary")
    with report.stage("filter and contour"):
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
            error = f"{100 * (millilitres / exact - 1):+.2f} %"
            report.add("true volume, ml", f"{exact:.3f} (error {error})")
            report.compare("the organ's volume", f"{millilitres:.2f} ml", f"{exact:.2f} ml", error, f"{100 * ALLOWED:g} %",
                           abs(millilitres / exact - 1) <= ALLOWED)
        report.require(open_edges == 0, f"the organ's surface is not closed ({open_edges} open edges), so its volume is not sure")
    with report.stage("picture of slices and surface"):
        picture(sweep, surface, truth is not None, f"{millilitres:.1f} ml" + (f" (truth {exact:.1f} ml)" if truth else ""),
                os.path.join(options.output, "ultrasound.png"))
        report.picture("ultrasound.png", f"Left: one of {slices} freehand slices as on the scanner's screen, with the outline of the surface. "
                       "Right: the surface among the slices in space.")


def read(options):
    """The sweep's proxy, and the phantom as an object that knows the truth (None for --sweep)."""
    if options.sweep:
        sweep = pv.TrackedSliceReader(FileName=options.sweep)
        if options.calibration:
            sweep.CalibrationFileName = options.calibration
        sweep.UpdatePipeline()
        return sweep, None
    phantom = pv.PhantomSweep(**PHANTOM)
    return scanned(pv.SpeckleFilter(Input=phantom, Operation="Gaussian", KernelSize=BEAM)), phantom.GetClientSideObject()


def scanned(sweep):
    """The phantom's slices as a curved probe shows them: a sector on black."""
    image = fetch(sweep)
    grey = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[::-1])
    columns, rows = np.meshgrid(np.arange(grey.shape[2]) - SECTOR["FanOrigin"][0], np.arange(grey.shape[1]) - SECTOR["FanOrigin"][1])
    radius, angle = np.hypot(columns, rows) * 0.2, np.degrees(np.arctan2(columns, rows))  # of Phantom Sweep's pixels, mm
    near, far = SECTOR["FanRadii"]
    grey[:, (abs(angle) > SECTOR["FanAngles"][1]) | (radius < near) | (radius > far)] = 0
    producer = pv.TrivialProducer()
    producer.GetClientSideObject().SetOutput(image)
    producer.UpdatePipeline()
    return producer


def dimensions(image):
    extent = image.GetDataInformation().GetExtent()
    return tuple(high - low + 1 for low, high in zip(extent[::2], extent[1::2]))


def surface_level(volume):
    """Otsu's threshold of the voxels that have a grey level."""
    data = fetch(volume).GetPointData()
    return best_split(vtk_to_numpy(data.GetArray("Intensity"))[vtk_to_numpy(data.GetArray("vtkValidPointMask")) > 0])


def best_split(grey):
    """Otsu's threshold of grey levels: the best split into dark and bright."""
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
    seen = {name: list(volume.GetProperty(name)) for name in ("ClipRectangle", *SECTOR)}
    padded = pv.SweptVolume(Input=sweep, OutputSpacing=list(volume.OutputSpacing), OutputBounds=grown, **seen)
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


def show_slices(sweep, first, last, view, sector, points):
    """Shows two slices, or one, as pictures in space."""
    extent = sweep.GetDataInformation().GetExtent()
    few = pv.ExtractSubset(Input=sweep, VOI=[*extent[:4], extent[4] + first, extent[4] + last], SampleRateK=max(1, last - first))
    show_picture(pv.SlicePlanes(Input=few, MaximumNumberOfPoints=points), view, sector)


def show_picture(planes, view, sector):
    """Shows Slice Planes in grey levels; sector: without the black beside it."""
    if sector:
        planes = pv.Threshold(Input=planes, Scalars=["POINTS", "Intensity"], ThresholdMethod="Above Upper Threshold", UpperThreshold=1)
    display = pv.Show(planes, view)
    display.Ambient, display.Diffuse, display.Specular = 1, 0, 0
    pv.ColorBy(display, ("POINTS", "Intensity"))
    table = pv.GetColorTransferFunction("Intensity")
    pictures.apply_preset(table, "Grayscale")
    table.RescaleTransferFunction(0, 220)
    display.SetScalarBarVisibility(view, False)


def picture(sweep, surface, sector, volume, name):
    """A slice as on the screen with the outline of the surface, and beside it the surface among the slices that it was made from."""
    poses = slice_poses(fetch(sweep))
    good = np.flatnonzero(np.isfinite(poses).all(axis=(1, 2)))
    middle, behind = good[len(good) // 2], good[len(good) * 5 // 6]
    center = poses[middle] @ (*[(low + high) / 2 for low, high in zip(fetch(sweep).GetBounds()[:4:2], fetch(sweep).GetBounds()[1:4:2])], 0, 1)
    lateral, depth = (poses[middle][:3, :2] / np.linalg.norm(poses[middle][:3, :2], axis=0)).T
    travel = np.cross(lateral, depth)
    screen, space = pictures.new_view((540, 640)), pictures.new_view((860, 640))

    show_slices(sweep, middle, middle, screen, sector, 80000)
    outline = pv.Slice(Input=surface, SliceType="Plane")
    outline.SliceType.Origin, outline.SliceType.Normal = list(center[:3] - 0.05 * travel), list(travel)
    outline.UpdatePipeline()
    if outline.GetDataInformation().GetNumberOfPoints() > 0:
        line = pictures.show_surface(outline, screen, (1, 0.8, 0.1))
        line.LineWidth, line.Ambient, line.Diffuse = 3, 1, 0
    screen.OrientationAxesVisibility = 0
    pictures.look(screen, travel, -depth)
    pictures.add_scale_bar(screen, 10)
    pictures.add_title(screen, "one slice, and the surface's outline in it")

    show_slices(sweep, middle, behind, space, sector, 160000)
    pictures.show_surface(surface, space, pictures.TISSUE)
    frames = pv.SlicePlanes(Input=sweep, OutlineOnly=1, Stride=max(1, len(good) // 12))
    pictures.show_surface(frames, space, pictures.FRAME).LineWidth = 1
    # as on the scanner's screen, with the probe above, but from aside and a little from above
    pictures.look(space, travel + 0.9 * lateral + 0.45 * depth, -depth, 1.35)
    pictures.add_scale_bar(space, 10)
    pictures.add_title(space, f"all {len(good)} slices in space: {volume}")
    pictures.save_layout(pictures.lay_out([screen, space], "Freehand ultrasound"), name, rendered=True)
