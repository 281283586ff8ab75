# SPDX-License-Identifier: BSD-3-Clause
"""The ripple of surfaces in coarse slices, by interpolation: difference maps and histograms. Carr 1996, 3.3.

    pvpython ripple.py [folder for the pictures, default: .] [CT of a head with slices of 1 mm, default: Skull Phantom]

Every third slice of the volume is kept. Depth maps of these by the three interpolations are compared with that of all
slices (InterpolatingBSpline), along the surface's normal. Pixels count where all maps see the same surface, away from
edges. bias: the mean. residual: RMS of what is left of the difference when its mean over 10 mm is taken away: ripple and
an error that depends on tilt, curvature and thin bone. ripple: RMS of the part of the residual that repeats from slice to slice (3 mm and
its half; the same at other lengths is taken away as noise), and the median over the pixels.
differences.png: above the differences by the three interpolations, -0.5 mm (blue) to 0.5 mm (red, into the bone); below
their residuals, -0.3 to 0.3 mm.
"""
import os
import sys

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from lacuna.pictures import chart_pixels, color_bar, mark_pixels, side_by_side, write_pixels
from lacuna.views import in_patient_coordinates, map_letters
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

INTERPOLATIONS = ("Trilinear", "BSpline", "InterpolatingBSpline")
VIEWS = {"left": [-1, 0, 0], "right": [1, 0, 0], "front": [0, -1, 0], "back": [0, 1, 0]}
PIXEL = 0.5  # mm
STEP = 3  # slices


def smooth(a, sigma):
    """Weighted sums over a Gaussian of sigma pixels."""
    rows, columns = (np.exp(-0.5 * (np.subtract.outer(np.arange(n), np.arange(n)) / sigma) ** 2) for n in a.shape)
    return rows @ a @ columns


def spread(a, choose):
    """The choice among each pixel and its eight neighbours."""
    for axis in (0, 1):
        a = choose(a, choose(np.roll(a, 1, axis), np.roll(a, -1, axis)))
    return a


class Comparison:
    """Maps of a volume with all its slices and with every third, seen from one direction."""

    def __init__(self, fine, coarse, direction):
        direction = np.array(direction, dtype=float)
        bounds = fine.GetDataInformation().GetBounds()
        middle = [0.5 * (bounds[2 * a] + bounds[2 * a + 1]) for a in range(3)]
        maps = {}
        for volume in (fine, coarse):
            for name in INTERPOLATIONS:
                caster = BSplineIsoRayCaster(Input=volume, IsoValues=[500], Interpolation=name, PixelSpacing=PIXEL,
                                             ViewDirection=direction, ViewUp=[0, 0, 1], FocalPoint=middle,
                                             PlaneOrigin=middle, ImageSize=[440, 320])
                caster.UpdatePipeline()
                data = servermanager.Fetch(caster)
                width, height, _ = data.GetDimensions()
                depth = vtk_to_numpy(data.GetPointData().GetArray("Depth")).reshape(height, width).copy()
                normals = vtk_to_numpy(data.GetPointData().GetNormals()).reshape(height, width, 3)
                maps[volume is fine, name] = depth, -(normals @ direction)
                height_of_rows = np.array([data.GetPoint(row * width)[2] for row in range(height)])
                self.letters = map_letters(data) if in_patient_coordinates(data) else None
                Delete(caster)
        truth, cosine = maps[True, "InterpolatingBSpline"]
        self.same = np.ones(truth.shape, dtype=bool)
        for depth, facing in maps.values():
            known = np.where(np.isfinite(depth), depth, 1e6)
            jump = spread(known, np.maximum) - spread(known, np.minimum) > 2 * PIXEL * np.tan(np.radians(75))
            self.same &= ~spread(jump | (facing < 0.35), np.logical_or)
            self.same &= np.nan_to_num(np.abs(depth - truth) * cosine, nan=9) < 1.5
        self.z = np.where(self.same, height_of_rows[:, None], 0)
        self.weight = smooth(self.same.astype(float), 10 / PIXEL)
        full = smooth(np.ones(truth.shape), 10 / PIXEL).max()
        self.inner = self.same & (self.weight > 0.5 * full)
        self.differences = {name: np.where(self.same, (maps[False, name][0] - truth) * cosine, 0)
                            for name in INTERPOLATIONS}

    def mean(self, a):
        """Over 10 mm, of the pixels that count."""
        return smooth(np.where(self.same, a, 0), 10 / PIXEL) / np.maximum(self.weight, 1e-9)

    def power(self, residual, length):
        """Mean square of what repeats in z at a length and its half, about each pixel."""
        total = 0
        for harmonic in (1, 2):
            phase = 2 * np.pi * harmonic * self.z / length
            total = total + 2 * (self.mean(residual * np.cos(phase)) ** 2 + self.mean(residual * np.sin(phase)) ** 2)
        return total[self.inner]

    def measure(self, name, slice_distance):
        """bias, residual, ripple, its median (mm)."""
        difference = self.differences[name]
        residual = difference - self.mean(difference)
        locked = self.power(residual, slice_distance)
        noise = 0.5 * (self.power(residual, 0.877 * slice_distance) + self.power(residual, 1.137 * slice_distance))
        return (difference[self.inner].mean(), np.sqrt((residual[self.inner] ** 2).mean()),
                np.sqrt(max(0, (locked - noise).mean())), np.sqrt(np.median(locked)))


