# SPDX-License-Identifier: BSD-3-Clause
"""From a DICOM folder to the STL of plate, model and mould: every straight edge of the letter F is where it was in the
patient, in the plane of its face as along the normal, for scans that are turned, tilted and feet first.

The pit's floor marks the defect, pixel by pixel as the scan shows it; pixels border on each other at the letter's edges.
Grown by GROWN so that nothing is left of the pit's rim, its edges are those of the bars, GROWN further out.

Each face once, and each scan; with "soak" as its second argument all faces of the tilted scan.
"""
import os
import shutil
import subprocess
import sys

import lacuna_test
import numpy as np
from lacuna.errors import raising
from lacuna.solids import save_solid
from letter_block import BARS, HALF, face_axes, letter_distance, with_mask
from paraview import servermanager
from paraview.simple import Delete, ExtractSurface, LoadPlugin
from vtkmodules.numpy_interface import dataset_adapter as dsa

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
folder = lacuna_test.output("solid chain")
shutil.rmtree(folder, ignore_errors=True)
subprocess.run([sys.argv[1], folder], check=True)

MICROMETRE = 1e-3
PIXEL, PIXELS = 0.25, 152
GROWN = 4.0
# The outline of the grown letter: coordinate (0 a, 1 b), where the edge lies, from and to along it, the way out.
# Of the parts within CORNER of its ends nothing is said: there the outline is rounded.
LEFT, RIGHT, LOW, HIGH = BARS[:, 0] - GROWN, BARS[:, 1] + GROWN, BARS[:, 2] - GROWN, BARS[:, 3] + GROWN
EDGES = [(0, LEFT[0], LOW[0], HIGH[0], -1), (1, HIGH[0], LEFT[0], RIGHT[1], 1), (0, RIGHT[1], LOW[1], HIGH[1], 1),
         (0, RIGHT[2], LOW[2], LOW[1], 1), (1, LOW[2], RIGHT[0], RIGHT[2], -1), (0, RIGHT[0], LOW[0], LOW[2], 1),
         (1, LOW[0], LEFT[0], RIGHT[0], -1)]
CORNER = 3.5
THICKNESS, CLEARANCE = 2.0, 0.5  # mm, of the plate
FLOOR, BASE = 7.0, 4.0           # of the model
SHEET, MARGIN, FLANGE = 0.7, 1.0, 2.0  # of the mould


def read_stl(path):
    """Corners of all triangles, three rows each, straight from the bytes."""
    with open(path, "rb") as file:
        data = file.read()
    count = int.from_bytes(data[80:84], "little")
    assert len(data) == 84 + 50 * count, path
    records = np.frombuffer(data, np.dtype([("numbers", "<f4", 12), ("attribute", "<u2")]), count, 84)
    return records["numbers"][:, 3:].reshape(-1, 3).astype(float)


def mark(depth):
    """The depth map with the array Defect: the letter as the scan shows it, grown by GROWN."""
    with raising():
        depth.UpdatePipeline()
    image = servermanager.Fetch(depth)
    z = np.asarray(dsa.WrapDataObject(image).PointData["Depth"]).reshape(PIXELS, PIXELS)
    pit = ~(z < np.nanmedian(z[:8]) + 3)  # half of its depth
    pit[:, :2] = pit[:2] = pit[:, -2:] = pit[-2:] = False
    for axis in (0, 1):
        grown = pit.copy()
        for step in range(1, round(GROWN / PIXEL) + 1):
            grown |= np.roll(pit, step, axis) | np.roll(pit, -step, axis)
        pit = grown
    return with_mask(image, "Defect", pit)


def walls(points, normal):
    """The corners of the triangles that stand upright on a face."""
    corners = points.reshape(-1, 3, 3)
    turned = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return corners[np.abs(turned @ normal) < 1e-3 * np.linalg.norm(turned, axis=1)].reshape(-1, 3)


def edges(a, b, corner):
    """For each edge that is long enough: how far outwards of it points at a, b lie, mm, of those beside its straight part."""
    for axis, place, first, last, out in EDGES:
        across, along = (a, b) if axis == 0 else (b, a)
        beside = (along > first + corner) & (along < last - corner)
        if last - first > 2 * corner:
            yield out * (across - place), beside


def off_edges(a, b, beyond):
    """mm, at most, that points of walls at a, b lie beside the edges of the letter, moved outwards by beyond."""
    worst = []
    for outwards, beside in edges(a, b, CORNER):
        near = beside & (np.abs(outwards - beyond) < 0.4)
        assert near.any(), "no wall"
        worst.append(np.abs(outwards - beyond)[near].max())
    assert len(worst) == len(EDGES)
    return max(worst)


