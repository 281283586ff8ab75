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
example = os.path.abspath(os.path.join(os.path.dirname(__file__), "../../Documentation/Examples/11-implant-to-mould"))
folder = output("CTHeadImplant")
sys.argv = ["implant_to_mould.py", "--output", folder, "--ct", head, "--hole", "84", "105", "100", "30"]
printed = io.StringIO()
with contextlib.redirect_stdout(printed):
    runpy.run_path(os.path.join(example, "implant_to_mould.py"), run_name="__main__")
text = printed.getvalue()
print(text)


def value(words):
    """What the script prints behind a check, before its ok."""
    return re.search(re.escape(words) + r"[^\n]*?  +([^\n]*?) +ok\n", text)[1]


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

# the table of checks
beside, near, far = value("bone beside the filled hole"), value("plate's points within"), value("plate's point farthest")
beside_path = value("program's places are all on the path")
least, most = value("mould.stl back in the patient").split(" .. ")
for row in (f"| {beside} mm at most |", f"| {near} of its points within 0.02 mm, none before it; {far} mm |",
            f"`PressToPatient` | {value('press to patient is a rotation')} |", f"| {least} to {most} mm of 0.7 |",
            f"| {beside_path} mm beside it at most |",
            f"| {value('tool within the part')} mm at most |"):
    assert row in guide, row
assert text.count(" ok\n") == 10 and "WRONG" not in text

for name in ("0-ct", "1-hole", "2-marked", "2-filled", "3-plate", "4-model", "5-mould", "6-path", "7-left-over"):
    compare_with_baseline(os.path.join(folder, name + ".png"), os.path.join(example, name + ".png"), 60)
print("done")
