# SPDX-License-Identifier: BSD-3-Clause
"""An example of Documentation/Examples: Example.py <folder> <script> [arguments of the script before the folder to write to].

Its script runs without an error and writes a picture that looks like the one in the folder, and a state file. It warns
of nothing but what the folder's README.md tells. The state file in the folder says the same as the one it wrote; where
it says something else, or LACUNA_LOAD_STATES is set, it is loaded, into what the script made, value by value.
"""
import glob
import os
import re
import shutil
import sys

import lacuna.plugin

lacuna.plugin.load()
import pipelines
from lacuna import states
from lacuna.errors import raising
from lacuna_test import ROOT, check_warnings, output, picture_error, run_example
from paraview.simple import *

TOLERANCE = 60  # of vtkImageDifference: other fonts and drivers



def statement(path):
    """What a state file says: its lines, with proxies numbered in the order in which it mentions them."""
    numbers = {}
    with open(path, encoding="utf-8") as file:
        return re.sub(r'\b(id|value|view)="([1-9]\d{2,})\b',
                      lambda found: f'{found[1]}="#{numbers.setdefault(found[2], len(numbers))}', file.read()).splitlines()


folder = os.path.join(ROOT, "Documentation", "Examples", sys.argv[1])
written = os.path.abspath(output(os.path.join("Examples", sys.argv[1])))
shutil.rmtree(written, ignore_errors=True)
os.makedirs(written)
run_example(os.path.join(sys.argv[1], sys.argv[2]), *sys.argv[3:], written)
made = pipelines.outputs()
assert made, "the script leaves no pipeline"

pictures = [os.path.basename(name) for name in glob.glob(os.path.join(written, "*.png"))]
names = [os.path.basename(name) for name in glob.glob(os.path.join(written, "*.pvsm"))]
assert len(names) == 1, names
assert os.path.exists(os.path.join(folder, names[0])), f"copy {written}/{names[0]} to {folder}"
picture = names[0][:-4] + "png"
assert picture in pictures, (picture, pictures)
for name in pictures:
    error = picture_error(os.path.join(written, name), os.path.join(folder, name))
    assert error <= TOLERANCE, f"look at {written}/{name}: it differs from the one in {folder} by {error:.0f}"

for place in (written, folder):
    state = os.path.join(place, names[0])
    assert os.path.getsize(state) < 250000, f"{state}: write it by lacuna.states.save"
    with open(state, encoding="utf-8") as file:
        text = file.read()
    for path in (ROOT, written, os.path.expanduser("~") + os.sep):
        assert path not in text, f"{state} belongs to this computer: {path}"

if "LACUNA_LOAD_STATES" not in os.environ and statement(os.path.join(written, names[0])) == statement(state):
    print(f"{os.path.relpath(state, ROOT)}: what the script writes")
    sys.exit()

warnings = []
with raising(warnings):
    states.load(state)
    pipelines.check_same(made, pipelines.outputs(), state)
    shown = [view for view in GetRenderViews() if GetLayout(view) is not None]
    assert shown, f"{state} has no view in a layout"
    for view in shown:
        Render(view)
        assert any(display.Visibility for display in view.Representations), f"a view of {state} shows nothing"
print(f"{os.path.relpath(state, ROOT)}: {len(made)} outputs as the script made them, {len(shown)} views")
old_format = "is a printf format. The format will be converted to std::format"  # the page before all examples tells of it
check_warnings([text for text in warnings if old_format not in text], os.path.join(folder, "README.md"))
