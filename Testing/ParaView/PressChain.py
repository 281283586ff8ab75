# SPDX-License-Identifier: BSD-3-Clause
"""The whole chain on a letter F: DICOM, depth map, fill, press, IGES and STL, and back to the patient
by PressToPatient, from five views, for scans of any orientation."""
import os
import shutil
import subprocess
import sys

import lacuna_test
import numpy as np
from lacuna.errors import raising
from letter_block import HALF, face_axes, letter_distance, with_mask
from paraview import servermanager
from paraview.simple import Delete, ExtractSurface, LoadPlugin, OpenDataFile, SaveData
from vtkmodules.numpy_interface import dataset_adapter as dsa

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
folder = lacuna_test.output("press chain")
shutil.rmtree(folder, ignore_errors=True)
subprocess.run([sys.argv[1], folder], check=True)

MICROMETRE = 1e-3


def read_iges(path):
    """Knots and control points of the B-spline surface in a file of the IGES Writer."""
    with open(path, encoding="ascii") as file:
        lines = [line for line in file if line[72] == "P"]
    text = "".join(line[:64].rstrip() for line in lines)
    for entity in text.split(";"):
        values = entity.split(",")
        if values[0].strip() == "128":
            break
    k1, k2, m1, m2 = (int(v) for v in values[1:5])
    numbers = np.array([float(v.replace("D", "E")) for v in values[10:]])
    n1, n2 = k1 + m1 + 2, k2 + m2 + 2
    u, v = numbers[:n1], numbers[n1:n1 + n2]
    start = n1 + n2 + (k1 + 1) * (k2 + 1)
    points = numbers[start:start + 3 * (k1 + 1) * (k2 + 1)].reshape(k2 + 1, k1 + 1, 3)
    return u, v, points


def basis(knots, x):
    """Matrix of the cubic B-splines (Cox and de Boor) at x."""
    x = np.clip(x, knots[0], np.nextafter(knots[-1], -np.inf))
    values = ((knots[:-1] <= x[:, None]) & (x[:, None] < knots[1:])).astype(float)
    for d in range(1, 4):
        with np.errstate(divide="ignore", invalid="ignore"):
            left = np.nan_to_num((x[:, None] - knots[:-d - 1]) / (knots[d:-1] - knots[:-d - 1]), posinf=0, neginf=0)
            right = np.nan_to_num((knots[d + 1:] - x[:, None]) / (knots[d + 1:] - knots[1:-d]), posinf=0, neginf=0)
        values = left * values[:, :-1] + right * values[:, 1:]
    return values


def mark_pit(depth):
    """The depth map with the array Pit: 1 where it leaves its plane, and 1.5 mm around."""
    with raising():
        depth.UpdatePipeline()
    image = servermanager.Fetch(depth)
    columns, rows, _ = image.GetDimensions()
    z = np.asarray(dsa.WrapDataObject(image).PointData["Depth"]).reshape(rows, columns)
    y, x = np.mgrid[:rows, :columns].astype(float)
    keep = np.isfinite(z) & (np.minimum(np.minimum(x, columns - 1 - x), np.minimum(y, rows - 1 - y)) < 9)
    matrix = np.column_stack([x.ravel(), y.ravel(), np.ones(z.size)])
    plane = np.linalg.lstsq(matrix[keep.ravel()], z[keep], rcond=None)[0]
    off = np.abs(z - (matrix @ plane).reshape(z.shape))
    pit = ~(off < 2 * MICROMETRE)
    for _ in range(3):
        grown = pit.copy()
        for axis in (0, 1):
            for step in (-1, 1):
                grown |= np.roll(pit, step, axis)
        pit = grown
    return with_mask(image, "Pit", pit)


