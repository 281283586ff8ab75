# SPDX-License-Identifier: BSD-3-Clause
"""Runs the example of RBF Hole Filler: its pictures and numbers are those that the user guide shows."""
import os
import runpy
import sys

import numpy as np
from lacuna_test import output
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

DOCUMENTATION = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Documentation")
EXAMPLE = os.path.join(DOCUMENTATION, "Examples", "09-hole-in-a-skull")


def pixels(name):
    reader = vtkPNGReader()
    reader.SetFileName(name)
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(float)


folder = output("filling-a-hole")
sys.argv = ["kernels.py", folder]
largest = runpy.run_path(os.path.join(EXAMPLE, "kernels.py"), run_name="__main__")["largest"]
with open(os.path.join(DOCUMENTATION, "UserGuide", "rbf-hole-filler.md"), encoding="utf-8") as file:
    guide = file.read()
for (title, name), error in largest.items():
    assert "| %s | %s | %.2f |" % (name, title, error) in guide, (title, name, error)
for name in ("kernels.png", "kernels-smoothed.png"):
    assert "09-hole-in-a-skull/" + name in guide
    difference = np.abs(pixels(os.path.join(folder, name)) - pixels(os.path.join(EXAMPLE, name))).mean()
    assert difference < 2, (name, difference)  # fonts and drivers differ
