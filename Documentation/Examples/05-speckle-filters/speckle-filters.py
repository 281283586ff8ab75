# SPDX-License-Identifier: BSD-3-Clause
"""Every operation of Speckle Filter on one phantom slice: pictures, and a table of what each one gains.

    pvpython speckle-filters.py [folder for the pictures, default: .]

Red: the border of what is at or above the threshold, as in Carr 1996, figures 4.11 and 4.12.
"""
import os
import sys

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from lacuna import speckle
from paraview.simple import *
from paraview import servermanager
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkPNGWriter

ISO_VALUE = 120  # half-way between tissue (60) and object (180)
DISC = dict(KernelSize=[5, 5, 1], KernelShape="Ellipsoid")
FILTERS = {
    "none": None,
    "Median 5x5": dict(Operation="Median", KernelSize=[5, 5, 1]),
    "Median 11x11": dict(Operation="Median", KernelSize=[11, 11, 1]),
    "Rank 30 % 5x5": dict(Operation="Rank", Rank=30, KernelSize=[5, 5, 1]),
    "Mode 5x5": dict(Operation="Mode", KernelSize=[5, 5, 1]),
    "AdaptiveMedian 9x9": dict(Operation="AdaptiveMedian", KernelSize=[9, 9, 1], AdaptiveStrength=1),
    "Mean 5x5": dict(Operation="Mean", KernelSize=[5, 5, 1]),
    "Gaussian 1.41": dict(Operation="Gaussian", StandardDeviation=2 ** 0.5),
    "Minimum 5": dict(Operation="Minimum", **DISC),
    "Maximum 5": dict(Operation="Maximum", **DISC),
    "Opening 5": dict(Operation="Opening", **DISC),
    "Closing 5": dict(Operation="Closing", **DISC),
    "OpenClose 5": dict(Operation="OpenClose", **DISC),
    "CloseOpen 5": dict(Operation="CloseOpen", **DISC),
}
LAPLACIAN = dict(Operation="LaplacianOfGaussian", StandardDeviation=3)


def pixels(proxy):
    """The grey levels of a slice as (row, column)."""
    data = servermanager.Fetch(proxy)
    width, height, _ = data.GetDimensions()
    return vtk_to_numpy(data.GetPointData().GetScalars()).reshape(height, width).astype(float)


def write(name, grey, border):
    """A PNG, row 0 on top, with border pixels in red."""
    rgb = np.repeat(grey.clip(0, 255).astype(np.uint8)[:, :, None], 3, axis=2)
    rgb[border] = (230, 40, 40)
    rgb = rgb[::-1]
    image = vtkImageData()
    image.SetDimensions(rgb.shape[1], rgb.shape[0], 1)
    image.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(rgb).reshape(-1, 3), deep=1))
    writer = vtkPNGWriter()
    writer.SetFileName(name)
    writer.SetInputData(image)
    writer.Write()


def border_of(mask):
    """Pixels of the mask that have a neighbour (of 4) outside of it."""
    padded = np.pad(mask, 1, mode="edge")
    inner = padded[:-2, 1:-1] & padded[2:, 1:-1] & padded[1:-1, :-2] & padded[1:-1, 2:]
    return mask & ~inner


def main(folder):
    os.makedirs(folder, exist_ok=True)
    sweep = PhantomSweep(NumberOfSlices=1, ImageSize=[240, 180], PixelSpacing=0.25, SpeckleLevel=0.4)
    image = speckle.truth_masks(sweep, inside=(175, 185), outside=(55, 65))
    for label, properties in FILTERS.items():
        proxy = image if properties is None else SpeckleFilter(Input=image, **properties)
        grey = pixels(proxy)
        name = "-".join(label.lower().replace("%", "").replace(".", "").split())
        write(os.path.join(folder, f"speckle-{name}.png"), grey, border_of(grey >= ISO_VALUE))
    edges = pixels(SpeckleFilter(Input=image, **LAPLACIAN))
    write(os.path.join(folder, "speckle-laplacian.png"), 128 + 25 * edges, border_of(edges > 0) & (abs(edges) > 0.4))
    rows = speckle.compare(image, FILTERS, inside_array="Inside", outside_array="Outside", iso_value=ISO_VALUE)
    text = speckle.table(rows)
    print(text)
    with open(os.path.join(folder, "speckle-filters.md"), "w") as file:
        file.write(text + "\n")


main(sys.argv[1] if len(sys.argv) > 1 else ".")
