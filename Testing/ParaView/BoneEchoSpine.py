# SPDX-License-Identifier: BSD-3-Clause
"""Bone Echo of the real spine sweep: a lumbar vertebra, at places that were marked by eye, and not the gel above it."""
import lacuna.plugin

lacuna.plugin.load()
import numpy as np
from lacuna import demo_ultrasound, macros
from lacuna.data import fetch
from lacuna_test import data
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

# (slice, column, row) in the middle of bright echoes with a shadow, and at the top of the spinous process's shadow. Marked by eye in the
# slices alone, to about 0.5 mm.
MARKED = [(4, 413, 242), (4, 352, 272), (5, 418, 250), (5, 366, 272), (6, 417, 259), (6, 481, 246), (7, 441, 246), (7, 377, 266), (7, 596, 288),
          (8, 374, 257), (8, 488, 242), (8, 581, 282), (10, 370, 233), (10, 510, 255), (10, 561, 282), (12, 424, 111), (12, 347, 263),
          (12, 532, 259), (14, 423, 98), (14, 339, 263), (14, 526, 250), (16, 415, 98), (16, 355, 250), (16, 508, 236)]
SPACING = 0.0854, 0.0790  # mm

reader = TrackedSliceReader(FileName=data("ultrasound_spine/SpinePhantomFreehand.igs.mha"),
                            CalibrationFileName=data("ultrasound_spine/PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml"))
proxy = BoneEcho(Input=reader, FanMask="Automatic")
proxy.UpdatePipeline()
image = fetch(proxy)
width, height, slices = image.GetDimensions()
bone = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(slices, height, width)
assert image.GetPointData().GetScalars().GetName() == "BoneEcho" and image.GetPointData().HasArray("Intensity")

# Each of them is at a surface; the echo of a lamina is 2 to 4 mm thick
distances = []
for number, column, row in MARKED:
    rows, columns = np.nonzero(np.diff((bone[number] >= 0.5).astype(np.int8), axis=0))
    distances.append(np.hypot(SPACING[0] * (columns - column), SPACING[1] * (rows + 0.5 - row)).min())
print(f"{np.mean(distances):.2f} mm from what was marked, at most {max(distances):.2f} mm")
assert max(distances) < 1.5 and np.mean(distances) < 0.6, distances

# The gel and the tissue above the bone are as bright, and are no bone; nor is what is beside the vertebra
inside = bone >= 0.5
assert not inside[:, :75].any(), "within 5 mm of the probe"
assert not inside[:, :, :250].any(), "left of the vertebra"
part = [inside[k].any(axis=0).sum() for k in range(slices)]
print("columns with bone:", part)
assert min(part) > 50 and max(part) < 350

# The spinous process stands about 12 mm out of the laminae, towards the probe
first = np.where(inside.any(axis=1), inside.argmax(axis=1), height)
height_of = SPACING[1] * (np.median(first[4:7, 400:450]) - np.median(first[13:17, 415:440]))
print(f"spinous process: {height_of:.1f} mm")
assert 9 < height_of < 15

# The surface is closed and in one piece but for little, and about as large as the vertebra in the sweep
view = CreateRenderView()
surface = macros.sweep_to_bone(reader)
largest = ExtractSurface(Input=Connectivity(Input=surface, ExtractionMode="Extract Largest Region"))
volume, open_edges = demo_ultrasound.measure(largest)
part = largest.GetDataInformation().GetNumberOfCells() / surface.GetDataInformation().GetNumberOfCells()
print(f"{volume:.2f} ml of shell, {part:.0%} in one piece")
assert open_edges == 0 and 1 < volume < 5 and part > 0.9, (volume, open_edges, part)
