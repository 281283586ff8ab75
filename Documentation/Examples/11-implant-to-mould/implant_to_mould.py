# SPDX-License-Identifier: BSD-3-Clause
"""From the CT of a skull with a hole to a plate, a model to fit it in, a mould and the program that mills it.

    pvpython -- implant_to_mould.py [--output FOLDER] [--ct CT --hole X Y Z R [--view X Y Z]]

The -- keeps ParaView from turning numbers such as -13 into --13.

--ct is a folder of DICOM files or a volume in Hounsfield units (.vti, .mha); --hole a point in the hole and a radius
around it, mm: what lies in this cylinder along the view is replaced. Without --ct it is the Skull Phantom. Where the
cylinder has sound bone, as in a CT without a hole, the result is compared with it.

Files: filled.vti (the filled depth map), plate.3mf and plate.stl (to print), model.stl (the bone around the hole),
mould.igs and mould.stl (to press a plate of 0.7 mm), mould.nc (G-code). Each can be traced to the CT by its header or
the .json beside it. Pictures: 0-ct.png to 7-left-over.png. At the end all files are read again and checked; when
one is wrong the names of all that could be made from begin with WRONG-.
"""
import argparse
import math
import os
import re

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from lacuna import pictures, views
from lacuna.data import open_volume
from lacuna.errors import PipelineError, raising
from lacuna.solids import save_solid
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import mutable, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData, vtkStaticCellLocator, vtkStaticPointLocator
from vtkmodules.vtkFiltersCore import vtkFeatureEdges
from vtkmodules.vtkIOGeometry import vtkSTLReader

SHEET = 0.7  # mm, the titanium that is pressed
TOOL = 4.0  # mm, radius of the ball end
FINER = 4  # times: the fitted surface for the checks
MARKED, SUPPORT = (0.80, 0.25, 0.20), (0.55, 0.70, 0.50)  # colours of the hole, and of the bone that carries the fit
MADE = ("plate.3mf", "plate.stl", "model.stl", "mould.igs", "mould.stl", "mould.nc")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", default=".")
    parser.add_argument("--ct")
    parser.add_argument("--hole", type=float, nargs=4, metavar=("X", "Y", "Z", "R"))
    parser.add_argument("--view", type=float, nargs=3, default=[0, 0, -1], metavar=("X", "Y", "Z"))
    options = parser.parse_args()
    if bool(options.ct) != bool(options.hole):
        parser.error("--ct and --hole belong together")
    return options


def field(data, name):
    """A field data array: one number, or all of them."""
    values = vtk_to_numpy(data.GetFieldData().GetArray(name)).ravel()
    return values[0] if values.size == 1 else values


# ---------------------------------------------------------------------------- from the CT to what is made
def open_ct(options):
    """The CT, a point in the hole, the radius around it and the direction to look along."""
    if not options.ct:
        ct = SkullPhantom()
        direction = np.array(ct.DefectDirection) / np.linalg.norm(ct.DefectDirection)
        skull = ct.GetClientSideObject()
        on_bone = np.array(ct.Center) + direction * skull.IntersectOuterSurface(ct.Center, direction)
        return ct, on_bone, 1.25 * ct.DefectRadius, -direction
    return open_volume(options.ct), np.array(options.hole[:3]), options.hole[3], np.array(options.view)


def fill(ct, hole, radius, view):
    """Depth map of the bone, and the same with the hole filled."""
    depth = BSplineIsoRayCaster(Input=ct, IsoValues=[500], ViewDirection=view, ViewUp=up(view),
                                Interpolation="InterpolatingBSpline", ComputeThickness=1)
    filled = RBFHoleFiller(Input=depth, Kernel="Cubic", NodeSpacing=2, SupportMargin=20, SupportStepMargin=3,
                           CutoffWavelength=10, OutputMargin=10)
    filled.DefectRegion = "Cylinder"
    filled.DefectRegion.Center = hole
    filled.DefectRegion.Axis = view
    filled.DefectRegion.Radius = radius
    return depth, filled


