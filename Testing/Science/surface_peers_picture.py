# SPDX-License-Identifier: BSD-3-Clause
"""The five shapes of surface_peers.py coloured by their error: one sheet of RBF Surface and PoissonRecon, all points and patches.

    . build/release/lacuna-env.sh
    xvfb-run -a /usr/bin/python3 Testing/Science/surface_peers_picture.py FOLDER PICTURE.png [SIGMA, default: 0.2]

FOLDER is the --out of surface_peers.py after its part cases, with meshes and results.csv. Of a peer's settings it shows the best of each case.
"""
import csv
import os
import sys

import numpy as np
import vtkmodules.vtkRenderingFreeType  # noqa: F401 (draws text)
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingAnnotation import vtkScalarBarActor
from vtkmodules.vtkRenderingCore import (vtkActor, vtkColorTransferFunction, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTextActor,
                                         vtkWindowToImageFilter)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401

import shapes
from surface_peers import best, corners, mesh_path, read_mesh

ROWS = [("RBF Surface", "Lacuna", "whole"), ("PoissonRecon", "PoissonRecon", "whole"), ("RBF Surface", "Lacuna", "patches"),
        ("PoissonRecon", "PoissonRecon", "patches")]
TITLES = {"whole": "all points", "patches": "30 % missing"}
LEFT, CELL, TOP, BOTTOM = 64, (240, 222), 40, 80  # pixels
# mm, a decade each three colours
SCALE = [(0.01, (0.16, 0.30, 0.62)), (0.03, (0.30, 0.62, 0.80)), (0.1, (0.95, 0.95, 0.85)), (0.3, (0.98, 0.70, 0.30)), (1.0, (0.84, 0.19, 0.15)),
         (3.0, (0.35, 0.0, 0.10))]


def colors():
    table = vtkColorTransferFunction()
    table.SetScaleToLinear()  # of the logarithm
    for error, color in SCALE:
        table.AddRGBPoint(np.log10(error), *color)
    return table


def shown(mesh, name, table):
    points, _ = corners(mesh)
    array = numpy_to_vtk(np.log10(np.maximum(np.abs(shapes.make(name).distance(points)), 1e-6)), deep=True)
    mesh.GetPointData().SetScalars(array)
    normals = vtkPolyDataNormals()
    normals.SetInputData(mesh)
    normals.SetFeatureAngle(40)
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    mapper.SetLookupTable(table)
    mapper.UseLookupTableScalarRangeOn()
    mapper.InterpolateScalarsBeforeMappingOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(0.25)
    actor.GetProperty().SetDiffuse(0.75)
    return actor


def text(words, x, y, size=17, turned=False):
    actor = vtkTextActor()
    actor.SetInput(words)
    actor.SetPosition(x, y)
    style = actor.GetTextProperty()
    style.SetFontSize(size)
    style.SetColor(0.1, 0.1, 0.1)
    style.SetJustificationToCentered()
    style.SetVerticalJustificationToCentered()
    if turned:
        style.SetOrientation(90)
    return actor


def legend(table):
    bar = vtkScalarBarActor()
    bar.SetLookupTable(table)
    bar.SetOrientationToHorizontal()
    bar.SetNumberOfLabels(0)
    bar.SetPosition(0.25, 0.4 * BOTTOM / (len(ROWS) * CELL[1] + TOP + BOTTOM))
    bar.SetWidth(0.5)
    bar.SetHeight(0.03)
    bar.SetBarRatio(1)
    bar.SetMaximumNumberOfColors(256)
    return bar


def main(folder, picture, sigma="0.2"):
    with open(os.path.join(folder, "results.csv"), encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["part"] == "cases"]

    class Options:
        out = folder
    width, height = LEFT + len(shapes.NAMES) * CELL[0], TOP + len(ROWS) * CELL[1] + BOTTOM
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(width, height)
    page = vtkRenderer()
    page.SetBackground(1, 1, 1)
    window.AddRenderer(page)
    table = colors()
    for column, name in enumerate(shapes.NAMES):
        page.AddActor2D(text(name, LEFT + (column + 0.5) * CELL[0], height - TOP / 2, 20))
    for line, (title, program, kind) in enumerate(ROWS):
        bottom = BOTTOM + (len(ROWS) - 1 - line) * CELL[1]
        page.AddActor2D(text(f"{title}\n{TITLES[kind]}", LEFT / 2, bottom + CELL[1] / 2, turned=True))
        for column, name in enumerate(shapes.NAMES):
            row = best([row for row in rows if row["program"] == program and row["case"] == f"{name}, {sigma} mm, {kind}"
                        and os.path.exists(mesh_path(Options, row))])
            if row is None:
                sys.exit(f"there is no mesh of {program}: {name}, {sigma} mm, {kind}. Run surface_peers.py with --parts cases --again {program}")
            left = LEFT + column * CELL[0]
            view = vtkRenderer()
            view.SetBackground(1, 1, 1)
            view.SetViewport(left / width, (bottom + 26) / height, (left + CELL[0]) / width, (bottom + CELL[1]) / height)
            view.AddActor(shown(read_mesh(mesh_path(Options, row)), name, table))
            camera = view.GetActiveCamera()
            camera.SetPosition(-0.55, -1, 0.75)
            camera.SetFocalPoint(0, 0, 0)
            camera.SetViewUp(0, 0, 1)
            camera.ParallelProjectionOn()
            view.ResetCamera()
            camera.SetFocalPoint(0, 0, 0)
            camera.SetPosition(-110, -200, 150)
            camera.SetParallelScale(54)
            view.ResetCameraClippingRange()
            window.AddRenderer(view)
            page.AddActor2D(text(f"RMS {float(row['rms']):.3f} mm", left + CELL[0] / 2, bottom + 13, 15))
    bar = legend(table)
    page.AddActor2D(bar)
    for error, _ in SCALE:
        share = np.log(error / SCALE[0][0]) / np.log(SCALE[-1][0] / SCALE[0][0])
        page.AddActor2D(text(f"{error:g}", (0.25 + 0.5 * share) * width, 17, 15))
    page.AddActor2D(text("distance from the true surface, mm", 0.87 * width, 17, 15))
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetInputConnection(image.GetOutputPort())
    writer.SetFileName(picture)
    writer.Write()


if __name__ == "__main__":
    if not 3 <= len(sys.argv) <= 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