worst = 0
for name in ("axial", "feet first", "sagittal", "oblique"):
    scan = CTSeriesReader(FileName=os.path.join(folder, name))
    for face in range(5):
        along, up, normal = face_axes(face)
        view = -normal + 0.22 * along - 0.15 * up  # not along the normal: the press has to turn it
        depth = BSplineIsoRayCaster(Input=scan, IsoValues=[0], PixelSpacing=0.5, ViewDirection=list(view),
                                    ViewUp=list(up + 0.15 * along), FocalPoint=list(HALF * normal), ImageSize=[75, 75])
        marked = mark_pit(depth)
        filled = RBFHoleFiller(Input=marked, DefectArray="Pit", NodeSpacing=2)
        filled.DefectRegion = "None"
        press = PressOrientation(Input=filled, Mould="Male" if face % 2 else "Female", ConvexSide="Outward",
                                 PlateMargin=0.5, FlangeWidth=6, OutputSpacing=0.5)
        with raising():
            press.UpdatePipeline()
        data = servermanager.Fetch(press)
        wrapped = dsa.WrapDataObject(data)
        back = np.asarray(wrapped.FieldData["PressToPatient"]).reshape(4, 4)
        assert abs(np.linalg.det(back[:3, :3]) - 1) < 1e-14
        # the mill is where it should be, and the plane lies flat
        assert abs(back[:3, 2] @ normal - (1 if face % 2 else -1)) < 1e-8
        assert abs(np.linalg.norm(np.radians(np.asarray(wrapped.FieldData["Angles"])))) > 0.1
        columns, rows = (last + 1 for last in data.GetExtent()[1:4:2])
        grid = np.asarray(wrapped.Points)
        region = np.asarray(wrapped.PointData["PressRegion"])
        defect = np.asarray(wrapped.PointData["DefectMask"]) == 1

        # both files hold the mould in press coordinates
        igs, stl = lacuna_test.output("chain.igs"), lacuna_test.output("chain.stl")
        surface = ExtractSurface(Input=press)
        with raising():
            SaveData(igs, press, Tolerance=1e-4)
            SaveData(stl, surface)
        u, v, control = read_iges(igs)
        bu, bv = basis(u, np.arange(columns, dtype=float)), basis(v, np.arange(rows, dtype=float))
        from_iges = np.einsum("jb,ia,bac->jic", bv, bu, control, optimize=True).reshape(-1, 3)
        reader = OpenDataFile(stl)
        with raising():
            reader.UpdatePipeline()
        triangles = np.asarray(dsa.WrapDataObject(servermanager.Fetch(reader)).Points).astype(float)
        i = np.rint((triangles[:, 0] - grid[0, 0]) / 0.5).astype(int)
        j = np.rint((triangles[:, 1] - grid[0, 1]) / 0.5).astype(int)
        assert np.abs(triangles - grid[i + columns * j]).max() < MICROMETRE
        from_stl = np.full(grid.shape, np.nan)
        from_stl[i + columns * j] = triangles
        assert np.isfinite(from_stl).all()

        for source, points in (("grid", grid), ("IGES", from_iges), ("STL", from_stl)):
            patient = points @ back[:3, :3].T + back[:3, 3]
            # the plate's face is parallel to the block's: Onlay, 0.7 mm above for the female mould
            height = patient[region == 2] @ normal - HALF - (0 if face % 2 else 0.7)
            worst = max(worst, np.abs(height).max())
            assert np.abs(height).max() < MICROMETRE, (name, face, source, np.abs(height).max())
            # the letter is where it was: all of it is marked, and only what is around it
            a, b = patient @ along, patient @ up
            assert defect[letter_distance(a, b) < 0.3].all(), (name, face, source)
            assert letter_distance(a, b)[defect].max() < 5.5, (name, face, source)
            for mirrored in (letter_distance(-a, b), letter_distance(a, -b)):
                assert (~defect[mirrored == 0]).mean() > 0.05, (name, face, source)
        for proxy in (surface, reader, press, filled, marked, depth):
            Delete(proxy)
    Delete(scan)
    print(f"{name}: five faces, off by {1000 * worst:.3f} um at most so far", flush=True)
