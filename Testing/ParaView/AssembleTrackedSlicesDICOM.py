# SPDX-License-Identifier: BSD-3-Clause
"""What the page of Assemble Tracked Slices says about DICOM: its conversion of multi-frame files, run as printed, and what ParaView's own reader makes of them."""
import os
import re
import shutil
import struct
import sys

import numpy as np
from lacuna.errors import raising
from lacuna_test import output
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

try:
    from pydicom.pixel_data_handlers import convert_color_space  # noqa: F401, the page names it
except ImportError:
    print("no pydicom (Debian: python3-pydicom)")
    sys.exit(77)

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
FRAMES, ROWS, COLUMNS = 7, 9, 12
GREY = "1.2.840.10008.5.1.4.1.1.3.1"  # Ultrasound Multi-frame Image Storage
EXPLICIT_LITTLE = "1.2.840.10008.1.2.1"


def element(group, number, kind, value):
    if isinstance(value, int):
        value = struct.pack("<H", value)
    elif isinstance(value, str):
        value = value.encode()
    value += b"" if len(value) % 2 == 0 else (b"\0" if kind == "UI" else b" ")
    long = kind in ("OB", "OW", "SQ", "UN")
    head = struct.pack("<HH2s", group, number, kind.encode())
    return head + struct.pack("<2xI" if long else "<H", len(value)) + value


def write_dicom(path, pixels):
    """A file of frames x rows x columns (x 3) bytes, explicit little endian."""
    colour = pixels.ndim == 4
    meta = b"".join((
        element(2, 1, "OB", b"\0\1"), element(2, 2, "UI", GREY), element(2, 3, "UI", "1.2.3.4.5"),
        element(2, 0x10, "UI", EXPLICIT_LITTLE), element(2, 0x12, "UI", "1.2.3.4")))
    data = [
        element(8, 8, "CS", "ORIGINAL\\PRIMARY"), element(8, 0x16, "UI", GREY), element(8, 0x18, "UI", "1.2.3.4.5"),
        element(8, 0x60, "CS", "US"), element(0x20, 0xD, "UI", "1.2.3"), element(0x20, 0xE, "UI", "1.2.3.4"),
        element(0x20, 0x13, "IS", "1"), element(0x28, 2, "US", 3 if colour else 1),
        element(0x28, 4, "CS", "RGB" if colour else "MONOCHROME2")]
    if colour:
        data.append(element(0x28, 6, "US", 0))
    data += [
        element(0x28, 8, "IS", str(len(pixels))), element(0x28, 0x10, "US", pixels.shape[1]),
        element(0x28, 0x11, "US", pixels.shape[2]), element(0x28, 0x100, "US", 8), element(0x28, 0x101, "US", 8),
        element(0x28, 0x102, "US", 7), element(0x28, 0x103, "US", 0), element(0x7FE0, 0x10, "OB", pixels.tobytes())]
    with open(path, "wb") as file:
        file.write(bytes(128) + b"DICM" + element(2, 0, "UL", struct.pack("<I", len(meta))) + meta + b"".join(data))


# the snippet, word for word
root = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
with open(os.path.join(root, "Documentation", "UserGuide", "assemble-tracked-slices.md"), encoding="utf-8") as page:
    snippets = [block for block in re.findall(r"^```python\n(.*?)^```$", page.read(), re.MULTILINE | re.DOTALL) if "pydicom" in block]
assert len(snippets) == 1
folder = output("AssembleTrackedSlicesDICOM")
shutil.rmtree(folder, ignore_errors=True)
os.makedirs(folder)
os.chdir(folder)
with open("poses.csv", "w", encoding="utf-8") as file:
    file.write("x,y,z,qw,qx,qy,qz\n" + "".join(f"1,2,{0.5 * frame},1,0,0,0\n" for frame in range(FRAMES)))

random = np.random.default_rng(5)
grey = random.integers(0, 256, (FRAMES, ROWS, COLUMNS)).astype(np.uint8)
colours = random.integers(0, 256, (FRAMES, ROWS, COLUMNS, 3)).astype(np.uint8)
luminance = np.rint(colours @ np.array([0.299, 0.587, 0.114])).astype(np.uint8)
for pixels, expected in ((grey, grey), (colours, luminance)):
    write_dicom("sweep.dcm", pixels)
    exec(compile(snippets[0], "snippet", "exec"), {})
    poses = CSVReader(FileName=["poses.csv"])
    with raising():
        stack = MetaFileSeriesReader(FileNames=["sweep.mha"])
        slices = AssembleTrackedSlices(Input=stack, Poses=poses, PoseFormat="Quaternion", PixelSpacing=[0.3])
        slices.UpdatePipeline()
    image = servermanager.Fetch(slices)
    assert np.array_equal(vtk_to_numpy(image.GetPointData().GetScalars()).reshape(expected.shape), expected)
    pose = vtk_to_numpy(image.GetFieldData().GetArray("ImageToReference")).reshape(-1, 4, 4)
    # row 0 of the picture is the first: pixel (column 2, row 4) of frame 3
    assert np.allclose(pose[3] @ [2, 4, 0, 1], [1 + 0.3 * 2, 2 + 0.3 * 4, 1.5, 1])

# why the conversion is needed: ParaView's own reader has the first frame only, bottom row first
write_dicom("sweep.dcm", grey)
own = OpenDataFile("sweep.dcm")
own.UpdatePipeline()
image = servermanager.Fetch(own)
assert image.GetDimensions() == (COLUMNS, ROWS, 1), image.GetDimensions()
first = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(ROWS, COLUMNS)
assert np.array_equal(first[::-1], grey[0])
print("ok")