def colors(difference, same, limit=0.5):
    """Blue, white, red."""
    x = np.clip(difference / limit, -1, 1)[..., None]
    rgb = np.where(x < 0, 255 + x * np.array([200, 150, 30]), 255 - x * np.array([30, 170, 200]))
    return np.where(same[..., None], rgb, 235).astype(np.uint8)


def make_row(comparison, cut, title, measure, limit):
    """Pixels of one measure of the differences by the three interpolations, with a scale."""
    panels = [(title.format(name), colors(measure(difference), comparison.same, limit)[cut])
              for name, difference in comparison.differences.items()]
    if comparison.letters:
        panels = [(title, mark_pixels(pixels, comparison.letters)) for title, pixels in panels]
    height = panels[0][1].shape[0]
    bar = color_bar(lambda values: colors(values, np.ones(values.shape, dtype=bool), limit), -limit, limit, "mm", height)
    return side_by_side([*panels, ("", bar)])


def write_histograms(name, comparison):
    """Of the differences, as parts of the pixels."""
    edges = np.linspace(-0.6, 1, 81)
    middles = 0.5 * (edges[1:] + edges[:-1])
    curves = []
    for (interpolation, difference), color in zip(comparison.differences.items(), ((200, 60, 40), (40, 90, 200), (40, 150, 60))):
        counts, _ = np.histogram(difference[comparison.inner], edges)
        curves.append((interpolation, middles, 100.0 * counts / comparison.inner.sum(), color, "line"))
    titles = "difference from all slices along the normal (mm)", "% of the pixels in 0.02 mm"
    write_pixels(name, chart_pixels(curves, titles, (800, 420)))


def main(folder, head=None):
    """Writes the pictures; returns {view: {interpolation: (bias, residual, ripple, median ripple)}}."""
    os.makedirs(folder, exist_ok=True)
    fine = OpenDataFile(head) if head else SkullPhantom(Spacing=[1, 1, 1])
    fine.UpdatePipeline()
    extent = fine.GetDataInformation().GetExtent()
    last = extent[4] + (extent[5] - extent[4]) // STEP * STEP
    part = [*extent[:5], last]
    coarse = ExtractSubset(Input=fine, VOI=part, SampleRateK=STEP)
    fine = ExtractSubset(Input=fine, VOI=part)
    fine.UpdatePipeline()
    volume = servermanager.Fetch(fine)
    distance = STEP * volume.GetSpacing()[2]
    results = {}
    print("mm:    interpolation            bias  residual   ripple   median")
    for name, direction in VIEWS.items():
        comparison = Comparison(fine, coarse, direction)
        results[name] = {i: comparison.measure(i, distance) for i in INTERPOLATIONS}
        for interpolation, figures in results[name].items():
            print(f"{name:6} {interpolation:20}" + "".join(f"{f:9.4f}" for f in figures))
        smooths = [results[name][i] for i in INTERPOLATIONS]
        print(f"{name:6} trilinear / B-spline         " + "".join(f"{smooths[0][k] / smooths[1][k]:9.2f}"
                                                                 for k in (1, 2, 3)), flush=True)
        if name == "right":
            rows, columns = (np.nonzero(comparison.same.sum(axis=axis) > 20)[0] for axis in (1, 0))
            cut = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
            rows = [make_row(comparison, cut, "{}: difference", lambda d: d, 0.5),
                    make_row(comparison, cut, "{}: residual", lambda d: d - comparison.mean(d), 0.3)]
            write_pixels(os.path.join(folder, "differences.png"), np.concatenate(rows))
            write_histograms(os.path.join(folder, "histograms.png"), comparison)
    return results


if __name__ == "__main__":
    main(*(sys.argv[1:] or ["."]))
