# SPDX-License-Identifier: BSD-3-Clause
"""The demo on the phantoms: numbers against the truth, pictures against the baseline."""
import os

from lacuna import demo
from lacuna_test import compare_with_baseline, output

folder = output("demo-phantoms")
report = demo.main(["--output", folder])

for name in ("volume.vti", "surface.stl", "filled-depth-map.vti", "implant.igs", "report.md"):
    assert os.path.getsize(os.path.join(folder, name)) > 1000, name
with open(os.path.join(folder, "report.md"), encoding="utf-8") as file:
    text = file.read()
for quantity in ("slices", "volume, voxels", "voxel, mm", "enclosed volume, ml", "true volume, ml", "depth map, pixels",
                 "nodes of the spline", "error against the intact phantom: RMS, mm", "IGES surface: largest deviation",
                 "| reconstruct the volume |", "| fill the hole |", "| write the implant surface |"):
    assert quantity in text, quantity
assert report.get("open edges of the surface") == 0
volume, exact = float(report.get("enclosed volume, ml")), float(report.get("true volume, ml").split()[0])
assert abs(volume / exact - 1) < 0.015, (volume, exact)
# the spline's own error over a hole of 78 mm in bone that is curved like a skull
assert float(report.get("error against the intact phantom: largest, mm")) < 0.7
assert float(report.get("error against the intact phantom: RMS, mm")) < 0.2
assert float(report.get("IGES surface: largest deviation from the fit, mm")) <= 0.005
for name in ("ultrasound.png", "implant.png"):
    compare_with_baseline(os.path.join(folder, name), name, 30)