def up(view):
    """Superior is up; seen from above or below, anterior is (LPS: -y)."""
    return [0, -1, 0] if abs(view[2]) > 0.7 * np.linalg.norm(view) else [0, 0, 1]


def write(folder, filled, plate, model, mould, path):
    def name(file):
        return os.path.join(folder, file)

    SaveData(name("filled.vti"), proxy=filled, DataMode="Binary")
    save_solid(name("plate.3mf"), plate)
    save_solid(name("plate.stl"), plate)
    save_solid(name("model.stl"), model)
    SaveData(name("mould.igs"), proxy=mould)
    save_solid(name("mould.stl"), ExtractSurface(Input=mould))
    SaveData(name("mould.nc"), proxy=path)


# ---------------------------------------------------------------------------- checks of the files
def read_stl(name):
    reader = vtkSTLReader()
    reader.SetFileName(name)
    reader.Update()
    return reader.GetOutput()


def distances(points, surface):
    """mm from points to a surface of triangles."""
    locator = vtkStaticCellLocator()
    locator.SetDataSet(surface)
    locator.BuildLocator()
    closest, cell, part, square = [0.0] * 3, mutable(0), mutable(0), mutable(0.0)
    result = []
    for point in points:
        locator.FindClosestPoint(point, closest, cell, part, square)
        result.append(square.get() ** 0.5)
    return np.array(result)


def depths_behind(image, points):
    """mm that points lie behind the fitted surface of a map, along the view."""
    to_world = np.array(field(image, "ImageToWorld")).reshape(4, 4)
    fitted = fine_depths(image)
    column, row, depth = ((points - to_world[:3, 3]) @ np.linalg.inv(to_world[:3, :3]).T).T
    column, row = FINER * (column - image.GetExtent()[0]), FINER * (row - image.GetExtent()[2])
    i, j = np.floor(column).astype(int), np.floor(row).astype(int)
    x, y = column - i, row - j
    return depth - ((1 - x) * (1 - y) * fitted[j, i] + x * (1 - y) * fitted[j, i + 1]
                    + (1 - x) * y * fitted[j + 1, i] + x * y * fitted[j + 1, i + 1])


def is_closed(surface):
    edges = vtkFeatureEdges()
    edges.SetInputData(surface)
    edges.FeatureEdgesOff()
    edges.ColoringOff()
    edges.Update()
    return edges.GetOutput().GetNumberOfCells() == 0


def finer(rows):
    """FINER - 1 rows between two: by the cubic polynomial through four, straight where one of the four is missing."""
    result = np.full((FINER * (len(rows) - 1) + 1,) + rows.shape[1:], np.nan)
    result[::FINER] = rows
    beyond = np.full((1,) + rows.shape[1:], np.nan)
    a, b, c, d = beyond, rows[:-1], rows[1:], beyond
    a, d = np.concatenate([a, rows[:-2]]), np.concatenate([rows[2:], d])
    for k in range(1, FINER):
        t = k / FINER
        cubic = (t * (1 - t) * ((t - 2) * a - (t + 1) * d) / 6
                 + (t + 1) * (2 - t) * ((1 - t) * b + t * c) / 2)
        result[k::FINER] = np.where(np.isfinite(cubic), cubic, (1 - t) * b + t * c)
    return result


def fine_depths(image):
    """Fitted FINER times as fine: flat triangles between its pixels would lie up to 0.1 mm off the smooth surface where
    that is strongly curved."""
    fitted = vtk_to_numpy(image.GetPointData().GetArray("Fitted")).reshape(image.GetDimensions()[1::-1])
    return finer(finer(fitted).T).T


