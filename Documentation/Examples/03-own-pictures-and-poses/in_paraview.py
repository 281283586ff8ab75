# SPDX-License-Identifier: BSD-3-Clause
"""Pictures without poses and a table of poses, put together to tracked slices, planes in space and a surface.

    pvpython in_paraview.py [folder for picture and state file, default: .]

Writes own-pictures.png and own-pictures.pvsm, for File > Load State. own_pictures.py reads the same from files.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import pictures, states
from lacuna.data import fetch
from paraview.simple import *

# Stand-ins for your files, of a phantom: pictures that know nothing of poses, and a table in metres and seconds.
# Of your own: PNGSeriesReader(FileNames=["slice-000.png", ...]) and CSVReader(FileName=["poses.csv"])
SPACING = 0.4  # mm
phantom = PhantomSweep(registrationName="Phantom", Motion="Arbitrary", NumberOfSlices=80, SpeckleLevel=0.1, PixelSpacing=SPACING,
                       ImageSize=[160, 120])
stack = ProgrammableFilter(registrationName="Pictures", Input=phantom, Script="""
output.VTKObject.CopyStructure(inputs[0].VTKObject)
output.PointData.append(inputs[0].PointData.GetArray(0), "Grey")
output.VTKObject.GetPointData().SetActiveScalars("Grey")
""", CopyArrays=0)
table = ProgrammableFilter(registrationName="Poses", Input=phantom, OutputDataSetType="vtkTable", Script="""
import numpy as np
poses = np.array(inputs[0].FieldData["ProbeToReference"]).reshape(-1, 4, 4)
poses[:, :3, 3] /= 1000
output.RowData.append(0.12 * np.arange(len(poses)), "time")
for i, values in enumerate(poses.reshape(-1, 16).T):
    output.RowData.append(values, f"m{i}")
""")

# From here on: what you do with your own. The calibration: millimetres in the image to millimetres on the probe
given = fetch(phantom).GetFieldData().GetArray("ImageToProbe").GetTuple(0)
calibration = [value / (SPACING if i % 4 < 3 else 1) for i, value in enumerate(given)]
slices = AssembleTrackedSlices(registrationName="Slices", Input=stack, Poses=table, PoseFormat="Matrix", PoseColumns=["m"], LengthUnit="m",
                               PixelSpacing=SPACING, ImageToProbe=calibration)
volume = SweptVolume(registrationName="Volume", Input=slices, OutputSpacing=[0.6, 0.6, 0.6])
surface = Contour(registrationName="Surface", Input=volume, ContourBy=["POINTS", "Intensity"], Isosurfaces=[120], ComputeScalars=0)

space = pictures.new_view((620, 560))
middle = SlicePlanes(registrationName="One slice", Input=ExtractSubset(registrationName="Slice 40", Input=slices, VOI=[0, 159, 0, 119, 40, 40]))
pictures.show_slices(middle, space)
pictures.show_slices(SlicePlanes(registrationName="Outlines", Input=slices, OutlineOnly=1, Stride=8), space)
pictures.show_surface(surface, space, pictures.TISSUE).Opacity = 0.6
error = pictures.new_view((620, 560))
pictures.show_slices(SlicePlanes(registrationName="Expected error", Input=slices, ColorBy="RegistrationError", Stride=5), error)
for view, title in ((space, "Surface and slices"), (error, "Error to expect of the tracker")):
    pictures.add_title(view, title)
    pictures.look(view, (-0.62, 0.38, 0.8), (0, -1, 0), 1.15)
layout = pictures.lay_out([space, error], "Own pictures")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "own-pictures.png"))
states.save(os.path.join(folder, "own-pictures.pvsm"))
