# SPDX-License-Identifier: BSD-3-Clause
"""One ultrasound slice with speckle, unfiltered and through three filters, side by side.

    pvpython in_paraview.py [folder for picture and state file, default: .]

Writes speckle-filters.png and speckle-filters.pvsm, for File > Load State.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import pictures, states
from paraview.simple import *

# A slice of a phantom, object 180, tissue 60; of a recording: TrackedSliceReader(FileName="sweep.igs.mha")
sweep = PhantomSweep(registrationName="Slice", NumberOfSlices=1, ImageSize=[240, 180], PixelSpacing=0.25, SpeckleLevel=0.4)
FILTERS = {
    "No filter": None,
    "Median 5 x 5": dict(Operation="Median", KernelSize=[5, 5, 1]),
    "Adaptive median 9 x 9": dict(Operation="AdaptiveMedian", KernelSize=[9, 9, 1], AdaptiveStrength=1),
    "Gaussian 1.41": dict(Operation="Gaussian", StandardDeviation=2 ** 0.5),
}
views = []
for title, settings in FILTERS.items():
    image = SpeckleFilter(registrationName=title, Input=sweep, **settings) if settings else sweep
    # the border of what is half-way between tissue and object, as a threshold would cut it
    border = Contour(registrationName="Border, " + title.lower(), Input=image, ContourBy=["POINTS", "Intensity"], Isosurfaces=[120])
    last = title == "Gaussian 1.41"
    view = pictures.new_view((640 if last else 440, 440))  # with a scalar bar
    pictures.show_image(image, view, "Intensity", "Grey level", (0, 255)).SetScalarBarVisibility(view, last)
    pictures.show_surface(border, view, (0.9, 0.15, 0.1)).LineWidth = 2
    pictures.add_title(view, title)
    pictures.look(view, (0, 0, 1), (0, -1, 0), 1.2)
    views.append(view)
layout = pictures.lay_out(views, "Speckle filters")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "speckle-filters.png"))
states.save(os.path.join(folder, "speckle-filters.pvsm"))
