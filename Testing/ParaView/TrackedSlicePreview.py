# SPDX-License-Identifier: BSD-3-Clause
"""A sequence larger than MemoryLimit: ParaView shows a preview and says so; volume and file are those of all slices."""
import lacuna.plugin
lacuna.plugin.load()
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

import lacuna_test

FRAMES = 41
name = lacuna_test.output("preview.igs.mha")
SaveData(name, PhantomSweep(NumberOfSlices=FRAMES, ImageSize=[640, 480], PixelSpacing=0.1), CompressionLevel=0)

reader = OpenDataFile(name, MemoryLimit=3)
reader.UpdatePipeline()
assert reader.GetDataInformation().GetExtent() == (0, 639, 0, 479, 0, 8)
text = "a preview of every 5th of 41 slices, since all of them take 12595200 bytes (0.0117 GiB)"
reader.UpdatePropertyInformation()
assert reader.GetPropertyValue("Preview").startswith(text), reader.GetPropertyValue("Preview")
preview = servermanager.Fetch(reader)
assert preview.GetSpacing()[2] == 5
assert preview.GetFieldData().GetAbstractArray("Preview").GetValue(0).startswith(text)
assert preview.GetFieldData().GetArray("ImageToReference").GetNumberOfTuples() == FRAMES

# the Information panel shows the text
information = reader.GetDataInformation().GetFieldDataInformation().GetArrayInformation("Preview")
assert information.GetStringValue(0).startswith(text)

whole = OpenDataFile(name)
assert whole.GetPropertyValue("Preview") == ""


def arrays(source):
    image = servermanager.Fetch(source)
    return [vtk_to_numpy(image.GetPointData().GetArray(i))
            for i in range(image.GetPointData().GetNumberOfArrays())]


volumes = [SweptVolume(Input=source, OutputSpacing=[0.7, 0.7, 0.7]) for source in (whole, reader)]
for a, b in zip(*map(arrays, volumes)):
    assert len(a) > 1000 and (a == b).all()

# a stop while the fan is sought in slices that are read for it is nothing but a stop
from lacuna.vtkLacunaFiltersReconstruction import vtkLacunaSweptVolume
from lacuna.vtkLacunaReadersTrackedSlices import vtkLacunaTrackedSliceReader
opened, stopped, said = vtkLacunaTrackedSliceReader(), vtkLacunaSweptVolume(), []
opened.SetFileName(name)
opened.SetMemoryLimit(3)
stopped.SetInputConnection(opened.GetOutputPort())
stopped.SetFanMask(stopped.Automatic)
stopped.AddObserver("ErrorEvent", lambda *_: said.append("error"))
stopped.AddObserver("ProgressEvent", lambda filter, _: (said.append("stop"), filter.AbortExecuteOn()))
stopped.Update()
assert "stop" in said and "error" not in said, said

copy = lacuna_test.output("preview-copy.igs.mha")
SaveData(copy, reader)
assert (arrays(OpenDataFile(copy))[0] == arrays(whole)[0]).all()
assert servermanager.Fetch(OpenDataFile(copy)).GetFieldData().GetAbstractArray("Preview") is None

# MemoryLimit raised to what the text says: all is there
reader.MemoryLimit = 13
reader.UpdatePipeline()
assert reader.GetDataInformation().GetExtent()[5] == FRAMES - 1
reader.UpdatePropertyInformation()
assert reader.GetPropertyValue("Preview") == ""
