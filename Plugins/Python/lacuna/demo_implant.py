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
        filled = fill(depth, options, skull, ct)
        image = fetch(filled)
        describe(image, skull, report)
        save_data(os.path.join(options.output, "filled-depth-map.vti"), filled, DataMode="Binary")
    with report.stage("write the implant surface"):
        writer = lacuna.vtkLacunaIGESWriter()
        writer.SetInputData(image)
        writer.SetFileName(os.path.join(options.output, "implant.igs"))
        if not writer.Write():
            raise RuntimeError("implant.igs was not written")
        report.add("IGES surface: largest deviation from the fit, mm", f"{writer.GetMaximumDeviation():.2g}")
        report.add("IGES surface: control points", " × ".join(map(str, writer.GetNumberOfControlPoints())))
    with report.stage("picture of skull and implant"):
        picture(image, view, os.path.join(options.output, "implant.png"))


def read(options):
    """The CT's proxy, and the phantom as an object that knows the truth (None for --ct)."""
    if not options.ct:
        ct = pv.SkullPhantom()
        ct.UpdatePipeline()
        return ct, ct.GetClientSideObject()
    ct = open_volume(options.ct)
    return ct, None


def view_up(view):
    """Superior is up; seen from above or below, anterior is (LPS: -y)."""
    x, y, z = view
    return [0, -1, 0] if abs(z) > 0.7 * math.sqrt(x * x + y * y + z * z) else [0, 0, 1]


def fill(depth, options, skull, ct):
    """The hole filler on the hole that the user gave, that the phantom has, or that the map shows."""
    filled = pv.RBFHoleFiller(Input=depth, SupportMargin=options.margin, NodeSpacing=options.node_spacing)
    if skull:
        # a ball over the hole, a little larger than the irregular outline
        center, direction = np.array(ct.Center), np.array(ct.DefectDirection)
        direction = direction / np.linalg.norm(direction)
        on_bone = center + direction * skull.IntersectOuterSurface(center, direction)
        filled.DefectRegion = "Sphere"
        filled.DefectRegion.Center = list(on_bone)
        filled.DefectRegion.Radius = 1.3 * ct.DefectRadius
    elif options.hole:
        filled.DefectRegion = "Cylinder"
        filled.DefectRegion.Center = options.hole[:3]
        filled.DefectRegion.Axis = options.view
        filled.DefectRegion.Radius = options.hole[3]
    filled.UpdatePipeline()
    return filled


def describe(image, skull, report):
    """Numbers of the fit; adds the array Error to the filled pixels where the truth is known."""
    field = image.GetFieldData()
    mask = image.GetPointData().GetArray("FilledMask")
    if mask is None or not vtk_to_numpy(mask).any():
        raise ValueError("the depth map has no surface at this level, or no hole to fill: mark it with --hole X Y Z R")
    mask = vtk_to_numpy(mask) > 0
    report.add("depth map, pixels", "{} × {}".format(*image.GetDimensions()))
    report.add("nodes of the spline", int(field.GetArray("NodeCount").GetValue(0)))
    condition = field.GetArray("ConditionEstimate").GetValue(0)
    report.add("condition estimate", f"{condition:.2g}" if condition else "unknown (fast solution)")
    report.add("hole, mm² of surface", f"{field.GetArray('DefectArea').GetValue(0):.0f}")

    if skull:
        error = np.full(mask.shape, np.nan)
        fitted = vtk_to_numpy(image.GetPointData().GetArray("Fitted"))
        to_world = np.array(field.GetArray("ImageToWorld").GetTuple(0)).reshape(4, 4)
        ray = to_world[:3, 2]
        width = image.GetDimensions()[0]
        for pixel in np.flatnonzero(mask):
            start = to_world @ (pixel % width, pixel // width, 0, 1)
            error[pixel] = fitted[pixel] - skull.IntersectOuterSurface(start[:3], ray)
        truth = "the intact phantom"
    else:
        error = np.where(mask, vtk_to_numpy(image.GetPointData().GetArray("Deviation")), np.nan)
        truth = "the bone that was there"
    array = numpy_to_vtk(error, deep=True)
    array.SetName(ERROR)
    image.GetPointData().AddArray(array)
    known = error[np.isfinite(error)]
    if known.size:
        report.add(f"error against {truth}: largest, mm", f"{np.abs(known).max():.3f}")
        report.add(f"error against {truth}: RMS, mm", f"{np.sqrt((known ** 2).mean()):.3f}")


def picture(image, view, name):
    """The bone in one colour, the implant coloured by its error where the truth is known."""
    source = pv.TrivialProducer()
    source.GetClientSideObject().SetOutput(image)
    source.UpdatePipeline()
    surface = pv.DepthMapSurface(Input=source, MaximumAngle=80)  # steep sides are no gaps
    mask = ["POINTS", "FilledMask"]  # triangles across the border count as bone
    bone = pv.Threshold(Input=surface, Scalars=mask, ThresholdMethod="Below Lower Threshold", LowerThreshold=0.5,
                        AllScalars=0)
    implant = pv.Threshold(Input=surface, Scalars=mask, ThresholdMethod="Above Upper Threshold", UpperThreshold=0.5)
    render = pictures.new_view()
    pictures.show_surface(bone, render, pictures.BONE)
    display = pictures.show_surface(implant, render, pictures.METAL)
    error = vtk_to_numpy(image.GetPointData().GetArray(ERROR))
    if np.isfinite(error).any():
        limit = math.ceil(10 * np.nanmax(np.abs(error))) / 10
        pictures.color_by(display, render, ERROR, "error of the implant, mm", (-limit, limit))
    pictures.look(render, view, view_up(view), 1.1)
    marked = views.in_patient_coordinates(image)
    pictures.add_scale_bar(render, 50, aside=marked)
    if marked:
        views.show_orientation(render)
    pictures.save(render, name)
