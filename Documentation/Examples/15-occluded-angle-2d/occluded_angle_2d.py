# SPDX-License-Identifier: BSD-3-Clause
"""The thesis's 2-D cases of the occluded angle (Carr 1996, chapter 5), each with its picture.

Usage: pvpython occluded_angle_2d.py [folder for the pictures]
"""
import math
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import occlusion, pictures
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
SIZE = [200, 200, 200]


def show(name, title, angle):
    """The angle in grey, the data in blue, the closed outline in red."""
    surface = occlusion.closed_surface(angle)
    view = pictures.new_view((900, 700))
    display = Show(angle, view)
    display.SetRepresentationType("Slice")
    pictures.color_by(display, view, "OccludedAngle", "angle / rad", (0, 2 * math.pi), "Grayscale")
    points = TrivialProducer()
    points.GetClientSideObject().SetOutput(occlusion.data_points(angle.Input))
    seen = Show(points, view)
    seen.AmbientColor = seen.DiffuseColor = [0.2, 0.5, 1.0]
    seen.PointSize = 3
    vtk_to_numpy(surface.data.GetPoints().GetData())[:, 2] += 1  # in front of the image
    outline = TrivialProducer()
    outline.GetClientSideObject().SetOutput(surface.data)
    line = Show(outline, view)
    line.AmbientColor = line.DiffuseColor = [0.9, 0.1, 0.1]
    line.LineWidth = 3
    pictures.add_title(view, title)
    pictures.look(view, (0, 0, -1), (0, 1, 0), 1.3)
    pictures.save(view, os.path.join(folder, name + ".png"))
    suggestion = occlusion.suggested_threshold(angle)
    print(f"{name}: area {surface.volume:.0f} mm2, threshold suggested for one iteration {suggestion:.2f} pi", flush=True)
    Delete(view)


gap = IncompleteShape(Dimensions=SIZE, GapAngle=40)
show("gap", "Gap of 40 degrees, threshold pi",
     OccludedAngle(Input=gap, Mode="Binary", NumberOfDirections=100, ThresholdsOverPi=[1]))

quarter = IncompleteShape(Dimensions=SIZE, PresentFraction=0.25)
show("quarter", "A quarter of the pixels, 0.6 pi, median",
     OccludedAngle(Input=quarter, Mode="Binary", NumberOfDirections=150, ThresholdsOverPi=[0.6], MedianKernel=5))

blob = IncompleteShape(Shape="Blob", Dimensions=SIZE, PresentFraction=0.4, OutlierFraction=0.1, Seed=2)
show("blob", "Noisy blob, 1.6 1.6 1.3 1.3 pi",
     OccludedAngle(Input=blob, NumberOfDirections=100, ThresholdsOverPi=[1.6, 1.6, 1.3, 1.3]))

cavity = IncompleteShape(Shape="Cavity", Dimensions=SIZE, PresentFraction=0.6)
# a doughnut, cut open: it leaves out all but the rim of the bay
space = Calculator(Input=cavity, ResultArrayName="Space",
                   Function="if(abs(coordsY) < 15 & (coordsX > 0 | coordsX^2 + coordsY^2 < 225), 0, 1)")
show("cavity-doughnut", "Cavity, reconstruction space without the bay, 1.6 pi x 3",
     OccludedAngle(Input=cavity, SpaceMask=space, NumberOfDirections=100, ThresholdsOverPi=[1.6] * 3))
# Local radii need data inside the tissue.
tissue = IncompleteShape(Shape="Cavity", Dimensions=SIZE, PresentFraction=0.6, TissueFraction=0.15)
show("cavity-local", "Cavity, local radii, 1.4 pi x 3 at 10 mm, 1.5 pi x 2 at 15 mm",
     OccludedAngle(Input=tissue, NumberOfDirections=100, ThresholdsOverPi=[1.4] * 3 + [1.5] * 2,
                   LocalRadii=[10] * 3 + [15] * 2))
