# SPDX-License-Identifier: BSD-3-Clause
"""A freehand sweep becomes a volume and a closed surface.

    pvpython freehand_sweep.py [folder for picture and state file, default: .]

Writes freehand-sweep.png and freehand-sweep.pvsm.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import demo_ultrasound, pictures, states
from paraview.simple import *

# The slices: their probe sways, turns and tilts. Of a recording: TrackedSliceReader(FileName="sweep.igs.mha")
sweep = PhantomSweep(registrationName="Sweep", NumberOfSlices=80, Motion="Arbitrary", SpeckleLevel=0.25)

# Volume, median against speckle, surface half-way between tissue (60) and object (180). The bounds leave a rim of nothing
# around the sweep, which closes the surface where the sweep ends.
volume = SweptVolume(registrationName="Volume", Input=sweep, OutputSpacing=[0.5, 0.5, 0.5], OutputBounds=[-24, 24, -20, 18, -24, 24])
smooth = SpeckleFilter(registrationName="Median", Input=volume, Operation="Median", KernelSize=[5, 5, 5])
surface = Contour(registrationName="Surface", Input=smooth, ContourBy=["POINTS", "Intensity"], Isosurfaces=[120], ComputeScalars=0)
piece = Connectivity(registrationName="Largest piece", Input=surface, ExtractionMode="Extract Largest Region", ColorRegions=0)
body = ExtractSurface(registrationName="Body", Input=piece)

# What there is to see: the surface, one slice through it as the scanner showed it, the outlines of others
middle = SlicePlanes(registrationName="One slice", Input=ExtractSubset(registrationName="Slice 40", Input=sweep, VOI=[0, 319, 0, 239, 40, 40]))
outlines = SlicePlanes(registrationName="Outlines", Input=sweep, OutlineOnly=1, Stride=8)
view = pictures.new_view()
pictures.show_surface(body, view, pictures.TISSUE).Opacity = 0.7
pictures.show_slices(middle, view)
pictures.show_slices(outlines, view)
pictures.look(view, (0.8, 0.5, 0.75), (0, -1, 0), 1.2)
pictures.add_scale_bar(view, 10)

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save(view, os.path.join(folder, "freehand-sweep.png"))
states.save(os.path.join(folder, "freehand-sweep.pvsm"))

enclosed, open_edges = demo_ultrasound.measure(body)
true = sweep.GetClientSideObject().GetTrueVolume() / 1000
print(f"{enclosed:.2f} ml enclosed, {true:.2f} ml in truth ({100 * (enclosed / true - 1):+.1f} %), {open_edges} open edges")