def off_flange(a, b, fallen):
    """mm, at most, that the middle of the mould's flange lies beside where the letter's edges have it.

    fallen: 0 on the mould's face, 1 on the press plane; by the flange's symmetry a half in its middle.
    """
    middle, worst = MARGIN + FLANGE / 2, []
    for outwards, beside in edges(a, b, CORNER + FLANGE / 2):
        near = beside & (np.abs(outwards - middle) < FLANGE / 4)
        assert near.sum() > 20, "no flange"
        h = fallen[near] - 0.5
        odd = np.column_stack([np.ones(h.size), h, h ** 3, h ** 5])
        worst.append(abs(np.linalg.lstsq(odd, outwards[near] - middle, rcond=None)[0][0]))
    assert len(worst) == 4
    return max(worst)


def check(what, off):
    print(f"    {what}: {1000 * off:.3f} um", flush=True)
    assert off < MICROMETRE, (what, off)


def check_in_plane(what, off, a, b, *arguments):
    """off(a, b, ...) is small, and is not for mirror images."""
    check(what, off(a, b, *arguments))
    for mirrored in ((-a, b), (a, -b)):
        try:
            wrong = off(*mirrored, *arguments)
        except AssertionError:
            continue
        assert wrong > 0.1, f"{what}: the mirror image passes"


def saved(proxy):
    """save_solid's record, and the corners in the file."""
    path = lacuna_test.output("solid chain.stl")
    record = save_solid(path, proxy)
    return record, read_stl(path)


def check_plate(filled, along, up, normal):
    plate = ImplantPlate(Input=filled, Thickness=THICKNESS, EdgeClearance=CLEARANCE, EdgeShape="Square")
    _, points = saved(plate)
    height = points @ normal - HALF
    check("plate's faces", np.abs(np.where(height > -THICKNESS / 2, height, height + THICKNESS)).max())
    upright = walls(points, normal)
    check_in_plane("plate's edge", off_edges, upright @ along, upright @ up, -CLEARANCE)
    Delete(plate)


def check_model(filled, along, up, normal):
    model = DefectModel(Input=filled, Margin=3, DefectDepth=FLOOR, BaseThickness=BASE)
    _, points = saved(model)
    height = points @ normal - HALF
    check("model's bone, floor and base", np.abs(height[:, None] + [0, FLOOR, FLOOR + BASE]).min(axis=1).max())
    upright = walls(points, normal)
    check_in_plane("model's walls", off_edges, upright @ along, upright @ up, 0)
    Delete(model)


def check_mould(filled, along, up, normal):
    mould = PressOrientation(Input=filled, Mould="Female", ConvexSide="Outward", PlateThickness=SHEET,
                             PlateMargin=MARGIN, FlangeWidth=FLANGE, OutputSpacing=0.2)
    surface = ExtractSurface(Input=mould)
    record, points = saved(surface)
    back = np.array(record["measures"]["PressToPatient"]).reshape(4, 4)
    points = points @ back[:3, :3].T + back[:3, 3]
    a, b, height = points @ along, points @ up, points @ normal - HALF - SHEET
    check("mould's face", np.abs(height[letter_distance(a, b) < GROWN]).max())
    plane = back[:3, 3] @ normal - HALF - SHEET
    check_in_plane("mould's flange", off_flange, a, b, height / plane)
    for proxy in (surface, mould):
        Delete(proxy)


tilted = range(5) if "soak" in sys.argv else [2]
for name, faces in (("tilted", tilted), ("oblique", (0, 3)), ("feet first", (1, 4))):
    scan = CTSeriesReader(FileName=os.path.join(folder, name))
    for face in faces:
        along, up, normal = face_axes(face)
        print(f"{name}, face {face}", flush=True)
        depth = BSplineIsoRayCaster(Input=scan, IsoValues=[0], PixelSpacing=PIXEL, ViewDirection=list(-normal),
                                    ViewUp=list(up), FocalPoint=list(HALF * normal), ImageSize=[PIXELS, PIXELS])
        marked = mark(depth)
        filled = RBFHoleFiller(Input=marked, DefectArray="Defect", NodeSpacing=2)
        filled.DefectRegion = "None"
        with raising():
            filled.UpdatePipeline()
        for part in (check_plate, check_model, check_mould):
            part(filled, along, up, normal)
        for proxy in (filled, marked, depth):
            Delete(proxy)
    Delete(scan)
print("ok")
