# SPDX-License-Identifier: BSD-3-Clause
"""Runs the example of the speckle filters: its pictures and numbers are those that the user guide shows."""
import os
import re

import numpy as np
from lacuna_test import output, run_example
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

DOCUMENTATION = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Documentation")
EXAMPLE = os.path.join(DOCUMENTATION, "Examples", "05-speckle-filters")


def pixels(name):
    reader = vtkPNGReader()
    reader.SetFileName(name)
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())


def text(*names):
    with open(os.path.join(*names), encoding="utf-8") as file:
        return file.read()


folder = output("speckle-filters")
run_example("05-speckle-filters/speckle-filters.py", folder)

guide = text(DOCUMENTATION, "UserGuide", "speckle-filter.md")
table = text(folder, "speckle-filters.md")
assert table in guide and table == text(EXAMPLE, "speckle-filters.md"), "the guide's table is not up to date"
csr = {line.split("|")[1].strip(): line.split("|")[2].strip() for line in table.splitlines()[2:]}
for label, after in csr.items():
    caption = f"CSR {csr['none']}" if label == "none" else f"CSR {csr['none']} → {after}"
    assert caption in guide, (label, caption)

shown = re.findall(r"05-speckle-filters/(\S+\.png)", guide)
assert len(shown) == len(csr) + 1 and set(shown) == {name for name in os.listdir(folder) if name.endswith(".png")}
for name in shown:
    assert np.array_equal(pixels(os.path.join(folder, name)), pixels(os.path.join(EXAMPLE, name))), name
print(f"ok: {len(shown)} pictures")