def gap_beside(image):
    """mm of depth between the fitted surface and what is measured right beside the filled pixels; infinite if nothing
    is: then the hole, or what is seen through it, goes on beyond what was filled."""
    filled, depth, fitted = (vtk_to_numpy(image.GetPointData().GetArray(name)).reshape(image.GetDimensions()[1::-1])
                             for name in ("FilledMask", "Depth", "Fitted"))
    inside = np.pad(filled > 0, 1)
    beside = (inside[:-2, 1:-1] | inside[2:, 1:-1] | inside[1:-1, :-2] | inside[1:-1, 2:]) & ~inside[1:-1, 1:-1]
    gaps = np.abs(depth - fitted)[beside]
    return gaps.max() if np.isfinite(gaps).all() else math.inf


def fitted_surface(image):
    """The fitted surface as triangles in patient coordinates, straight from the map's numbers."""
    depth = fine_depths(image)
    row, column = np.indices(depth.shape)
    places = np.stack([image.GetExtent()[0] + column / FINER, image.GetExtent()[2] + row / FINER, depth], 2)
    to_world = np.array(field(image, "ImageToWorld")).reshape(4, 4)
    known = np.isfinite(depth)
    number = np.where(known, np.cumsum(known).reshape(known.shape) - 1, -1)
    corners = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    triangles = np.concatenate([np.stack([corners[k] for k in order], 2).reshape(-1, 3)
                                for order in ((0, 1, 2), (0, 2, 3))])
    points, cells, surface = vtkPoints(), vtkCellArray(), vtkPolyData()
    points.SetData(numpy_to_vtk(places[known] @ to_world[:3, :3].T + to_world[:3, 3], deep=True))
    cells.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(triangles[(triangles >= 0).all(1)]).ravel(), deep=True))
    surface.SetPoints(points)
    surface.SetPolys(cells)
    return surface


def read_program(name):
    """The places of the tool's tip in a program of the G-Code Writer."""
    place, places = {"X": math.nan, "Y": math.nan, "Z": math.nan}, []
    with open(name, encoding="ascii") as program:
        for line in program:
            words = re.findall(r"([A-Z])(-?[\d.]+)", re.sub(r"\(.*?\)", "", line))
            if any(letter in place for letter, _ in words):
                place.update((letter, float(value)) for letter, value in words if letter in place)
                places.append(list(place.values()))
    places = np.array(places)
    return places[np.isfinite(places).all(axis=1)]  # those of which all coordinates are known


