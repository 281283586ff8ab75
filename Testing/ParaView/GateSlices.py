# SPDX-License-Identifier: BSD-3-Clause
"""Gate Slices through ParaView: defaults, a table from a file, a beating heart, state."""
import os

import numpy as np
from paraview.simple import *
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy

from lacuna_test import check_defaults, output
from tracked_slice_files import array, open_slices

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna import vtkLacunaGateSlices

SLICES = 60  # 0.1 s apart, see tracked_slice_files


def phase(time):
    """Of a heart that beats 1.3 times a second."""
    return (1.3 * time + 0.2) % 1


def write_table(name, columns):
    path = output(name)
    with open(path, "w") as file:
        file.write(",".join(columns) + "\n")
        for row in zip(*columns.values()):
            file.write(",".join("%.9g" % value for value in row) + "\n")
    return CSVReader(FileName=[path])


def status(proxy):
    proxy.UpdatePipeline()
    fields = servermanager.Fetch(proxy).GetFieldData()
    return vtk_to_numpy(fields.GetArray("SliceStatus")).copy()


# a bright wall that moves up and down by 6 pixels with each beat
times = 0.1 * np.arange(SLICES)
wall = 20 + np.rint(6 * np.cos(2 * np.pi * phase(times)))
rows = np.arange(40)[None, :, None]
pixels = np.where(np.abs(rows - wall[:, None, None]) < 2, 200, 10) * np.ones((1, 1, 30))
poses = [np.diag([0.5, 0.5, 1, 1]) for _ in range(SLICES)]
for n, pose in enumerate(poses):
    pose[2, 3] = 0.2 * n
slices = open_slices("GateSlices", pixels.astype(np.uint8), poses)

proxy = GateSlices(Input=slices)
own = vtkLacunaGateSlices()
enumerations = {"GateType": ["Value", "Phase", "Trigger"], "MatchBy": ["Timestamp", "FrameNumber"]}
names = ["GateRange", "Period", "SpeedLimit", "GateColumn", "KeyColumn", "TimeOffset",
         "MaximumTimeGap"]
check_defaults(proxy, own, names, enumerations)

# speed alone needs no table: 2 mm/s
proxy.SpeedLimit = 1
assert (status(proxy) == 4).all()
proxy.SpeedLimit = 3
assert (status(proxy) == 0).all()
proxy.SpeedLimit = 0
Delete(proxy)

# the phase as a table of 20 samples a second; a fifth of the cycle, around its end
samples = np.arange(0, 6.5, 0.05)
table = write_table("GateSlicesPhase.csv", {"Time": samples, "Gate": phase(samples)})
proxy = GateSlices(Input=slices, GateTable=table, GateType="Phase", GateRange=[0.895, 0.105])
truth = (phase(times) > 0.895) | (phase(times) < 0.105)
assert (status(proxy) == np.where(truth, 0, 8)).all()
gate = vtk_to_numpy(servermanager.Fetch(proxy).GetFieldData().GetArray("Gate"))
assert np.abs((gate - phase(times) + 0.5) % 1 - 0.5).max() < 1e-6

# the wall stands still in the volume of the gated slices, and moves in that of all slices
def wall_movement(volume):
    """Standard deviation of the wall's row from layer to layer, in pixels."""
    filled = array(volume, "vtkValidPointMask").all(axis=(1, 2))
    bright = np.maximum(array(volume, "Intensity")[filled].astype(float).mean(axis=2) - 10, 0)
    return ((bright * np.arange(bright.shape[1])).sum(axis=1) / bright.sum(axis=1)).std()


volume = SweptVolume(Input=proxy, OutputSpacing=[0.5] * 3)
gated = wall_movement(volume)
volume.UseGatedOut = 1
ungated = wall_movement(volume)
print("the wall moves by %.2f pixels, by %.2f without gate" % (gated, ungated))
assert gated < 0.6 and ungated > 3

# the same from a file, whose fields are texts
gated_slices = GateSlices(Input=slices, GateTable=table, GateType="Phase", GateRange=[0, 1])
for kind in ("mha", "nrrd"):
    path = output("GateSlices." + kind)
    SaveData(path, gated_slices)
    again = OpenDataFile(path)
    again.UpdatePipeline()
    assert again.FieldData["Gate"].GetName() == "Gate"
    from_file = GateSlices(Input=again, GateType="Phase", GateRange=[0.895, 0.105])
    assert (status(from_file) == np.where(truth, 0, 8)).all(), kind
    assert np.array_equal(vtk_to_numpy(servermanager.Fetch(from_file).GetFieldData().GetArray("Gate")), gate)

# R waves
waves = (np.arange(10) - 0.2) / 1.3
table = write_table("GateSlicesWaves.csv", {"Timestamp": waves})
proxy.GateTable = table
proxy.GateType = "Trigger"
assert (status(proxy) == np.where(truth, 0, 8)).all()

# arrays that have nothing for the slices that there are
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkTable
from vtkmodules.vtkCommonCore import vtkDoubleArray
bare, gates = vtkImageData(), vtkTable()
bare.SetDimensions(4, 4, 2)
bare.AllocateScalars(3, 1)
for field in ("SliceStatus", "FrameNumber", "Timestamp"):
    for holder in (bare.GetFieldData(), gates.GetRowData()):
        numbers = vtkDoubleArray()
        numbers.SetName(field)
        holder.AddArray(numbers)
own.SetInputData(0, bare)
own.SetInputData(1, gates)
heard = []
own.AddObserver("ErrorEvent", lambda *_: heard.append(1))
own.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
for key in (own.Timestamp, own.FrameNumber):
    own.SetMatchBy(key)
    own.SetGateColumn("Timestamp")
    own.Update()
    assert heard, key
    heard.clear()

# state
name = output("GateSlices.pvsm")
SaveState(name)
ResetSession()
LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
LoadState(name)
loaded = next(p for (n, _), p in GetSources().items() if n.startswith("GateSlices"))
assert loaded.GateType == "Trigger" and list(loaded.GateRange) == [0.895, 0.105]
assert (status(loaded) == np.where(truth, 0, 8)).all()
print("ok")
