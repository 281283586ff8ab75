# SPDX-License-Identifier: BSD-3-Clause
"""./demo.sh --live: emulated devices, a live acquisition, the recorded sweep against the scene, and Ctrl-C."""
import os
import shutil
import signal
import threading
import time

import numpy as np
import paraview.simple as pv
from lacuna import demo, demo_live
from lacuna.data import fetch
from lacuna_test import output
from vtkmodules.util.numpy_support import vtk_to_numpy

folder = output("demo-live")
shutil.rmtree(folder, ignore_errors=True)
report = demo.main(["--live", "--offscreen", "--seconds", "12", "--output", folder])

slices = report.get("slices")
assert slices > 100, slices
assert report.get("slices on disk") == f"{slices} in live-sweep.mhd", report.get("slices on disk")
assert report.get("open edges of the surface") == 0
volume = float(report.get("enclosed volume, ml"))
# 2 % too small; a computer with too much to do answers the tracker's requests late, which smears
assert abs(volume / demo_live.TRUE_VOLUME - 1) < 0.08, volume
assert report.get("pictures of the growing surface") > 0
film = sorted(os.listdir(os.path.join(folder, "live-film")))
assert len(film) > 1 and film[0] == "0000.png", film
for name in ("live.png", "live-calibration.xml", "report.md", "report.html"):
    assert os.path.getsize(os.path.join(folder, name)) > 200, name
assert report.verdict()[0] is True and "the live surface's volume" in report.verdict()[1], report.verdict()

# the sweep on the disk: each slice is of the place that its pose says
reader = pv.TrackedSliceReader(FileName=os.path.join(folder, "live-sweep.mhd"))
reader.UpdatePipeline()
sweep = fetch(reader)
calibrated = pv.TrackedSliceReader(FileName=os.path.join(folder, "live-sweep.mhd"),
                                   CalibrationFileName=os.path.join(folder, "live-calibration.xml"))
again = vtk_to_numpy(fetch(calibrated).GetFieldData().GetArray("ImageToReference"))
assert np.allclose(again, vtk_to_numpy(sweep.GetFieldData().GetArray("ImageToReference")), atol=1e-6, equal_nan=True)
columns, rows, count = sweep.GetDimensions()
assert count == slices, (count, slices)
grey = vtk_to_numpy(sweep.GetPointData().GetScalars()).reshape(count, rows, columns)
poses = vtk_to_numpy(sweep.GetFieldData().GetArray("ImageToReference")).reshape(-1, 4, 4)
origin = np.array(sweep.GetOrigin())
truth = pv.PhantomSweep(Anatomy="Ellipsoids").GetClientSideObject()
random = np.random.default_rng(1)
right, mirrored = [], []
while len(right) < 2000:
    k, j, i = random.integers((count, rows - 8, columns - 8)) + (0, 4, 4)
    if grey[k, j - 4:j + 5, i - 4:i + 5].min() == 0:
        continue  # beside the sector
    level = truth.EvaluateTruth(*(poses[k] @ (i + origin[0], j + origin[1], 0, 1))[:3])
    if abs(level - 60) > 30:  # not the tissue around
        # a small mean, for the speckle
        right.append(grey[k, j - 4:j + 5, i - 4:i + 5].mean() - level)
        other = columns - 1 - i
        mirrored.append(grey[k, j - 4:j + 5, other - 4:other + 5].mean() - level)
print("levels off:", np.mean(right), np.mean(np.abs(right)), "mirrored", np.mean(np.abs(mirrored)))
assert abs(np.mean(right)) < 12 and np.mean(np.abs(right)) < 25, (np.mean(right), np.mean(np.abs(right)))
assert np.mean(np.abs(mirrored)) > 2 * np.mean(np.abs(right)), np.mean(np.abs(mirrored))

# Ctrl-C ends it early, with results

def interrupt():
    while not os.path.exists(os.path.join(folder, "live-sweep-2.mhd")):
        time.sleep(0.1)
    time.sleep(2)
    os.kill(os.getpid(), signal.SIGINT)


threading.Thread(target=interrupt, daemon=True).start()
report = demo.main(["--live", "--offscreen", "--seconds", "600", "--output", folder])
assert report.get("ended by") == "the user"
assert report.get("slices on disk") == f"{report.get('slices')} in live-sweep-2.mhd", report.get("slices on disk")