def check(folder, filled, mould, path):
    """What a person should know of the files before anything is made of them. Raises when something is wrong."""
    def report(what, value, good):
        print(f"{what:70s} {value:>16s} {'ok' if good else 'WRONG'}", flush=True)
        if not good:
            raise AssertionError(what)

    image = servermanager.Fetch(filled)
    surface = fitted_surface(image)
    plate = read_stl(os.path.join(folder, "plate.stl"))
    model = read_stl(os.path.join(folder, "model.stl"))
    gap = gap_beside(image)
    report("bone beside the filled hole lies at the fitted surface, mm at most", f"{gap:.2f}", gap < 3)
    report("plate and model are closed", "", is_closed(plate) and is_closed(model))

    # the plate's outer face is the fitted surface: of the points read from the file many lie on it, none is above it
    points = vtk_to_numpy(plate.GetPoints().GetData()).astype(float)
    away = distances(points, surface)
    report("plate's points within 0.02 mm of the fitted surface, as they should",
           f"{100 * np.mean(away < 0.02):.0f} %", np.mean(away < 0.02) > 0.2)
    deepest = away.max()
    report("plate's point farthest from it, mm (thickness: 3)", f"{deepest:.3f}", 2.9 < deepest < 3.05)
    inwards = depths_behind(image, points)
    report("plate lies behind the fitted surface as seen, none of it before: mm", f"{inwards.min():.3f}",
           inwards.min() > -0.02)

    # the mould goes back to the patient by PressToPatient: the face of a plate of 0.7 mm on the fitted surface
    grid = servermanager.Fetch(mould)
    to_patient = np.array(field(grid, "PressToPatient")).reshape(4, 4)
    report("press to patient is a rotation: determinant", f"{np.linalg.det(to_patient[:3, :3]):.9f}",
           abs(np.linalg.det(to_patient[:3, :3]) - 1) < 1e-9)
    press = vtk_to_numpy(read_stl(os.path.join(folder, "mould.stl")).GetPoints().GetData()).astype(float)
    own = vtk_to_numpy(grid.GetPoints().GetData())
    true_surface = own[vtk_to_numpy(grid.GetPointData().GetArray("PressRegion")) == 2]
    near = press[np.isin(np.round(press[:, 0] * 1e4) * 1e7 + np.round(press[:, 1] * 1e4),
                         np.round(true_surface[:, 0] * 1e4) * 1e7 + np.round(true_surface[:, 1] * 1e4))]
    offset = distances(near @ to_patient[:3, :3].T + to_patient[:3, 3], surface)
    report("mould.stl back in the patient: mm from the fitted surface",
           f"{offset.min():.3f} .. {offset.max():.3f}", np.abs(offset - SHEET).max() < 0.02)

    program = read_program(os.path.join(folder, "mould.nc"))
    tool_path = servermanager.Fetch(path)
    planned = vtk_to_numpy(tool_path.GetPoints().GetData())
    report("program's lowest place of the tool, mm", f"{program[:, 2].min():.3f}",
           abs(program[:, 2].min() - planned[:, 2].min()) < 2e-3)
    report("program's places are all on the path, mm at most beside it", f"{beside(program, planned):.4f}",
           beside(program, planned) < 2e-3)
    report("tool within the part, mm at most", f"{field(tool_path, 'LargestGouge'):.4f}",
           field(tool_path, "LargestGouge") < 1e-3)


def beside(program, planned):
    """mm from the places of a program to the nearest of a path."""
    points = vtkPoints()
    points.SetData(numpy_to_vtk(planned.astype(float), deep=True))
    cloud = vtkPolyData()
    cloud.SetPoints(points)
    locator = vtkStaticPointLocator()
    locator.SetDataSet(cloud)
    locator.BuildLocator()
    nearest = planned[[locator.FindClosestPoint(p) for p in program]]
    return np.linalg.norm(nearest - program, axis=1).max()


def set_aside(folder):
    """Nothing shall be made of files that are wrong: their names say so."""
    for name in MADE:
        for file in (name, name + ".json"):
            if os.path.exists(os.path.join(folder, file)):
                os.replace(os.path.join(folder, file), os.path.join(folder, "WRONG-" + file))


# ---------------------------------------------------------------------------- pictures
def parts(filled):
    """Bone and filled part of the map's surface."""
    surface = DepthMapSurface(Input=filled, MaximumAngle=80)  # steep sides are no gaps
    mask = ["POINTS", "FilledMask"]
    bone = Threshold(Input=surface, Scalars=mask, ThresholdMethod="Below Lower Threshold", LowerThreshold=0.5,
                     AllScalars=0)
    part = Threshold(Input=surface, Scalars=mask, ThresholdMethod="Above Upper Threshold", UpperThreshold=0.5)
    return bone, part


def marked(depth, filled):
    """The bone as it was measured, what was marked in it as the hole, and the bone that carries the fit."""
    measured, image = servermanager.Fetch(depth), servermanager.Fetch(filled)
    small, large = (np.array(each.GetExtent()) for each in (measured, image))
    first, size = small[:4:2] - large[:4:2], small[1:4:2] - small[:4:2] + 1
    parts = np.zeros(size[::-1])
    for value, name, shown in ((1, "FilledMask", (1,)), (2, "SupportMask", (1, 3))):
        mask = vtk_to_numpy(image.GetPointData().GetArray(name)).reshape(image.GetDimensions()[1::-1])
        parts[np.isin(mask[first[1]:first[1] + size[1], first[0]:first[0] + size[0]], shown)] = value
    array = numpy_to_vtk(parts.ravel(), deep=True)
    array.SetName("Part")
    measured.GetPointData().AddArray(array)
    source = TrivialProducer()
    source.GetClientSideObject().SetOutput(measured)
    surface = DepthMapSurface(Input=source, MaximumAngle=80)
    return [Threshold(Input=surface, Scalars=["POINTS", "Part"], LowerThreshold=value - 0.5, UpperThreshold=value + 0.5,
                      AllScalars=0) for value in (0, 1, 2)]


