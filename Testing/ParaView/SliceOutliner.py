# SPDX-License-Identifier: BSD-3-Clause
"""Slice Outliner, Outlined Structures and lacuna.outlines in pvpython: the phantom's volume, state files, CSV, outlines in mm."""
import os
import time

import lacuna
import numpy as np
from lacuna_test import check_defaults, output
from paraview import servermanager
from paraview.simple import *

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna import outlines, states
from lacuna.data import fetch
from lacuna.errors import PipelineError, raising

sweep = PhantomSweep(registrationName="Sweep", Motion="Fan", NumberOfSlices=60)
sweep.UpdatePipeline()
truth = sweep.TrueVolume / 1000  # ml
outliner = SliceOutliner(registrationName="Outliner", Input=sweep)
assert 20 < outliner.Slice < 40, outliner.Slice  # the middle one is shown
check_defaults(outliner, lacuna.vtkLacunaSliceOutliner(), ["Smooth"], {})
structures = OutlinedStructures(registrationName="Structures", Input=outliner)
check_defaults(structures, lacuna.vtkLacunaOutlinedStructures(), ["RegistrationError", "Smoothing", "OutputSpacing"], {})


def slices_of_object():
    """Those in which the contour of the phantom's object is found, and its area in pixels."""
    found = {}
    for number in range(60):
        try:
            points = outlines.trace(outliner, "Probe", number, 120, region=(60, 260, 40, 200))
        except ValueError:
            continue
        x, y = points.T
        area = 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
        outlines.remove(outliner, "Probe", number)
        if area > 40:
            found[number] = area
    return found


areas = slices_of_object()
first, last = min(areas), max(areas)
middle, half = (first + last) / 2, (last - first) / 2
chosen = [round(middle + part * half) for part in (-0.9, -0.5, 0, 0.5, 0.9)]
print(f"the object is in slices {first} to {last}; outlined: {chosen}")

# Five traced outlines: the phantom's volume. Each further outline within half a second.
outliner.StructureNames, outliner.OutlinePoints = [], []
for number in chosen:
    outlines.trace(outliner, "Organ", number, 120, region=(60, 260, 40, 200))
    begin = time.monotonic()
    with raising():
        structures.UpdatePipeline()
    print(f"{number}: {time.monotonic() - begin:.2f} s for the surface")
row = outlines.table(structures)["Organ"]
print(f"{row['Volume (ml)']:.3f} ml, standard error {row['Standard error (ml)']:.3f}; truth {truth:.3f}")
assert row["Outlines"] == 5 and row["Status"] == ""
assert abs(row["Volume (ml)"] / truth - 1) < 0.01
assert abs(row["Largest diameter (mm)"] - 34) < 0.7
places = {outline["slice"]: outline["points"] for outline in outlines.get(outliner)}
assert sorted(places) == chosen

# A registration error makes the standard error larger, and nothing else.
structures.RegistrationError = 1
wider = outlines.table(structures)["Organ"]
assert wider["Volume (ml)"] == row["Volume (ml)"] and wider["Standard error (ml)"] > 2 * row["Standard error (ml)"]
structures.RegistrationError = 0

# Saved and loaded: the same points, the same surface bit for bit.
path = output("outlines.csv")
outlines.save(outliner, path)
again = SliceOutliner(Input=sweep)
assert outlines.load(again, path) == 5
for old, new in zip(outlines.get(outliner), outlines.get(again)):
    assert old["slice"] == new["slice"] and np.abs(old["points"] - new["points"]).max() < 1e-5
loaded = outlines.table(OutlinedStructures(Input=again))["Organ"]
assert abs(loaded["Volume (ml)"] / row["Volume (ml)"] - 1) < 1e-5, (loaded, row)

# Outlines in mm, as another program has them: into the slices in which they lie.
with raising():
    outliner.UpdatePipeline()
