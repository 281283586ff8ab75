# SPDX-License-Identifier: BSD-3-Clause
"""Calibrations of a simulated probe by three wires, a wall and a point, with pictures of their residuals and of the error to expect.

    pvpython probe_calibration.py [folder for the pictures, default: .]

three-wires.png, single-wall.png, point-target.png: slices in the bath, and what was picked, on the calibrated phantom.
residuals.png: for each wire what its two equations are off by, and the expected error all over the image: above a good scan, below
one in which the probe was hardly turned, with the advice of both.
"""
import os
import sys

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
import scans
from lacuna import pictures
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

COLORS = {"X": (200, 60, 40), "Y": (40, 140, 60), "Z": (40, 90, 200)}
GREY = (150, 155, 160)
VIRIDIS = np.array([(68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37)], float)


def scan_wires(random, tilt, outliers=2, count=30):
    """Slices, and picks with errors of up to 1 mm, some slipped. tilt: degrees by which the probe is turned each way."""
    images, poses, picks = [], [], {"Slice": [], "Column": [], "Row": [], "Wire": []}
    for i in range(count):
        wire = i % 3
        across = (wire + 1) % 3, (wire + 2) % 3
        place, axis = np.zeros(3), np.zeros(3)
        place[wire] = random.uniform(-60, 60)
        axis[list(across)] = random.normal(size=2)
        turn = scans.rotation(axis, tilt * np.sqrt(random.random())) @ np.eye(3)[:, [*across, wire]]  # the normal along the wire, tilted
        turn = turn @ scans.rotation([0, 0, 1], 4 * random.uniform(-tilt, tilt))
        pixel = random.uniform([15, 15], [scans.WIDTH - 15, scans.HEIGHT - 15])
        truth = scans.pose(turn, place - turn[:, :2] @ (scans.SPACING * pixel))
        poses.append(scans.probe_to_tracker(truth))
        images.append(scans.wire_picture(truth, random))
        error = random.uniform(-1, 1, 2) + (np.array([14, -9]) if i >= count - outliers else 0)
        for name, value in zip(picks, (i, *(pixel + error / scans.SPACING), "XYZ"[wire])):
            picks[name].append(value)
    return scans.slices(images, poses), scans.table(picks)


def scan_floor(random, count=40):
    """Slices in which the floor is to be found."""
    images, poses = [], []
    for _ in range(count):
        truth = scans.pose(scans.looking_down(random, 45), [*random.uniform(-40, 40, 2), 0])
        depth = random.uniform(0.35, 0.75) * scans.HEIGHT * scans.SPACING
        truth[2, 3] = -(truth[2, :2] @ [0.5 * scans.WIDTH * scans.SPACING, depth])
        poses.append(scans.probe_to_tracker(truth))
        images.append(scans.floor_picture(truth, random))
    return scans.slices(images, poses)


def scan_point(random, count=24):
    """Slices through a ball, and picks with errors of up to 0.5 mm."""
    images, poses, picks = [], [], {"Slice": [], "Column": [], "Row": []}
    for i in range(count):
        turn = scans.looking_down(random, 60)
        pixel = random.uniform([20, 20], [scans.WIDTH - 20, scans.HEIGHT - 20])
        truth = scans.pose(turn, -turn[:, :2] @ (scans.SPACING * pixel))
        poses.append(scans.probe_to_tracker(truth))
        images.append(scans.point_picture(truth, random))
        for name, value in zip(picks, (i, *(pixel + random.uniform(-0.5, 0.5, 2) / scans.SPACING))):
            picks[name].append(value)
    return scans.slices(images, poses), scans.table(picks)


def to_colors(values, high):
    """From violet (0) to yellow (high)."""
    x = np.clip(values / high, 0, 1)
    return np.stack([np.interp(x, np.linspace(0, 1, 5), VIRIDIS[:, c]) for c in range(3)], axis=-1).astype(np.uint8)


