# SPDX-License-Identifier: BSD-3-Clause
"""A plate with screws, the model to fit it in, and both moulds to press it, of the Skull Phantom.

    pvpython plate_model_mould.py [FOLDER]

Writes implant-plate.png, defect-model.png and press-orientation.png, the pictures of the user guide.
"""
import os
import sys

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from lacuna import pictures, views
from lacuna.errors import raising
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

PLASTIC, FLANGE, DEFECT = (0.45, 0.60, 0.80), (0.85, 0.78, 0.60), (0.75, 0.10, 0.10)
VIEW = np.array([-0.4, 0.2, -0.9])
UP = [0, -1, 0]  # seen from above, anterior is up


def matrix(data, name):
    """A 4x4 matrix of field data."""
    return vtk_to_numpy(data.GetFieldData().GetArray(name)).reshape(4, 4)


def fill():
    skull = SkullPhantom()
    depth = BSplineIsoRayCaster(Input=skull, IsoValues=[500], ViewDirection=VIEW, ViewUp=UP, ComputeThickness=1)
    return depth, RBFHoleFiller(Input=depth, Smoothing=5, OutputMargin=8)


def screw_places(plate, angles, inside):
    """Points of a plate so far inside its rim, at these angles about its middle as the viewer sees it."""
    plate.UpdatePipeline()
    data = servermanager.Fetch(plate)
    points = vtk_to_numpy(data.GetPoints().GetData())
    axes = matrix(data, "ImageToWorld")[:3, :2]
    x, y = (points @ axes / np.linalg.norm(axes, axis=0)).T
    x, y = x - (x.min() + x.max()) / 2, y - (y.min() + y.max()) / 2
    radius, around = np.hypot(x, y), np.arctan2(y, x)
    places = []
    for angle in np.radians(angles):
        near = np.flatnonzero(np.abs((around - angle + np.pi) % (2 * np.pi) - np.pi) < 0.03)
        places += list(points[near[np.argmin(np.abs(radius[near] - (radius[near].max() - inside)))]])
    return places


def show(proxy, view, color, shine=0.3):
    display = pictures.show_surface(proxy, view, color)
    display.Specular, display.SpecularPower = shine, 40
    return display


def save(view, name, middle, direction, up, zoom, letters):
    """middle: what is in the middle of the picture; letters: what is shown is in patient coordinates, so that the
    edges can say L, R, A, P, H, F.
    """
    pictures.look(view, direction, up, zoom)
    camera = view.GetActiveCamera()
    low, high = np.array(middle.GetDataInformation().GetBounds()).reshape(3, 2).T
    shift = (low + high) / 2 - camera.GetFocalPoint()
    camera.SetFocalPoint(*(camera.GetFocalPoint() + shift))
    camera.SetPosition(*(camera.GetPosition() + shift))
    Render(view)  # sets the clipping range, by which the scale bar is placed
    if letters:
        views.show_orientation(view, force=True)  # a lifted plate is marked, too
    pictures.add_scale_bar(view, 20, aside=letters)
    pictures.save(view, name)
    Delete(view)


def show_plate(name, depth, filled):
    """On the bone, with an overlap, screws and drainage."""
    plate = ImplantPlate(Input=filled, Thickness=1, Side="Outward", EdgeClearance=-5, Bevel=0.5, DrainageSpacing=8,
                         HoleDiameter=1.6, CountersinkDiameter=2.8)
    plate.HolePoints = screw_places(plate, (20, 65, 110, 300), 3.5)
    plate.UpdatePipeline()
    bone = DepthMapSurface(Input=depth, MaximumAngle=80)  # steep sides are no gaps
    view = pictures.new_view((1000, 640))
    show(bone, view, pictures.BONE, 0.15)
    show(plate, view, PLASTIC)
    right = np.cross(VIEW, UP) / np.linalg.norm(np.cross(VIEW, UP))
    save(view, name, plate, VIEW / np.linalg.norm(VIEW) - 0.35 * right, UP, 2.6,
         all(views.in_patient_coordinates(proxy) for proxy in (bone, plate)))


def show_model(name, filled):
    """The plate of the same map above it."""
    model, plate = DefectModel(Input=filled), ImplantPlate(Input=filled, DrainageSpacing=8)
    model.UpdatePipeline()
    away = matrix(servermanager.Fetch(model), "PressToPatient")[:3, :3]
    lifted = Transform(Input=plate)
    lifted.Transform.Translate = list(26 * away[:, 2])
    view = pictures.new_view((1000, 640))
    show(model, view, pictures.BONE, 0.15).Interpolation = "Flat"
    show(lifted, view, PLASTIC)
    # lifted and shown where it is in the patient, but for the 26 mm
    save(view, name, model, -away @ np.array([0.25, -0.6, 0.75]), list(away[:, 1]), 1.25,
         all(views.in_patient_coordinates(proxy) for proxy in (model, plate)))


def show_moulds(name, filled):
    """Female on the left, male on the right."""
    normals_of = SurfaceNormals if "SurfaceNormals" in globals() else GenerateSurfaceNormals  # its name in ParaView 5.11
    view = pictures.new_view((1200, 540))
    plate = ImplantPlate(Input=filled, EdgeClearance=0, EdgeShape="Square", CornerRadius=0)  # its rim is the outline
    face = Threshold(Input=plate, Scalars=["CELLS", "PlateFace"], LowerThreshold=0, UpperThreshold=0)
    edges = FeatureEdges(Input=ExtractSurface(Input=face), FeatureEdges=0)
    edges.UpdatePipeline()
    rim = servermanager.Fetch(edges)
    shown = []
    for k, mould in enumerate(("Female", "Male")):
        press = PressOrientation(Input=filled, Mould=mould, OutputSpacing=0.2)
        press.UpdatePipeline()
        aside = [150 * k, 0, 0]
        surface = Transform(Input=ExtractSurface(Input=press))
        surface.Transform.Translate = aside
        shown.append(surface)
        display = show(normals_of(Input=surface), view, pictures.BONE)
        ColorBy(display, ("POINTS", "PressRegion"))
        table = GetColorTransferFunction("PressRegion")
        table.RGBPoints = [0, *pictures.METAL, 1, *FLANGE, 2, *pictures.BONE]
        display.SetScalarBarVisibility(view, False)
        display.InterpolateScalarsBeforeMapping = 0
        to_press = np.linalg.inv(matrix(servermanager.Fetch(press), "PressToPatient"))
        line = vtkPolyData()
        line.DeepCopy(rim)
        points = vtk_to_numpy(rim.GetPoints().GetData()) @ to_press[:3, :3].T + to_press[:3, 3] + aside
        line.GetPoints().SetData(numpy_to_vtk(points, deep=True))
        source = TrivialProducer()
        source.GetClientSideObject().SetOutput(line)
        show(Tube(Input=source, Radius=0.6), view, DEFECT, 0.1)
    both = GroupDatasets(Input=shown)
    both.UpdatePipeline()
    save(view, name, both, [0, 0.75, -0.65], [0, 0, 1], 2.2, False)  # in the press there is no left or right


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else "."
    os.makedirs(folder, exist_ok=True)
    depth, filled = fill()
    with raising():
        show_plate(os.path.join(folder, "implant-plate.png"), depth, filled)
        show_model(os.path.join(folder, "defect-model.png"), filled)
        show_moulds(os.path.join(folder, "press-orientation.png"), filled)


main()
