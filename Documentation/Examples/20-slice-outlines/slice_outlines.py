# SPDX-License-Identifier: BSD-3-Clause
"""Two structures, outlined in slices of a freehand sweep, become surfaces and millilitres.

    pvpython slice_outlines.py [folder for picture, outlines and state file, default: .]

Writes slice-outlines.png, outlines.csv and slice-outlines.pvsm, for File > Load State.
"""
import math
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import outlines, pictures, states
from paraview.simple import *

TRUTH = {"Organ": 4 / 3 * math.pi * 17 * 12 * 15 / 1000, "Cyst": 4 / 3 * math.pi * 6 * 5 * 5 / 1000}  # ml, of the phantom's ellipsoids
ORANGE, BLUE = (0.9, 0.62, 0.0), (0.34, 0.71, 0.91)

sweep = PhantomSweep(registrationName="Sweep", Motion="Sweep", SpeckleLevel=0.1, Seed=2)
outliner = SliceOutliner(registrationName="Outlines", Input=sweep, Slice=42, StructureColors=[*ORANGE, *BLUE])
# in each slice the contour of the largest bright area, then that around a place in the dark cyst, as by a click
for number in (15, 20, 27, 35, 42, 47):
    outlines.trace(outliner, "Organ", number, level=120, region=(50, 240, 60, 200), median=7)
for number in (39, 41, 43, 45, 48):
    outlines.trace(outliner, "Cyst", number, level=40, place=(249, 54), median=7)
structures = OutlinedStructures(registrationName="Structures", Input=outliner, RegistrationError=0.3)
table = outlines.table(structures)
for name, row in table.items():
    volume, error = row["Volume (ml)"], row["Standard error (ml)"]
    print(f"{name}: {volume:.2f} ml, standard error {error:.2f} ml; truth {TRUTH[name]:.2f} ml; largest diameter {row['Largest diameter (mm)']:.1f} mm")
    assert abs(volume - TRUTH[name]) < 3 * error

views = []
for title in ("Outlines in their slices", "Surfaces"):
    view = pictures.new_view((620, 480))
    view.OrientationAxesVisibility = 0
    lines = Show(outliner, view)
    ColorBy(lines, ("CELLS", "StructureColor"))
    lines.MapScalars, lines.LineWidth, lines.RenderLinesAsTubes = 0, 5, 1
    for port in (outliner, structures)[:1 + len(views)]:
        display = Show(port, view)
        ColorBy(display, ("CELLS", "StructureColor"))
        display.MapScalars = 0
    display = Show(OutputPort(outliner, 1), view)
    ColorBy(display, ("POINTS", "Intensity"))
    display.RescaleTransferFunctionToDataRange(False, True)
    display.SetScalarBarVisibility(view, False)
    display.Ambient, display.Diffuse, display.Opacity = 1, 0, 0.75 if views else 1
    text = "\n".join(f"{name}: {row['Volume (ml)']:.2f} ± {row['Standard error (ml)']:.2f} ml" for name, row in table.items())
    pictures.add_title(view, f"{title}\n{text}" if views else title)
    pictures.look(view, (-0.5, 0.25, 0.8), (0, -1, 0), 1.1)
    views.append(view)
layout = pictures.lay_out(views, "Slice outlines")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
outlines.save(outliner, os.path.join(folder, "outlines.csv"))
pictures.save_layout(layout, os.path.join(folder, "slice-outlines.png"))
states.save(os.path.join(folder, "slice-outlines.pvsm"))
