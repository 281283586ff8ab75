# SPDX-License-Identifier: BSD-3-Clause
"""Volumes in files are opened where they are, in mm, or refused. The letter-like object in all of
them is at the same place of the room, however its file stores it."""
import os
import shutil

import numpy as np
from lacuna.data import fetch, open_volume
from lacuna_test import output
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

folder = output("volume-files")
shutil.rmtree(folder, ignore_errors=True)
os.makedirs(folder)
SIZE, SPACING, ORIGIN = (12, 5, 6), (0.5, 1.5, 2), (10, -20, 30)
letter = np.zeros(SIZE, "<i2")  # an L with a dot on one side, by i, j, k; ParaView takes four columns for components
letter[1, 1:4, 1:5], letter[1:3, 3, 1], letter[3, 1, 4] = 1000, 1000, 2000


def place(reader):
    """Centre of what is bright, in mm, weighted."""
    image = fetch(reader)
    values = vtk_to_numpy(image.GetPointData().GetScalars()).astype(float)
    points = np.array([image.GetPoint(k) for k in range(image.GetNumberOfPoints())])
    return (points * values[:, None]).sum(0) / values.sum()


def written(name, header, values=letter):
    path = os.path.join(folder, name)
    with open(path, "wb") as file:
        file.write(header.encode() + values.tobytes(order="F"))
    return path


def meta(name, *lines, values=letter):
    head = ["ObjectType = Image", "NDims = 3", "DimSize = {} {} {}".format(*values.shape), "ElementType = MET_SHORT"]
    if not any(line.startswith("Position") for line in lines):
        head.append("Offset = 10 -20 30")
    if not any(line.startswith("ElementSpacing") for line in lines):
        head.append("ElementSpacing = 0.5 1.5 2")
    return written(name, "\n".join(head + list(lines)) + "\nElementDataFile = LOCAL\n", values)


def nrrd(name, *lines, values=letter):
    head = ["NRRD0005", "# of a test: no header", "type: int16", "dimension: 3", "sizes: {} {} {}".format(*values.shape), "endian: little",
            "encoding: raw", "kinds: domain domain domain"]
    return written(name, "\n".join(head + list(lines)) + "\n\n", values)


indices = np.argwhere(letter > 0)
weights = letter[letter > 0].astype(float)
truth = (weights[:, None] * (np.array(ORIGIN) + np.array(SPACING) * indices)).sum(0) / weights.sum()

# what lies along the axes
for path in (meta("plain.mha"), meta("units.mha", "DistanceUnits = mm", "AnatomicalOrientation = RAI"),
             meta("straight.mha", "TransformMatrix = 1 0 0 0 1 0 0 0 1", "AnatomicalOrientation = ???"),
             nrrd("lps.nrrd", "space: left-posterior-superior", "space origin: (10,-20,30)",
                  "space directions: (0.5,0,0) (0,1.5,0) (0,0,2)", 'space units: "mm" "mm" "mm"',
                  "TransformMatrix:=-1 0 0 0 1 0 0 0 1")):
    assert np.abs(place(open_volume(path)) - truth).max() < 1e-6, (path, place(open_volume(path)), truth)
volume = open_volume(meta("again.mha"))
SaveData(os.path.join(folder, "saved.vti"), proxy=volume, DataMode="Binary")
assert np.abs(place(open_volume(os.path.join(folder, "saved.vti"))) - truth).max() < 1e-6


def refused(path, *texts):
    try:
        open_volume(path)
    except (ValueError, RuntimeError) as error:
        for text in (os.path.basename(path), *texts):
            assert text in str(error), (text, str(error))
        return
    raise AssertionError(f"{path} was opened")


# what is turned, in other units or in another sense lies where its file has it: files of the same letter
def flipped(axes):
    return np.flip(letter, axes)


