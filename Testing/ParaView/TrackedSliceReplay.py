# SPDX-License-Identifier: BSD-3-Clause
"""A sweep that is written, read again and replayed: nothing is forgotten on the way."""
import os

from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

import lacuna.plugin

lacuna.plugin.load()
from paraview.simple import *  # the proxies of the plugin

FILE = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "TrackedSliceReplay.igs.mha")
FLAGS = [0, 4, 0, 1, 5, 8, 2, 0]  # slice 3 is refused though its pose has numbers

MARK = """
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
output = self.GetOutputDataObject(0)
output.ShallowCopy(self.GetInputDataObject(0, 0))
flags = numpy_to_vtk(np.array(%s, 'u1'), 1)
flags.SetName('SliceStatus')
output.GetFieldData().AddArray(flags)
""" % FLAGS


def field(proxy, name):
    return vtk_to_numpy(servermanager.Fetch(proxy).GetFieldData().GetArray(name))


def count(volume, time):
    volume.UpdatePipeline(time)
    return int(vtk_to_numpy(servermanager.Fetch(volume).GetPointData().GetArray("Contributions")).sum())


phantom = PhantomSweep(NumberOfSlices=8, ImageSize=[40, 30], PixelSpacing=1.5)
flagged = ProgrammableFilter(Input=phantom, Script=MARK)
flagged.UpdatePipeline()
SaveData(FILE, flagged)
again = TrackedSliceReader(FileName=FILE)
assert (field(again, "SliceStatus") == FLAGS).all(), field(again, "SliceStatus")
assert (field(again, "ImageToReference") == field(flagged, "ImageToReference")).all()

# A volume of two sweeps grows whichever of the two is replayed, and is what a new one would be.
SaveData(FILE, phantom)
replay = TrackedSliceReader(FileName=FILE, ReplayInTime=1)
replay.UpdatePipelineInformation()
times = list(replay.TimestepValues)
assert len(times) == 8
grid = {"OutputSpacing": [1.5] * 3, "OutputBounds": [-10, 10] * 3}
other = PhantomSweep(NumberOfSlices=8, ImageSize=[40, 30], PixelSpacing=1.5, Motion="Twist", Seed=5)
kept = [SweptVolume(Input=inputs, **grid) for inputs in ([replay, other], [other, replay])]
counts = []
for time in (times[1], times[-1], times[4], times[6]):
    new = SweptVolume(Input=[other, replay], **grid)
    counts.append(count(new, time))
    for volume in kept:
        assert count(volume, time) == counts[-1], (time, counts)
    Delete(new)
assert counts[0] < counts[2] < counts[3] <= counts[1], counts
print("ok")