def residual_row(calibration, title, limit, high):
    """Pictures of the equations of each wire and of the error to expect."""
    table, error_map = scans.fetch(calibration, 1), scans.fetch(calibration, 3)
    column = {name: vtk_to_numpy(table.GetColumnByName(name)) for name in ("PhantomX", "PhantomY", "PhantomZ", "Used")}
    target = np.array([table.GetColumnByName("Target").GetValue(i) for i in range(table.GetNumberOfRows())])
    panels = []
    for wire, color in COLORS.items():
        first, second = (axis for axis in "XYZ" if axis != wire)
        a, b = (column["Phantom" + axis] for axis in (first, second))
        used, left = ((target == wire) & (column["Used"] == flag) for flag in (1, 0))
        circle = np.linspace(0, 2 * np.pi, 100)
        rms = scans.figure(table, "CalibrationRms") * np.sqrt(2)
        curves = [("RMS", rms * np.cos(circle), rms * np.sin(circle), GREY, "line"), ("used", a[used], b[used], color, "points")]
        if left.any():
            edge = 0.95 * limit / np.maximum(np.abs(a[left]), np.abs(b[left]))  # far beyond the frame
            curves.append(("left out", a[left] * np.minimum(edge, 1), b[left] * np.minimum(edge, 1), (20, 20, 20), "points"))
        titles = f"{first.lower()} (mm)", f"{second.lower()} (mm)"
        panel = pictures.chart_pixels(curves, titles, (310, 310), ((-limit, limit), (-limit, limit)), legend=False)
        panels.append((f"wire {wire}: {used.sum()} picks" + (f", {left.sum()} left out (black)" if left.any() else ""), panel))
    columns, rows, _ = error_map.GetDimensions()
    values = vtk_to_numpy(error_map.GetPointData().GetArray("ExpectedError")).reshape(rows, columns)
    size = 310 * scans.HEIGHT // scans.WIDTH
    along = [np.linspace(0, 1, n) for n in (columns, rows)]
    wide = np.array([np.interp(np.linspace(0, 1, 310), along[0], row) for row in values])
    spread = np.array([np.interp(np.linspace(0, 1, size), along[1], column_) for column_ in wide.T]).T
    panels.append((f"expected error: {values.min():.2f} to {values.max():.2f} mm", to_colors(spread, high)))
    panels.append(("", pictures.color_bar(lambda v: to_colors(v, high), 0, high, "mm", size, sign="")))
    row = pictures.side_by_side(panels, gap=14)
    title += f": RMS error {scans.figure(table, 'CalibrationRms'):.2f} mm of {2 * int(column['Used'].sum())} equations"
    lines = [title, *(f"Advice: {sentence}" for sentence in scans.advice(table) or ["none, all is well"])]
    lines = [part for line in lines for part in wrap(line, 165)]
    labels = [np.full((30 if i == 0 else 22, row.shape[1], 3), 255, np.uint8) for i in range(len(lines))]
    for i, line in enumerate(lines):
        pictures.put_pixels(labels[i], pictures.text_pixels(line, 17 if i == 0 else 14), 6, 8)
    return np.concatenate([labels[0], row, *labels[1:]])


def wrap(line, length):
    words, parts = line.split(), [""]
    for word in words:
        if len(parts[-1]) + len(word) > length:
            parts.append("   ")
        parts[-1] += (" " if parts[-1].strip() else "") + word
    return parts


