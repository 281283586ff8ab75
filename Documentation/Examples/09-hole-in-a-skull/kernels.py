# SPDX-License-Identifier: BSD-3-Clause
"""What each kernel of RBF Hole Filler does to a hole of 30 mm radius in a dome, in section.

    pvpython kernels.py [folder for the pictures, default: .]

The dome is an ellipsoid (radii 95, 80 and 85 mm) with noise of 0.1 mm; the hole is filled as the kernels are
best used: SupportMargin 20, NodeSpacing 2. Above through all nodes, below smoothed. Printed is the largest
error in the whole hole, mean of eight draws of the noise; drawn is the first one.
"""
import os
import sys

import lacuna
import numpy as np
import paraview.simple
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkChartsCore import vtkAxis, vtkChart, vtkChartXY
from vtkmodules.vtkCommonCore import vtkDoubleArray
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkTable
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter
from vtkmodules.vtkViewsContext2D import vtkContextView

RADIUS = 30
x, y = np.meshgrid(np.arange(-60.0, 61), np.arange(-60.0, 61))
dome = 85 - 85 * np.sqrt(1 - (x / 95) ** 2 - (y / 80) ** 2)
hole = np.hypot(x, y) <= RADIUS
MIDDLE = 60  # the row through the centre
SEEDS = range(1, 9)


def depth_map(seed):
    image = vtkImageData()
    image.SetDimensions(121, 121, 1)
    depth = dome + np.random.default_rng(seed).normal(0, 0.1, dome.shape)
    arrays = (("Depth", depth), ("Defect", hole.astype(np.int8)))
    for name, values in arrays:
        array = numpy_to_vtk(values.ravel(), deep=1)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    to_world = numpy_to_vtk(np.eye(4).reshape(1, 16), deep=1)
    to_world.SetName("ImageToWorld")
    image.GetFieldData().AddArray(to_world)
    return image


def fill(depths, settings):
    """Error of the fill, mm, positive where it lies inside of the dome."""
    filler = lacuna.vtkLacunaRBFHoleFiller()
    filler.SetInputData(depths)
    filler.SetDefectArray("Defect")
    filler.SetSupportMargin(20)
    filler.SetNodeSpacing(2)
    for name, value in settings.items():
        getattr(filler, "Set" + name)(lacuna.choices(filler, name)[value] if isinstance(value, str) else value)
    filler.Update()
    fitted = vtk_to_numpy(filler.GetOutput().GetPointData().GetArray("Fitted")).reshape(121, 121)
    return fitted - dome


LINES = {
    "without smoothing": {
        "ThinPlate": dict(Kernel="ThinPlate"),
        "Linear": dict(Kernel="Linear"),
        "Cubic": dict(Kernel="Cubic"),
        "Triharmonic": dict(Kernel="Triharmonic"),
        "Gaussian": dict(Kernel="Gaussian"),
        "Multiquadric": dict(Kernel="Multiquadric"),
    },
    "CutoffWavelength 10": {
        "ThinPlate": dict(Kernel="ThinPlate", CutoffWavelength=10),
        "Linear": dict(Kernel="Linear", CutoffWavelength=10),
        "Cubic": dict(Kernel="Cubic", CutoffWavelength=10),
        "Triharmonic": dict(Kernel="Triharmonic", CutoffWavelength=10),
        "ThinPlate, Trend Ellipsoid": dict(Kernel="ThinPlate", CutoffWavelength=10, Trend="Ellipsoid"),
    },
}
COLORS = [(31, 119, 180), (214, 39, 40), (44, 160, 44), (148, 103, 189), (140, 86, 75), (255, 127, 14)]


def draw(title, lines, limits, file):
    table = vtkTable()
    for name, values in [("x", x[MIDDLE])] + list(lines.items()):
        array = vtkDoubleArray()
        array.SetName(name)
        for value in values:
            array.InsertNextValue(value)
        table.AddColumn(array)
    chart = vtkChartXY()
    chart.SetTitle(title)
    chart.SetShowLegend(True)
    chart.GetLegend().SetHorizontalAlignment(2)
    for index in range(len(lines)):
        plot = chart.AddPlot(vtkChart.LINE)
        plot.SetInputData(table, 0, index + 1)
        plot.SetColor(*COLORS[index], 255)
        plot.SetWidth(3)
    axes = {vtkAxis.BOTTOM: ("mm from the centre of the hole (rim at 30)", -50, 50),
            vtkAxis.LEFT: ("mm too deep", *limits)}
    for position, (label, low, high) in axes.items():
        axis = chart.GetAxis(position)
        axis.SetTitle(label)
        axis.SetBehavior(vtkAxis.FIXED)
        axis.SetRange(low, high)
    view = vtkContextView()
    view.GetRenderWindow().SetOffScreenRendering(1)
    view.GetRenderWindow().SetSize(900, 480)
    view.GetRenderWindow().SetMultiSamples(0)
    view.GetRenderer().SetBackground(1, 1, 1)
    view.GetScene().AddItem(chart)
    view.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(view.GetRenderWindow())
    writer = vtkPNGWriter()
    writer.SetInputConnection(grab.GetOutputPort())
    writer.SetFileName(file)
    writer.Write()


folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
maps = [depth_map(seed) for seed in SEEDS]
largest = {}
for number, (title, settings) in enumerate(LINES.items()):
    errors = {name: [fill(depths, values) for depths in maps] for name, values in settings.items()}
    file, limits = (("kernels.png", (-2, 6)), ("kernels-smoothed.png", (-0.5, 1.5)))[number]
    draw(title, {name: fills[0][MIDDLE] for name, fills in errors.items()}, limits,
         os.path.join(folder, file))
    for name, fills in errors.items():
        largest[title, name] = np.mean([np.abs(error[hole]).max() for error in fills])
        print("%-20s %-28s %.2f mm" % (title, name, largest[title, name]))