last = (np.array(SIZE) - 1) * SPACING + ORIGIN
placed = [
    meta("turned.mha", "TransformMatrix = -1 0 0 0 -1 0 0 0 1", f"Position = {last[0]} {last[1]} 30", values=flipped((0, 1))),
    meta("colon.MHA", "TransformMatrix : 1 0 0 0 1 0 0 0 -1", f"Position = 10 -20 {last[2]}", values=flipped(2)),
    meta("late.mha", "Comment = " + 20000 * "x", "Rotation = 0 1 0 1 0 0 0 0 1", "Position = 10 -20 30", "ElementSpacing = 1.5 0.5 2",
         values=letter.swapaxes(0, 1)),
    meta("centimetres.mha", "DistanceUnits = cm", "ElementSpacing = 0.05 0.15 0.2", "Position = 1 -2 3"),
    nrrd("headfirst.nrrd", "space: LPS", "space directions: (0.5,0,0) (0,1.5,0) (0,0,-2)", f"space origin: (10,-20,{last[2]})",
         values=flipped(2)),
    nrrd("ras.nrrd", "space: right-anterior-superior", "space directions: (-0.5,0,0) (0,-1.5,0) (0,0,2)", "space origin: (-10,20,30)"),
    nrrd("swapped.nrrd", "space: LPS", "space directions: (0,1.5,0) (0.5,0,0) (0,0,2)", "space origin: (10,-20,30)",
         values=letter.swapaxes(0, 1)),
    nrrd("metres.nrrd", "space: LPS", "space directions: (0.0005,0,0) (0,0.0015,0) (0,0,0.002)", "space origin: (0.01,-0.02,0.03)",
         'space units: "m" "m" "m"')]
for path in placed:
    volume = open_volume(path)
    assert volume.SMProxy.GetXMLName() == "LacunaVolumeReader"
    assert np.abs(place(volume) - truth).max() < 1e-6, (path, place(volume), truth)
    opened = OpenDataFile(path)  # as File > Open offers first
    assert opened.SMProxy.GetXMLName() == "LacunaVolumeReader", path


def refused(path, *texts):
    try:
        open_volume(path)
    except (ValueError, RuntimeError) as error:
        for text in (os.path.basename(path), *texts):
            assert text in str(error), (text, str(error))
        return
    raise AssertionError(f"{path} was opened")


# what is not certain
refused(meta("words.mha", "Orientation = RAI"), "'RAI' is no finite number")
refused(meta("letters.mha", "AnatomicalOrientation = LPI"), "AnatomicalOrientation is 'LPI'", "not known which is right")
refused(meta("furlongs.mha", "DistanceUnits = furlong"), "DistanceUnits is 'furlong'")
refused(meta("negative.mha", "ElementSpacing = 0.5 1.5 -2"), "must be positive")
refused(written("endless.mha", "NDims = 3\n"), "its header has no end")
refused(nrrd("sheared.nrrd", "space: LPS", "space directions: (0.5,0,0) (0,1.5,0.3) (0,0,2)", "space origin: (0,0,0)"), "right angles")
refused(nrrd("scanner.nrrd", "space: scanner-xyz", "space directions: (0.5,0,0) (0,1.5,0) (0,0,2)"), "space is 'scanner-xyz'")
refused(nrrd("negative.nrrd", "spacings: 0.5 -1.5 2"), "spacings")
refused(written("text.nrrd", "no header"), "line 1")
refused(written("text.nii", 400 * "no header"), "not a NIfTI file")
refused(written("head.vtk", "# vtk"), "it is not sure that ParaView heeds")
refused(os.path.join(folder, "missing.mha"), "there is no such file")
refused(written("broken.vti", "<VTKFile"), "")
refused(written("damaged.dcm", "no DICOM"), "")
os.makedirs(os.path.join(folder, "empty"))
refused(os.path.join(folder, "empty"), "")

# files of DICOM are not for ParaView's own reader of them, whatever their names
refused(written("IM0001", 128 * "\0" + "DICM"), "IM0001")
print("volumes are opened where they are, or not at all")
