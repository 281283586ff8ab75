# SPDX-License-Identifier: BSD-3-Clause
"""Temporal Calibration through ParaView: a video that is late by a known time."""
import os

import numpy as np
from paraview.simple import *
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy

import calibration_scans as scans
from lacuna_test import check_defaults

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna import vtkLacunaTemporalCalibration
from lacuna.errors import PipelineError, raising

random = np.random.default_rng(8)
times = 3 + np.arange(250) / 25


def scan(time):
    """To and fro above the floor, the image a little askew."""
    height = 8 * np.sin(6.1 * time) + 4 * np.sin(3.7 * time + 1)
    turn = scans.rotation([0, 1, 0], 8) @ np.column_stack([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    return scans.pose(turn, [0, 0, 35 + height])


LATE = 0.083
poses = [scans.probe_to_tracker(scan(t)) for t in times]
pictures = [scans.wall_picture(scan(t - LATE), random) for t in times]
slices = scans.open_scan("TemporalCalibration", np.array(pictures), poses, times)
proxy = TemporalCalibration(Input=slices)
check_defaults(proxy, vtkLacunaTemporalCalibration(), ["MaximumLag"])
with raising():
    proxy.UpdatePipeline()
table = servermanager.Fetch(proxy)
offset, spread = (table.GetFieldData().GetArray(name).GetValue(0) for name in ("TimeOffset", "LagSpread"))
print("TimeOffset", offset, "+-", spread)
assert abs(offset + LATE) < 0.002 and spread < 0.001
lags, correlations = (vtk_to_numpy(table.GetColumnByName(name)) for name in ("Lag", "Correlation"))
assert abs(lags[correlations.argmax()] - LATE) < 0.006 and correlations.max() > 0.99
proxy.MaximumLag = 0.05
try:
    with raising():
        proxy.UpdatePipeline()
    raise AssertionError("a lag outside of the range was found")
except PipelineError as error:
    assert "raise MaximumLag" in str(error), error
