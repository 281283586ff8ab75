# SPDX-License-Identifier: BSD-3-Clause
"""How well RBF Surface finds the surface and the volume in planar outlines: shapes with known surfaces.

    . build/release/lacuna-env.sh
    pvpython --force-offscreen-rendering Testing/Science/outline_volumes.py [seeds, default 20]

ellipsoid: half axes 40, 28 and 20 mm, five slices across (0.8, 0.5, 0.33), evenly spread, the outermost at 2/3, 0.8 or 0.9 of the half width.
No errors. kumara: twelve outlines that cross each other: six across x, three across y, three across z. A hand's errors of 0.3 mm RMS in the
plane, across the line: independent from point to point, or alike along the line (correlation exp(-d^2 / 2 L^2) with L = 6 mm). Points are
1 mm apart. Prints Markdown: RMS distance of the surface's points from the truth, the volume's error, and the standard error that the filter
states (SurfaceVolumeError) beside the scatter.
"""
import sys

import lacuna.plugin

lacuna.plugin.load()
import numpy as np
import shapes
from paraview.simple import Delete, RBFSurface, TrivialProducer
from paraview.servermanager import Fetch
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPlane, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkCutter, vtkStripper
from vtkmodules.vtkFiltersSources import vtkSphereSource

NOISE, LENGTH, STEP = 0.3, 6.0, 1.0  # mm


def mesh(shape):
    ball = vtkSphereSource()
    ball.SetRadius(1)
    ball.SetThetaResolution(120)
    ball.SetPhiResolution(90)
    ball.Update()
    result = vtkPolyData()
    result.DeepCopy(ball.GetOutput())
    result.GetPoints().SetData(numpy_to_vtk(shape.map(shapes.unit(vtk_to_numpy(result.GetPoints().GetData()).astype(float))), deep=1))
    return result


def even(loop, step):
    """A closed line with points so far apart along it."""
    loop = np.concatenate([loop, loop[:1]])
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(loop, axis=0), axis=1))])
    count = max(8, round(along[-1] / step))
    return np.stack([np.interp(np.arange(count) / count * along[-1], along, loop[:, c]) for c in range(3)], axis=1)


def in_plane_normals(loop, across):
    return shapes.unit(np.cross(np.roll(loop, -1, 0) - np.roll(loop, 1, 0), across))


def outline(shape, surface, origin, across):
    """Points of the cut by a plane, on the true surface."""
    plane, cut, joined = vtkPlane(), vtkCutter(), vtkStripper()
    plane.SetOrigin(*origin)
    plane.SetNormal(*across)
    cut.SetCutFunction(plane)
    cut.SetInputData(surface)
    joined.SetInputConnection(cut.GetOutputPort())
    joined.JoinContiguousSegmentsOn()
    joined.Update()
    lines = joined.GetOutput()
    assert lines.GetNumberOfLines() == 1, "the plane cuts the shape in more than one line"
    ids = vtk_to_numpy(lines.GetLines().GetConnectivityArray())
    loop = even(vtk_to_numpy(lines.GetPoints().GetData()).astype(float)[ids[:-1]], STEP)
    for _ in range(6):
        normals = in_plane_normals(loop, across)
        h = 1e-4
        slope = (shape.distance(loop + h * normals) - shape.distance(loop - h * normals)) / (2 * h)
        loop = loop - (shape.distance(loop) / slope)[:, None] * normals
    assert np.abs(shape.distance(loop)).max() < 1e-3
    return loop


def errors(count, random, alike):
    if not alike:
        return NOISE * random.normal(size=count)
    far = np.abs(np.arange(count)[:, None] - np.arange(count))
    far = STEP * np.minimum(far, count - far)
    values, vectors = np.linalg.eigh(np.exp(-far ** 2 / (2 * LENGTH ** 2)))
    return NOISE * vectors @ (np.sqrt(np.maximum(values, 0)) * random.normal(size=count))


def measure(shape, truth, loops):
    """RMS distance of the surface (mm), volume less truth and its stated standard error (parts of the truth)."""
    data, points, lines = vtkPolyData(), vtkPoints(), vtkCellArray()
    points.SetDataTypeToDouble()
    for loop in loops:
        first = points.GetNumberOfPoints()
        for x in loop:
            points.InsertNextPoint(*x)
        lines.InsertNextCell(len(loop) + 1)
        for i in range(len(loop) + 1):
            lines.InsertCellPoint(first + i % len(loop))
    data.SetPoints(points)
    data.SetLines(lines)
    source = TrivialProducer()
    source.GetClientSideObject().SetOutput(data)
    surface = RBFSurface(Input=source, OutputSpacing=1)
    made = Fetch(surface)
    fields = made.GetFieldData()
    volume, sigma = (fields.GetArray(name).GetValue(0) for name in ("SurfaceVolume", "SurfaceVolumeError"))
    away = shape.distance(vtk_to_numpy(made.GetPoints().GetData()).astype(float))
    Delete(surface)
    Delete(source)
    return np.sqrt(np.mean(away ** 2)), volume / truth - 1, sigma / truth


def main():
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    ellipsoid = shapes.make("ellipsoid")
    truth = 4 / 3 * np.pi * 40 * 28 * 20 / 1000
    surface = mesh(ellipsoid)
    across = np.array([0.8, 0.5, 0.33]) / np.linalg.norm([0.8, 0.5, 0.33])
    half = np.linalg.norm(ellipsoid.axes * across)
    print("| ellipsoid in 5 slices, outermost at | RMS, mm | volume | stated standard error |\n|---|---:|---:|---:|")
    for outermost in (2 / 3, 0.8, 0.9):
        loops = [outline(ellipsoid, surface, at * half * across, across) for at in outermost * np.linspace(-1, 1, 5)]
        rms, volume, sigma = measure(ellipsoid, truth, loops)
        print(f"| {outermost:.2f} | {rms:.3f} | {100 * volume:+.2f} % | {100 * sigma:.2f} % |", flush=True)

    kumara = shapes.make("kumara")
    truth = 4 / 3 * np.pi * kumara.half ** 3 * kumara.y * kumara.z * (1 + kumara.taper ** 2 / 5) / 1000
    surface = mesh(kumara)
    planes = [((x, 0, 0), (1, 0, 0)) for x in (-33, -20, -7, 7, 20, 33)]
    planes += [((0, y, 0), (0, 1, 0)) for y in (-11, -6, -1)] + [((0, 0, z), (0, 0, 1)) for z in (-5, 0, 5)]
    exact = [(outline(kumara, surface, np.array(o, float), np.array(n, float)), np.array(n, float)) for o, n in planes]
    print(f"\n| kumara, 12 crossing outlines, {NOISE} mm, {seeds} seeds | RMS, mm | mean volume | scatter (SD) | stated SD (RMS) | largest / stated |\n"
          "|---|---:|---:|---:|---:|---:|")
    for text, alike in (("independent", False), (f"alike along the line ({LENGTH:.0f} mm)", True)):
        found = []
        for seed in range(seeds):
            random = np.random.default_rng([seed, alike])
            loops = [loop + errors(len(loop), random, alike)[:, None] * in_plane_normals(loop, n) for loop, n in exact]
            found.append(measure(kumara, truth, loops))
        rms, volume, sigma = np.array(found).T
        print(f"| {text} | {np.sqrt(np.mean(rms ** 2)):.3f} | {100 * volume.mean():+.2f} % | {100 * volume.std(ddof=1):.2f} % | "
              f"{100 * np.sqrt(np.mean(sigma ** 2)):.2f} % | {np.max(np.abs(volume) / sigma):.1f} |", flush=True)


if __name__ == "__main__":
    main()
