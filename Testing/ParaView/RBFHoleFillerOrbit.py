# SPDX-License-Identifier: BSD-3-Clause
"""The awkward defect: a disc of 8 mm radius between a saw cut and the rim of an orbit, from the front.

Behind the rim lies the roof of the orbit: what is beyond a depth step or too steep must be left out or named,
and the bone that was there be restored as well as a narrow margin lets it.
"""
import os

import lacuna
import numpy as np
from lacuna_test import data
from paraview import servermanager
from paraview.simple import LoadPlugin, OpenDataFile
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())

caster = BSplineIsoRayCaster(
    Input=OpenDataFile(data("ct_head/head.mha")), IsoValues=[500], Interpolation="InterpolatingBSpline",
    ViewDirection=[0, -0.9, -0.45], ViewUp=[0, 0, 1])
caster.UpdatePipeline()
depth_map = servermanager.Fetch(caster)
columns, rows, _ = depth_map.GetDimensions()
x, y = np.meshgrid(np.arange(columns), np.arange(rows))
defect = np.hypot(x - 120, y - 180) * depth_map.GetSpacing()[0] <= 8
array = numpy_to_vtk(defect.ravel().astype(np.int8), deep=1)
array.SetName("Defect")
depth_map.GetPointData().AddArray(array)
warnings = []
filler = lacuna.vtkLacunaRBFHoleFiller()


def keep(_, __, text):
    warnings.append(text)


keep.CallDataType = "string0"
filler.AddObserver("WarningEvent", keep)
filler.SetInputData(depth_map)
filler.SetDefectArray("Defect")


def fill():
    """Pixels of each SupportMask, largest error and RMS, mm."""
    warnings.clear()
    filler.Update()
    points = filler.GetOutput().GetPointData()
    use, deviation = (vtk_to_numpy(points.GetArray(name)).reshape(rows, columns)
                      for name in ("SupportMask", "Deviation"))
    counts = [int((use == value).sum()) for value in range(6)]
    error = deviation[defect]
    figures = np.abs(error).max(), np.sqrt((error ** 2).mean())
    print("used %d, beyond a step %d, steep %d, near a step %d pixels; largest error %.2f, RMS %.2f mm" % (
        counts[1], counts[2], counts[3], counts[5], *figures))
    return counts, *figures


filler.SetSupportMargin(8)
filler.SetSupportStepMargin(0)
counts, largest, rms = fill()
assert counts[2] > 0 and any("beyond a depth step" in w and "first at column" in w for w in warnings)
assert counts[3] > 0 and any("steeper than 65 degrees" in w for w in warnings)
assert largest < 1.5 and rms < 0.7

# With the settings of the user guide for large holes it is the margin to steps that keeps the brow out.
filler.SetKernel(lacuna.choices(filler, "Kernel")["Cubic"])
filler.SetSupportMargin(20)
filler.SetNodeSpacing(2)
filler.SetCutoffWavelength(10)
largest, rms = fill()[1:]
assert largest > 3 and rms > 1.5
filler.SetSupportStepMargin(3)
counts, largest, rms = fill()
assert counts[5] > 500 and counts[3] == 0 and not any("steeper than 65 degrees" in w for w in warnings)
assert abs(largest - 0.88) < 0.03 and abs(rms - 0.41) < 0.02  # as the guide says