def picture(name, shown, direction, upwards, letters, scale_bar=50):
    """shown(view) puts things into a view, which is then looked at and saved."""
    view = pictures.new_view((900, 680))
    shown(view)
    pictures.look(view, direction, upwards, 1.15)
    if letters:
        views.show_orientation(view, force=True)  # the plate is lifted in one
    pictures.add_scale_bar(view, scale_bar, aside=letters)
    pictures.save(view, name)
    Delete(view)


def make_pictures(folder, ct, hole, view, depth, filled, plate, model, mould, path, has_truth):
    def name(file):
        return os.path.join(folder, file)

    image = servermanager.Fetch(filled)
    letters = views.in_patient_coordinates(image)  # only where the data say how the patient lay
    bone, part = parts(filled)
    view, upwards = np.array(view) / np.linalg.norm(view), np.array(up(view))
    right = np.cross(view, upwards)
    right /= np.linalg.norm(right)
    oblique = view + 0.9 * right + 0.45 * np.cross(right, view)

    def show_ct(v):
        cut = Slice(Input=ct, SliceType="Plane")
        cut.SliceType.Origin, cut.SliceType.Normal = list(hole), list(across)
        cut.UpdatePipeline()
        display = Show(cut, v)
        display.Ambient, display.Diffuse, display.Specular = 1, 0, 0
        pictures.color_by(display, v, cut.PointData[0].Name, "Hounsfield units", (-200, 1800), "Grayscale")
    across = np.cross(view, right)
    picture(name("0-ct.png"), show_ct, across, -view, letters)

    picture(name("1-hole.png"), lambda v: pictures.show_surface(bone, v, pictures.BONE), view, upwards, letters)

    def show_marked(v):
        for piece, color in zip(marked(depth, filled), (pictures.BONE, MARKED, SUPPORT)):
            piece.UpdatePipeline()
            if piece.GetDataInformation().GetNumberOfPoints() > 0:  # a hole that is open all over has no marked bone
                pictures.show_surface(piece, v, color)
    picture(name("2-marked.png"), show_marked, view, upwards, letters)

    def show_filled(v):
        pictures.show_surface(bone, v, pictures.BONE)
        display = pictures.show_surface(part, v, pictures.METAL)
        if has_truth:
            pictures.color_by(display, v, "Deviation", "fitted minus true bone, mm", (-1, 1))
    picture(name("2-filled.png"), show_filled, view, upwards, letters)

    def show_plate(v):
        pictures.show_surface(bone, v, pictures.BONE)
        pictures.show_surface(plate, v, pictures.METAL)
    picture(name("3-plate.png"), show_plate, oblique, upwards, letters)

    lifted = Transform(Input=plate)
    lifted.Transform.Translate = -22 * view

    def show_model(v):
        pictures.show_surface(model, v, pictures.BONE)
        pictures.show_surface(lifted, v, pictures.METAL)
    picture(name("4-model.png"), show_model, oblique, upwards, letters, 20)

    def show_mould(v):
        display = pictures.show_surface(mould, v, pictures.METAL)
        pictures.color_by(display, v, "WallAngle", "wall, degrees from the press plane", (0, 60),
                          "Blue Orange (divergent)")
    above = np.array([0.25, 0.75, -1])
    picture(name("5-mould.png"), show_mould, above, [0, 0, 1], False)

    lines = Threshold(Input=path, Scalars=["POINTS", "Motion"], ThresholdMethod="Above Upper Threshold",
                      UpperThreshold=0.5)
    tubes = Tube(Input=ExtractSurface(Input=lines), Radius=0.2)

    def show_path(v):
        pictures.show_surface(mould, v, pictures.METAL)
        pictures.color_by(pictures.show_surface(tubes, v, (0.8, 0.3, 0.1)), v, "Time", "time, s",
                          (0, field(servermanager.Fetch(path), "MachiningTime")), "Turbo")
    picture(name("6-path.png"), show_path, above, [0, 0, 1], False)

    left_over = OutputPort(path, 1)

    def show_left_over(v):
        display = pictures.show_surface(left_over, v, pictures.METAL)
        pictures.color_by(display, v, "LeftOver", "left over, mm", (0, 0.08), "Viridis")
    picture(name("7-left-over.png"), show_left_over, [0, 0, -1], [0, 1, 0], False)


