# SPDX-License-Identifier: BSD-3-Clause
"""The example of a live acquisition: its sweep, its surface against the scene, its picture and its state files."""
import os
import shutil

import lacuna.plugin

lacuna.plugin.load()
import numpy as np
from lacuna import demo_live, demo_ultrasound, pictures, states
from lacuna.errors import raising
from lacuna_test import ROOT, check_warnings, output, run_example
from paraview.simple import *

folder = os.path.join(ROOT, "Documentation", "Examples", "02-live-acquisition")
written = os.path.abspath(output(os.path.join("Examples", "02-live-acquisition")))
shutil.rmtree(written, ignore_errors=True)
port = demo_live.free_port()
made = run_example("02-live-acquisition/live_acquisition.py", written, str(port))
warnings = []
largest = Connectivity(Input=made["surface"], ExtractionMode="Extract Largest Region", ColorRegions=0)
enclosed, open_edges = demo_ultrasound.measure(ExtractSurface(Input=largest))
print(f"{enclosed:.2f} ml, {demo_live.TRUE_VOLUME:.2f} ml in truth, {open_edges} open edges")
assert open_edges == 0 and abs(enclosed / demo_live.TRUE_VOLUME - 1) < 0.08  # a computer with too much to do smears
reader = TrackedSliceReader(FileName=os.path.join(written, "live-acquisition.mhd"))
with raising(warnings):
    reader.UpdatePipeline()
assert reader.GetDataInformation().GetExtent()[5] > 50
own, shown = (pictures.read_pixels(os.path.join(place, "live-acquisition.png")) for place in (written, folder))
assert own.shape == shown.shape
tissue = [np.mean(pixels[..., 0].astype(int) - pixels[..., 2] > 40) for pixels in (own, shown)]
assert 0.01 < tissue[0] < 0.5 and abs(tissue[0] / tissue[1] - 1) < 0.2, tissue


def settings(state):
    """What a state file says of the source and of the filters behind it; nothing is opened, and nothing is an error."""
    with raising(warnings):
        states.load(state)
        for source in GetSources().values():
            source.UpdatePipeline()
    scanner = FindSource("Scanner")
    scanner.SMProxy.UpdatePropertyInformation()
    assert not scanner.GetProperty("VideoWorks").GetData() and not scanner.GetProperty("TrackerWorks").GetData()
    names = [prop for prop in scanner.ListProperties() if hasattr(type(scanner.GetProperty(prop)), "GetData")
             and not scanner.GetProperty(prop).SMProperty.GetInformationOnly()]
    found = {prop: str(scanner.GetProperty(prop).GetData()).replace(str(port), "5004") for prop in names}
    return found, sorted(name for name, _ in GetSources()), list(FindSource("Volume").FanRadii)


first, second = (settings(os.path.join(place, "live-acquisition.pvsm")) for place in (written, folder))
assert first == second, (first, second)
assert first[0]["VideoURL"] == "tcp://127.0.0.1:5004" and first[1] == ["Median", "Scanner", "Slices", "Surface", "Volume"], first
check_warnings(warnings, os.path.join(folder, "README.md"))
