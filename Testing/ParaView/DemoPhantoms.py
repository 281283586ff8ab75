# SPDX-License-Identifier: BSD-3-Clause
"""The demo on the phantoms: numbers against the truth, pictures against the baseline, and a report that says first whether all is well."""
import base64
import os
import re

import paraview.simple as pv
from lacuna import demo, demo_implant
from lacuna.demo_report import Report
from lacuna_test import compare_with_baseline, output

folder = output("demo-phantoms")
report = demo.main(["--output", folder])

for name in ("volume.vti", "surface.stl", "filled-depth-map.vti", "implant.igs", "report.md", "report.html"):
    assert os.path.getsize(os.path.join(folder, name)) > 1000, name
with open(os.path.join(folder, "report.md"), encoding="utf-8") as file:
    text = file.read()
for quantity in ("slices", "volume, voxels", "voxel, mm", "enclosed volume, ml", "true volume, ml", "depth map, pixels",
                 "nodes of the spline", "error against the intact phantom: RMS, mm", "IGES surface: largest deviation",
                 "![Left: one of 90", "](ultrasound.png)", "](implant.png)", "| the organ's volume |", "| yes |", "| reconstruct the volume |", "| fill the hole |", "| write the implant surface |"):
    assert quantity in text, quantity
assert report.get("open edges of the surface") == 0
volume, exact = float(report.get("enclosed volume, ml")), float(report.get("true volume, ml").split()[0])
assert abs(volume / exact - 1) < 0.015, (volume, exact)
# the spline's own error over a hole of 76 mm in bone that is curved like a skull
largest, rms = (float(report.get(f"error against the intact phantom: {which}, mm")) for which in ("largest", "RMS"))
assert largest < 0.4 and rms < 0.15, (largest, rms)
assert float(report.get("IGES surface: largest deviation from the fit, mm")) <= 0.005
for name in ("ultrasound.png", "implant.png"):
    compare_with_baseline(os.path.join(folder, name), name, 30)

# the first line is the verdict, and the numbers in it are those of the tables
first = text.splitlines()[0]
assert first.startswith("**All is well: the organ's volume differs from the truth by") and first.endswith("**"), first
told = [float(number) for number in re.search(r"by (\S+) %; .* by ([\d.]+) mm at most \(([\d.]+) mm RMS\)", first).groups()]
for number, own in zip(told, (100 * (volume / exact - 1), largest, rms), strict=True):
    assert abs(number - own) < 0.011, (first, own)  # of rounded numbers
with open(os.path.join(folder, "report.html"), encoding="utf-8") as file:
    page = file.read()
assert "All is well" in page.split("<h1>")[0], "the verdict comes first"
embedded = re.findall(r'src="data:image/png;base64,([^"]*)"', page)
for name, pixels in zip(("ultrasound.png", "implant.png"), embedded, strict=True):
    with open(os.path.join(folder, name), "rb") as file:
        assert base64.b64decode(pixels) == file.read(), name
assert 'src="' not in re.sub(r'src="data:[^"]*"', "", page), "the page needs no other file"

# what is off by more than is allowed is told in the first line
report = Report()
report.section("None")
report.compare("the organ's volume", "2 ml", "1 ml", "+100 %", "1.5 %", False)
assert report.verdict() == (False, "Not all is well: the organ's volume is off by +100 %, more than 1.5 %.")

# a CT whose hole is not marked: what rays saw through the hole is no bone that was there
ct = os.path.join(folder, "hole.vti")
skull = pv.SkullPhantom(**{**demo_implant.PHANTOM, "NoiseLevel": 0})
pv.SaveData(ct, proxy=skull, DataMode="Binary")
view = [str(-x) for x in demo_implant.PHANTOM["DefectDirection"]]
report = demo.main(["--only", "implant", "--ct", ct, "--output", folder, "--view", *view])
assert report.get("error").startswith("unknown: bone is missing there"), report.get("error")
assert not any("largest, mm" in what for _, rows in report.sections for what, _ in rows)
assert report.verdict()[0] is None and "no truth" in report.verdict()[1], report.verdict()
# marked with a margin of sound bone: only that bone is compared
direction = [x / sum(y * y for y in skull.DefectDirection) ** 0.5 for x in skull.DefectDirection]
depth = skull.GetClientSideObject().IntersectOuterSurface((0, 0, 0), direction)
hole = [str(depth * x) for x in direction] + ["50"]
report = demo.main(["--only", "implant", "--ct", ct, "--output", folder, "--view", *view, "--hole", *hole])
count, whole = map(int, re.match(r"(\d+) of (\d+); the others saw through", report.get("pixels where bone was there")).groups())
assert 0.2 < count / whole < 0.8, (count, whole)
assert float(report.get("error against the bone that was there: largest, mm")) < 5
