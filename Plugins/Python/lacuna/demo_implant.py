# SPDX-License-Identifier: BSD-3-Clause
"""The implant half of the demo: CT -> depth map -> filled hole -> IGES surface."""
import math
import os

import numpy as np
import paraview.simple as pv
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import lacuna
from lacuna import pictures, views
from lacuna.data import fetch, open_volume
from lacuna.files import save_data

ERROR = "Error"  # point array of the picture: fitted minus true depth, mm
# a large hole of the left side; voxels whose steps are not seen in the picture
PHANTOM = dict(Spacing=[1.25] * 3, DefectRadius=38, DefectDirection=[0.7, -0.2, 0.66], NoiseLevel=20)
# what the guide's study of skulls recommends for large holes
LARGE = dict(Kernel="Cubic", SupportStepMargin=3, CutoffWavelength=10)
WALL = 10  # mm: what lies deeper behind the filled surface was seen through the hole
SMALL = 100  # mm² that nobody makes an implant for
ALLOWED, ALLOWED_RMS, ALLOWED_IGES = 0.7, 0.2, 0.005  # mm


def run(options, report):
    """All stages; options are demo.py's, report its Report."""
    report.section("Cranial implant")
    with report.stage("read the CT" if options.ct else "make the skull phantom"):
        ct, skull = read(options)
        view = options.view if options.ct else [-c for c in ct.DefectDirection]
        report.add("CT", options.ct or "Skull Phantom (truth known)")
        bounds = ct.GetDataInformation().GetBounds()
        size = [f"{high - low:.1f}" for low, high in zip(bounds[::2], bounds[1::2])]
        report.add("size, mm", " × ".join(size))
    with report.stage("cast rays: depth map"):
        # the interpolating spline: the quasi-interpolating one shifts a curved surface inwards
        depth = pv.BSplineIsoRayCaster(Input=ct, IsoValues=[options.iso], ViewDirection=view,
                                       Interpolation="InterpolatingBSpline")
        depth.ViewUp = view_up(view)
        depth.UpdatePipeline()
        report.add("bone surface, HU", f"{options.iso:g}")
        report.add("view direction", " ".join(f"{c:.3g}" for c in view))
    with report.stage("fill the hole"):
        filled = fill(depth, options, skull)
        image = fetch(filled)
        describe(image, skull, options.hole, report)
        save_data(os.path.join(options.output, "filled-depth-map.vti"), filled, DataMode="Binary")
    with report.stage("write the implant surface"):
        writer = lacuna.vtkLacunaIGESWriter()
        writer.SetInputData(image)
        writer.SetFileName(os.path.join(options.output, "implant.igs"))
        if not writer.Write():
            raise RuntimeError("implant.igs was not written")
        report.add("IGES surface: largest deviation from the fit, mm", f"{writer.GetMaximumDeviation():.2g}")
        report.add("IGES surface: control points", " × ".join(map(str, writer.GetNumberOfControlPoints())))
        report.require(writer.GetMaximumDeviation() <= ALLOWED_IGES, "the IGES surface is "
                       f"{writer.GetMaximumDeviation():.2g} mm off the fitted one, more than {ALLOWED_IGES:g} mm")
    with report.stage("picture of skull and implant"):
        area = image.GetFieldData().GetArray("DefectArea").GetValue(0)
        shown = f"{area / 100:.0f} cm²" if area >= 100 else f"{area:.0f} mm²"
        picture(depth, image, view, f"bone that is replaced: {shown}" if options.hole else f"the hole: {shown}",
                1.1 if options.ct else 1.25, os.path.join(options.output, "implant.png"))
        report.picture("implant.png", "Left: the skull before. Right: the surface of the implant in it" +
                       (", coloured by its error against the bone." if np.isfinite(errors(image)).any() else "."))


def read(options):
    """The CT's proxy, and the phantom as an object that knows the truth (None for --ct)."""
    if not options.ct:
        ct = pv.SkullPhantom(**PHANTOM)
        ct.UpdatePipeline()
        return ct, ct.GetClientSideObject()
    ct = open_volume(options.ct)
    return ct, None


def view_up(view):
    """Superior is up; seen from above or below, anterior is (LPS: -y)."""
    x, y, z = view
    return [0, -1, 0] if abs(z) > 0.7 * math.sqrt(x * x + y * y + z * z) else [0, 0, 1]


def fill(depth, options, skull):
    """The hole filler on the hole that the user gave, or on what the map's bone encloses."""
    filled = pv.RBFHoleFiller(Input=depth, SupportMargin=options.margin or (20 if skull else 12),
                              NodeSpacing=options.node_spacing or (2 if skull else 1), **(LARGE if skull else {}))
    if options.hole:
        filled.DefectRegion = "Cylinder"
        filled.DefectRegion.Center = options.hole[:3]
        filled.DefectRegion.Axis = options.view
        filled.DefectRegion.Radius = options.hole[3]
    filled.UpdatePipeline()
    return filled


def errors(image):
    """Fitted minus true depth at each pixel, mm; NaN where the truth is not known."""
    return vtk_to_numpy(image.GetPointData().GetArray(ERROR))