def show_bath(calibration, chosen, phantom, name):
    """Some slices where the calibration puts them in the phantom's coordinates, which are known here, with all picks; and one as it is."""
    view = pictures.new_view((640, 520))
    view.OrientationAxesVisibility = 0
    slices = OutputPort(calibration, 0)
    to_phantom = np.linalg.inv(scans.PHANTOM_TO_TRACKER)
    for index in chosen:
        one = ExtractSubset(Input=slices, VOI=[0, scans.WIDTH - 1, 0, scans.HEIGHT - 1, index, index])
        display = Show(moved(SlicePlanes(Input=one), to_phantom), view)
        display.Ambient, display.Diffuse, display.Specular, display.Opacity = 1, 0, 0, 0.8
        ColorBy(display, ("POINTS", "Intensity"))
        table = GetColorTransferFunction("Intensity", display, separate=True)
        table.ApplyPreset("Grayscale", True)
        table.RescaleTransferFunction(-60, 130)
        display.LookupTable = table
        display.SetScalarBarVisibility(view, False)
    phantom(view)
    picks = scans.fetch(calibration, 1)
    data = scans.fetch(calibration)
    poses = vtk_to_numpy(data.GetFieldData().GetArray("ImageToReference")).reshape(-1, 4, 4)
    slice_, column, row, used = (vtk_to_numpy(picks.GetColumnByName(key)) for key in ("Slice", "Column", "Row", "Used"))
    places = [to_phantom @ poses[s] @ [c, r, 0, 1] for s, c, r, u in zip(slice_, column, row, used) if u]
    balls = Glyph(Input=scans.points(np.array(places)[:, :3]), GlyphType="Sphere", ScaleFactor=3.2, GlyphMode="All Points",
                  ScaleArray=["POINTS", "No scale array"])
    pictures.show_surface(balls, view, (0.95, 0.72, 0.1))
    pictures.look(view, (-0.5, 0.75, -0.45), (0, 0, 1), 1.55 if phantom is not floor else 1.25)
    pictures.add_scale_bar(view, 50)
    pictures.save(view, name)
    # one of the slices upright, its picks in rings
    grey = vtk_to_numpy(data.GetPointData().GetScalars()).reshape(-1, scans.HEIGHT, scans.WIDTH)[chosen[-1]]
    scan = np.clip(1.7 * grey.astype(float), 0, 255).astype(np.uint8)[..., None].repeat(3, axis=2)
    line, across = np.mgrid[:scans.HEIGHT, :scans.WIDTH]
    for c, r in zip(column[slice_ == chosen[-1]], row[slice_ == chosen[-1]]):
        distance = np.hypot(line - r, across - c)
        scan[(distance > 11) & (distance < 13.5)] = (242, 184, 26)
    scan = scan.repeat(2, axis=0).repeat(2, axis=1)
    bath = pictures.read_pixels(name)
    scan = np.pad(scan, (((bath.shape[0] - scan.shape[0]) // 2, (bath.shape[0] - scan.shape[0] + 1) // 2), (0, 0), (0, 0)), constant_values=255)
    titles = f"{len(chosen)} of {data.GetDimensions()[2]} slices, all picks", "one of the slices"
    pictures.write_pixels(name, pictures.side_by_side(list(zip(titles, (bath, scan))), gap=16))


def three_wires(view):
    for wire, color in enumerate(COLORS.values()):
        end = np.zeros(3)
        end[wire] = 80
        tube = Tube(Input=Line(Point1=list(-end), Point2=list(end)), Radius=0.9)
        pictures.show_surface(tube, view, tuple(c / 255 for c in color))


def floor(view):
    sheet = Plane(Origin=[-150, -150, -0.4], Point1=[150, -150, -0.4], Point2=[-150, 150, -0.4])
    pictures.show_surface(sheet, view, (0.70, 0.80, 0.88)).Opacity = 0.8


def ball(view):
    pictures.show_surface(Cylinder(Center=[0, -40, 0], Radius=1, Height=76), view, pictures.METAL)


def moved(proxy, matrix):
    """Moved by a rigid matrix. ParaView's Transform filter wants angles: it turns about z, then x, then y."""
    r = matrix[:3, :3]
    filter_ = Transform(Input=proxy)
    filter_.Transform.Rotate = list(np.degrees([np.arcsin(r[2, 1]), np.arctan2(-r[2, 0], r[2, 2]), np.arctan2(-r[0, 1], r[1, 1])]))
    filter_.Transform.Translate = list(matrix[:3, 3])
    return filter_


def report(name, calibration):
    """Prints what was found, and checks it against the truth."""
    found = scans.fetch(calibration)
    matrix = vtk_to_numpy(found.GetFieldData().GetArray("ImageToProbe")).reshape(4, 4)
    error, expected = scans.corner_error(matrix), scans.figure(found, "ExpectedError")
    print(f"{name}: RMS {scans.figure(found, 'CalibrationRms'):.2f} mm, corners off by {error:.2f} mm, expected {expected:.2f} mm", flush=True)
    assert error < 2.5 * expected, (error, expected)
    return expected, scans.advice(found)


def main(folder):
    os.makedirs(folder, exist_ok=True)
    random = np.random.default_rng(4)
    # three wires: a good scan, and one that hardly turns the probe
    slices, picks = scan_wires(random, 55)
    good = ProbeCalibration(Input=slices, Picks=picks, PixelSpacing=scans.SPACING)
    expected, advice = report("three wires", good)
    assert expected < 1 and not advice
    used = vtk_to_numpy(scans.fetch(good, 1).GetColumnByName("Used"))
    assert list(np.flatnonzero(used == 0)) == [28, 29]
    slices, picks = scan_wires(random, 4, outliers=0)
    poor = ProbeCalibration(Input=slices, Picks=picks, PixelSpacing=scans.SPACING)
    expected, advice = report("hardly turned", poor)
    # the residuals are as small: they do not tell
    assert scans.figure(scans.fetch(poor), "CalibrationRms") < 0.7 and expected > 1 and any("turn the probe" in sentence for sentence in advice)
    rows = [residual_row(good, "Three wires, 10 picks of each, the probe turned by up to 55° each way", 2, 1),
            residual_row(poor, "The same, the probe turned by up to 4° only", 2, 6)]
    width = max(row.shape[1] for row in rows)
    rows = [np.pad(row, ((0, 12), (0, width - row.shape[1]), (0, 0)), constant_values=255) for row in rows]
    pictures.write_pixels(os.path.join(folder, "residuals.png"), np.concatenate(rows))
    # of each wire the slice furthest out
    picked = scans.fetch(good, 1)
    along = np.array([picked.GetValueByName(i, "Phantom" + "XYZ"[i % 3]).ToDouble() for i in range(28)])
    outer = [wire + 3 * int(np.argmax(np.abs(along[wire::3]))) for wire in range(3)]
    show_bath(good, outer, three_wires, os.path.join(folder, "three-wires.png"))

    wall = ProbeCalibration(Input=scan_floor(random), Method="SingleWall", PixelSpacing=scans.SPACING)
    expected, advice = report("single wall", wall)
    assert expected < 0.7 and not advice
    show_bath(wall, [3, 9, 20], floor, os.path.join(folder, "single-wall.png"))

    slices, picks = scan_point(random)
    point = ProbeCalibration(Input=slices, Picks=picks, Method="PointTarget", PixelSpacing=scans.SPACING)
    expected, advice = report("point", point)
    assert expected < 0.7 and not advice
    show_bath(point, [2, 5], ball, os.path.join(folder, "point-target.png"))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else ".")
