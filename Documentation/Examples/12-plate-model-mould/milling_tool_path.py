# SPDX-License-Identifier: BSD-3-Clause
"""The path of a ball end over a small mould with a pit that is too narrow for it, and what it leaves.

    pvpython milling_tool_path.py [FOLDER]

Writes milling-tool-path.png, the picture of the user guide.
"""
import os
import sys

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from lacuna import pictures
from lacuna.errors import raising
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkStructuredGrid

ASIDE = 78  # mm, of the left-over map from the mould
# of the array Motion: down, cut, lead-in and lead-out
COLORS = {1: (0.10, 0.50, 0.20), 2: (0.10, 0.20, 0.55), 3: (0.90, 0.45, 0.10)}


def make_mould():
    """A hollow with a pit at its flank, 60 x 60 mm."""
    x, y = np.meshgrid(np.linspace(-30, 30, 241), np.linspace(-30, 30, 241))
    z = -9 * np.exp(-((x + 2) ** 2 / 260 + (y + 4) ** 2 / 190)) - 3.5 * np.exp(-((x - 15) ** 2 + (y - 6) ** 2) / 4)
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.stack([x, y, z], 2).reshape(-1, 3), deep=True))
    grid = vtkStructuredGrid()
    grid.SetDimensions(241, 241, 1)
    grid.SetPoints(points)
    source = TrivialProducer()
    source.GetClientSideObject().SetOutput(grid)
    return source


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else "."
    os.makedirs(folder, exist_ok=True)
    mould = make_mould()
    path = MillingToolPath(Input=mould, ToolRadius=4, StepOver=2, RoughingStep=0)
    warnings = []
    with raising(warnings):
        path.UpdatePipeline()
    assert any("too large for" in text for text in warnings), warnings  # the pit

    view = pictures.new_view((1300, 480))
    pictures.show_surface(mould, view, pictures.BONE)
    for motion, color in COLORS.items():
        part = Threshold(Input=path, Scalars=["POINTS", "Motion"], LowerThreshold=motion, UpperThreshold=motion)
        pictures.show_surface(Tube(Input=ExtractSurface(Input=part), Radius=0.15), view, color)
    left_over = Transform(Input=OutputPort(path, 1))
    left_over.Transform.Translate = [ASIDE, 0, 0]
    display = pictures.show_surface(left_over, view, pictures.METAL)
    pictures.color_by(display, view, "LeftOver", "left over, mm", (0, 0.2), "Viridis")
    display.Ambient, display.Diffuse, display.Specular = 0.5, 0.6, 0
    pictures.look(view, [0, 0.7, -0.72], [0, 1, 0], 2.35)
    pictures.add_scale_bar(view, 20)
    pictures.save(view, os.path.join(folder, "milling-tool-path.png"))


main()