def describe(image, skull, hole, report):
    """Numbers of the fit; adds the array Error to the map: at filled pixels where the truth is known."""
    field = image.GetFieldData()
    mask = image.GetPointData().GetArray("FilledMask")
    if mask is None or not vtk_to_numpy(mask).any():
        raise ValueError("the depth map has no surface at this level, or no hole to fill: mark it with --hole X Y Z R")
    mask = vtk_to_numpy(mask) > 0
    report.add("depth map, pixels", "{} × {}".format(*image.GetDimensions()))
    report.add("nodes of the spline", int(field.GetArray("NodeCount").GetValue(0)))
    condition = field.GetArray("ConditionEstimate").GetValue(0)
    report.add("condition estimate", f"{condition:.2g}" if condition else "unknown (fast solution)")
    area = field.GetArray("DefectArea").GetValue(0)
    report.add("hole, mm² of surface", f"{area:.0f}")
    report.require(hole or area >= SMALL, f"what the bone encloses in this view is only {area:.0f} mm², too small for an implant: look into the hole "
                   "with --view, or mark it with --hole X Y Z R")
    if skull:
        error, truth = true_error(image, mask, skull), "the intact phantom"
    else:
        error, truth = removed_error(image, mask, hole), "the bone that was there"
    array = numpy_to_vtk(error, deep=True)
    array.SetName(ERROR)
    image.GetPointData().AddArray(array)
    known = error[np.isfinite(error)]
    if not known.size:
        report.add("error", "unknown: bone is missing there. --hole X Y Z R on sound bone replaces it and tells the error")
        return
    if known.size < mask.sum():
        report.add("pixels where bone was there", f"{known.size} of {mask.sum()}; the others saw through the hole")
    largest, rms = np.abs(known).max(), np.sqrt((known ** 2).mean())
    report.add(f"error against {truth}: largest, mm", f"{largest:.3f}")
    report.add(f"error against {truth}: RMS, mm", f"{rms:.3f}")
    if skull:
        report.compare("the implant", f"{rms:.2f} mm RMS", "0 mm", f"{largest:.2f} mm at most ({rms:.2f} mm RMS)",
                       f"{ALLOWED:g} mm ({ALLOWED_RMS:g} mm RMS)", largest <= ALLOWED and rms <= ALLOWED_RMS)


def true_error(image, mask, skull):
    """Against the intact phantom, along the rays."""
    error = np.full(mask.shape, np.nan)
    fitted = vtk_to_numpy(image.GetPointData().GetArray("Fitted"))
    to_world = np.array(image.GetFieldData().GetArray("ImageToWorld").GetTuple(0)).reshape(4, 4)
    ray = to_world[:3, 2]
    width = image.GetDimensions()[0]
    for pixel in np.flatnonzero(mask):
        start = to_world @ (pixel % width, pixel // width, 0, 1)
        error[pixel] = fitted[pixel] - skull.IntersectOuterSurface(start[:3], ray)
    return error


def removed_error(image, mask, hole):
    """Against the bone that was replaced. Only where the user marked a place there can be such bone: of a hole of its own the rays saw the inside
    of the skull's other side."""
    deviation = vtk_to_numpy(image.GetPointData().GetArray("Deviation"))
    return np.where(mask & (np.abs(deviation) <= WALL) & bool(hole), deviation, np.nan)


def show_map(proxy, view):
    """The surface of a depth map, steep sides and the wall of the hole too: they are no gaps."""
    return pictures.show_surface(pv.DepthMapSurface(Input=proxy, MaximumAngle=88), view, pictures.BONE)


def picture(depth, image, view, hole, zoom, name):
    """The skull with its hole, and beside it with the implant, coloured by its error where the truth is known."""
    source = pv.TrivialProducer()
    source.GetClientSideObject().SetOutput(image)
    source.UpdatePipeline()
    surface = pv.DepthMapSurface(Input=source, MaximumAngle=80)
    mask = ["POINTS", "FilledMask"]  # triangles across the border count as bone
    bone = pv.Threshold(Input=surface, Scalars=mask, ThresholdMethod="Below Lower Threshold", LowerThreshold=0.5,
                        AllScalars=0)
    implant = pv.Threshold(Input=surface, Scalars=mask, ThresholdMethod="Above Upper Threshold", UpperThreshold=0.5)
    before, after = pictures.new_view((640, 640)), pictures.new_view((760, 640))
    show_map(depth, before)
    before.OrientationAxesVisibility = 0
    pictures.show_surface(bone, after, pictures.BONE)
    display = pictures.show_surface(implant, after, pictures.METAL)
    known = np.isfinite(errors(image)).any()
    if known:
        limit = math.ceil(10 * np.nanmax(np.abs(errors(image)))) / 10
        pictures.color_by(display, after, ERROR, "error of the implant, mm", (-limit, limit))
    marked = views.in_patient_coordinates(image)
    for render, title in ((before, hole), (after, "the implant" + (", coloured by its error" if known else ""))):
        pictures.look(render, view, view_up(view), zoom)
        render.CameraParallelScale = before.CameraParallelScale  # both as large
        pictures.add_scale_bar(render, 50, aside=marked)
        if marked:
            views.show_orientation(render)
            title_beside(render, title)
        else:
            pictures.add_title(render, title)
    pictures.save_layout(pictures.lay_out([before, after], "Cranial implant"), name, rendered=True)


def title_beside(view, text):
    """A line of dark text left of the letter at the upper edge."""
    display = pv.Show(pv.Text(Text=text), view)
    display.Color, display.FontSize = [0.1, 0.1, 0.1], 18
    display.WindowLocation = "Upper Left Corner"
