# SPDX-License-Identifier: BSD-3-Clause
"""The way from a CT to an implant on the CT of a real skull: the guide's numbers and pictures are true."""
import contextlib
import io
import os
import re
import runpy
import sys

from lacuna_test import compare_with_baseline, data, output

head = data("ct_head/head.mha")
example = os.path.abspath(os.path.join(os.path.dirname(__file__), "../../Documentation/Examples/06-implant-to-mould"))
folder = output("CTHeadImplant")
sys.argv = ["implant_to_mould.py", "--output", folder, "--ct", head, "--hole", "84", "105", "100", "30"]
printed = io.StringIO()
with contextlib.redirect_stdout(printed):
    runpy.run_path(os.path.join(example, "implant_to_mould.py"), run_name="__main__")
text = printed.getvalue()
print(text)

with open(os.path.join(example, "../../UserGuide/cranioplasty.md"), encoding="utf-8") as page:
    guide = page.read()
worst, rms = re.search(r"there: ([\d.]+) mm at most, ([\d.]+) mm RMS", text).groups()
assert f"**{worst} mm at most and {rms} mm RMS**" in guide, (worst, rms)
millilitres, grams, thinnest = re.search(r"plate: ([\d.]+) ml, ([\d.]+) g, thinnest ([\d.]+) mm", text).groups()
assert f"{millilitres} ml, {grams} g of PEEK, thinnest {thinnest} mm" in guide, (millilitres, grams, thinnest)
deep, walls = re.search(r"mould: ([\d.]+) mm deep, walls up to (\d+) degrees", text).groups()
assert f"{deep} mm deep, walls up to {walls}°" in guide, (deep, walls)
metres, minutes = re.search(r"milling: ([\d.]+) m of cuts, (\d+) min", text).groups()
assert f"{metres} m of cuts, {minutes} min" in guide, (metres, minutes)
assert text.count(" ok\n") == 9 and "WRONG" not in text

for name in ("2-filled", "3-plate", "4-model", "5-mould"):
    compare_with_baseline(os.path.join(folder, name + ".png"), os.path.join(example, name + ".png"), 60)
print("done")