taken = SliceOutliner(Input=sweep)
assert outlines.take(taken, outliner) == 5
assert sorted(outline["slice"] for outline in outlines.get(taken)) == chosen
volume = outlines.table(OutlinedStructures(Input=taken))["Organ"]["Volume (ml)"]
assert abs(volume / row["Volume (ml)"] - 1) < 0.003, volume
# ParaView's own files: the lines, and the table.
lines = output("outlines.vtp")
SaveData(lines, proxy=outliner, DataMode="Binary")
taken = SliceOutliner(Input=sweep)
assert outlines.take(taken, XMLPolyDataReader(FileName=[lines])) == 5
volume = outlines.table(OutlinedStructures(Input=taken))["Organ"]["Volume (ml)"]
assert abs(volume / row["Volume (ml)"] - 1) < 0.003, volume
SaveData(output("structures.csv"), proxy=OutputPort(structures, 1))
with open(output("structures.csv"), encoding="utf-8") as file:
    titles, numbers = (line.strip().replace('"', "").split(",") for line in file)
assert abs(float(numbers[titles.index("Volume (ml)")]) - row["Volume (ml)"]) < 1e-4, numbers
moved = Transform(Input=outliner)
moved.Transform.Translate = [0, 0, 4]
try:
    outlines.take(taken, moved, distance=0.1)
    raise AssertionError("outlines beside the slices were taken")
except ValueError as error:
    assert "lies in no slice" in str(error), error

# They are in the state file.
state = output("slice-outliner.pvsm")
kept = list(outliner.OutlinePoints)
with raising():
    states.save(state)
    states.load(state)
outliner, structures = FindSource("Outliner"), FindSource("Structures")
assert list(outliner.OutlinePoints) == kept and list(outliner.StructureNames) == ["Organ"]
assert outlines.table(structures)["Organ"]["Volume (ml)"] == row["Volume (ml)"]

# A volume: the voxel planes are the slices; the picture follows.
volume = SweptVolume(Input=FindSource("Sweep"), OutputSpacing=[0.8, 0.8, 0.8])
volume.UpdatePipeline()
of_volume = SliceOutliner(Input=volume)
extent = volume.GetDataInformation().GetExtent()
assert of_volume.Slice == (extent[4] + extent[5]) // 2, (of_volume.Slice, extent)
picture = fetch(servermanager.OutputPort(of_volume, 1))
assert picture.GetExtent() == (*extent[:4], 0, 0), (picture.GetExtent(), extent)

# Every second pixel of the sweep: the same volume.
subset = ExtractSubset(Input=FindSource("Sweep"), VOI=[0, 319, 0, 239, 0, 59], SampleRateI=2, SampleRateJ=2)
strided = SliceOutliner(Input=subset)
for number in chosen:
    outlines.trace(strided, "Organ", number, 120, region=(60, 260, 40, 200))
volume = outlines.table(OutlinedStructures(Input=strided))["Organ"]["Volume (ml)"]
assert abs(volume / truth - 1) < 0.015, volume

# Structures of the same name are told of; names and numbers that are there stay.
named = SliceOutliner(Input=FindSource("Sweep"), StructureNames=["", "Organ", "Organ"])
named.OutlinePoints = [value for structure in (2, 3) for number in chosen for column, row in places[number] for value in (structure, number, number, column, row)]
outlines.add(named, "Cyst", chosen[2], [(10, 10), (20, 10), (15, 20)])
assert {outline["index"] for outline in outlines.get(named)} == {2, 3, 4}, outlines.get(named)
try:
    outlines.table(OutlinedStructures(Input=named))
    raise AssertionError("no error")
except ValueError as error:
    assert "several structures are called Organ" in str(error), error

# What cannot be is an error.
for points, words in (((1, 0, 99, 1, 1, 1, 0, 99, 5, 1, 1, 0, 99, 5, 5), "a slice that is not there; the slices are 0 to 59"),
                      ((1, 0, 9, 1, 1, 1, 0, 9, 5, 1), "it needs at least 3")):
    bad = SliceOutliner(Input=FindSource("Sweep"), OutlinePoints=list(points))
    try:
        with raising():
            bad.UpdatePipeline()
        raise AssertionError("no error")
    except PipelineError as error:
        assert words in str(error), error
for call, words in ((lambda: outlines.add(outliner, "Organ", 1, [(1, 2), (3, 4)]), "three or more points"),
                    (lambda: outlines.remove(outliner, "Organ", 1), "no outline in slice 1"),
                    (lambda: outlines.trace(outliner, "Organ", 1, 255), "no closed contour at 255")):
    try:
        call()
        raise AssertionError(f"no error: {words}")
    except ValueError as error:
        assert words in str(error), error
