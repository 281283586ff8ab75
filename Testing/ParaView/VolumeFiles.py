# SPDX-License-Identifier: BSD-3-Clause
"""Which volumes in files are opened: those that ParaView reads to where they are, in mm. The letter-like object in all of
them is at the same place of the room, however its file stores it."""
import os
import shutil

import numpy as np
from lacuna import volume_files
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


def meta(name, *lines):
    head = ["ObjectType = Image", "NDims = 3", "DimSize = 12 5 6", "ElementType = MET_SHORT", "Offset = 10 -20 30"]
    if not any(line.startswith("ElementSpacing") for line in lines):
        head.append("ElementSpacing = 0.5 1.5 2")
    return written(name, "\n".join(head + list(lines)) + "\nElementDataFile = LOCAL\n")


def nrrd(name, *lines, values=letter):
    head = ["NRRD0005", "# of a test: no header", "type: int16", "dimension: 3", "sizes: 12 5 6", "endian: little",
            "encoding: raw", "kinds: domain domain domain"]
    return written(name, "\n".join(head + list(lines)) + "\n\n", values)


indices = np.argwhere(letter > 0)
weights = letter[letter > 0].astype(float)
truth = (weights[:, None] * (np.array(ORIGIN) + np.array(SPACING) * indices)).sum(0) / weights.sum()

# what ParaView reads where it is
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


# what it would turn, mirror or scale
refused(meta("turned.mha", "TransformMatrix = -1 0 0 0 -1 0 0 0 1"), "TransformMatrix = -1", "turned, mirrored")
refused(meta("colon.MHA", "TransformMatrix : 1 0 0 0 1 0 0 0 -1"), "TransformMatrix")
refused(meta("late.mha", "Comment = " + 20000 * "x", "Rotation = 0 1 0 1 0 0 0 0 1"), "Rotation")
refused(meta("words.mha", "Orientation = RAI"), "Orientation = RAI are not numbers")
refused(meta("ras.mha", "AnatomicalOrientation = LPI"), "AnatomicalOrientation = LPI")
refused(meta("centimetres.mha", "DistanceUnits = cm"), "DistanceUnits = cm")
refused(meta("negative.mha", "ElementSpacing = 0.5 1.5 -2"), "ElementSpacing = 0.5 1.5 -2")
refused(written("endless.mha", "NDims = 3\n"), "no ElementDataFile")
up, down = "space directions: (0.5,0,0) (0,1.5,0) (0,0,2)", "space directions: (0.5,0,0) (0,1.5,0) (0,0,-2)"
refused(nrrd("headfirst.nrrd", "space: LPS", down, values=letter[:, :, ::-1]), "space directions = (0.5,0,0)")
refused(nrrd("ras.nrrd", "space: right-anterior-superior", up), "space = right-anterior-superior")
refused(nrrd("swapped.nrrd", "space: LPS", "space directions: (0,0.5,0) (1.5,0,0) (0,0,2)"), "space directions")
refused(nrrd("upper.nrrd", "Space Directions:(0.5,0,0) (0,-1.5,0) (0,0,2)"), "space directions")
refused(nrrd("metres.nrrd", "space: LPS", up, 'space units: "m" "m" "m"'), "space units")
refused(nrrd("negative.nrrd", "spacings: 0.5 -1.5 2"), "spacings")
refused(written("text.nrrd", "no header"), "is no NRRD file")
refused(written("head.nii", "n+1"), "it is not sure that ParaView heeds")
refused(os.path.join(folder, "missing.mha"), "there is no such file")
refused(written("broken.vti", "<VTKFile"), "")
refused(written("damaged.dcm", "no DICOM"), "")
os.makedirs(os.path.join(folder, "empty"))
refused(os.path.join(folder, "empty"), "")

# files of DICOM are not for ParaView's own reader of them, whatever their names
assert volume_files.check(written("IM0001", 128 * "\0" + "DICM")) == volume_files.DICOM
print("volumes are opened where they are, or not at all")