def main():
    options = arguments()
    os.makedirs(options.output, exist_ok=True)
    ct, hole, radius, view = open_ct(options)
    depth, filled = fill(ct, hole, radius, view)
    with raising():
        filled.UpdatePipeline()
    image = servermanager.Fetch(filled)
    if not vtk_to_numpy(image.GetPointData().GetArray("FilledMask")).any():
        raise PipelineError(f"nothing is filled: the cylinder around {hole} along {view} marks no bone of the map and no "
                            "hole in it; --hole and --view are in mm and directions of the CT's coordinates")
    print(f"hole {field(image, 'DefectArea'):.0f} mm2, {field(image, 'NodeCount'):.0f} nodes")
    has_truth = bool(options.ct)
    if has_truth:
        inside = vtk_to_numpy(image.GetPointData().GetArray("FilledMask")) > 0
        error = vtk_to_numpy(image.GetPointData().GetArray("Deviation"))[inside]
        error = error[np.isfinite(error)]
        has_truth = error.size > 0.99 * inside.sum() and np.abs(error).max() < 5  # else it is a hole indeed
        if has_truth:
            print(f"against the bone that was there: {np.abs(error).max():.2f} mm at most, "
                  f"{np.sqrt((error ** 2).mean()):.2f} mm RMS")

    plate = ImplantPlate(Input=filled, Thickness=3, EdgeClearance=0.5, DrainageSpacing=10)
    model = DefectModel(Input=filled, Margin=12)
    mould = PressOrientation(Input=filled, Mould="Female", Seating="Onlay", PlateThickness=SHEET, FlangeWidth=20,
                             PlaneMethod="LeastSquares")
    path = MillingToolPath(Input=mould, ToolRadius=TOOL, StepOver=1, RoughingStep=2, SpindleSpeed=8000)
    write(options.output, filled, plate, model, mould, path)

    solid, grid, tool = (servermanager.Fetch(proxy) for proxy in (plate, mould, path))
    print(f"plate: {field(solid, 'Volume') / 1000:.1f} ml, {field(solid, 'Mass'):.1f} g, thinnest "
          f"{field(solid, 'MinimumThickness'):.3f} mm, {field(solid, 'DrainageHoleCount'):.0f} drainage holes")
    print(f"mould: {field(grid, 'Depth'):.1f} mm deep, walls up to {field(grid, 'DraftAngle'):.0f} degrees, block "
          + " x ".join(f"{x:.0f}" for x in field(grid, "BlockSize")) + " mm")
    print(f"milling: {field(tool, 'PathLength')[0] / 1000:.1f} m of cuts, {field(tool, 'MachiningTime') / 60:.0f} min")
    try:
        check(options.output, filled, mould, path)
    except AssertionError:
        set_aside(options.output)
        raise
    make_pictures(options.output, ct, hole, view, depth, filled, plate, model, mould, path, has_truth)


if __name__ == "__main__":
    main()
