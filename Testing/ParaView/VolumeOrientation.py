# SPDX-License-Identifier: BSD-3-Clause
"""A block with letters F in its faces, scanned in several ways: from DICOM, and as dcm2niix, 3D Slicer and ITK keep it in NIfTI, NRRD
and MetaImage files, Volume Reader gives the same surface within 1 micrometre, at the same place of the patient (LPS).

VolumeOrientation.py <program that makes the scans>
"""
import gzip
import os
import shutil
import subprocess
import sys

import lacuna_test
import numpy as np
from lacuna.data import fetch
from letter_block import AXES, HALF
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
folder = lacuna_test.output("Volume orientation")
shutil.rmtree(folder, ignore_errors=True)
subprocess.run([sys.argv[1], os.path.join(folder, "dicom")], check=True)
FACES = {"one": AXES[:, 0] + 0.2 * AXES[:, 1], "another": -AXES[:, 1] + 0.3 * AXES[:, 2], "a third": AXES[:, 2] - 0.1 * AXES[:, 0]}
MICROMETRE = 1e-3
SCANS = "axial", "feet first", "sagittal", "oblique", "tilted"


def depths(volume, outwards):
    """The map of a face, on a grid that does not depend on the volume."""
    up = np.cross(outwards, [0.3, 0.5, 1])
    cast = BSplineIsoRayCaster(Input=volume, IsoValues=[0], ViewDirection=list(-outwards), ViewUp=list(up), PixelSpacing=0.9, ImageSize=[50, 50],
                               PlaneOrigin=list(1.6 * HALF * outwards / np.linalg.norm(outwards)))
    data = fetch(cast)
    field = vtk_to_numpy(data.GetFieldData().GetArray("ImageToWorld")).reshape(4, 4)
    facing = vtk_to_numpy(data.GetPointData().GetArray("Normals")) @ field[:3, 2]
    return vtk_to_numpy(data.GetPointData().GetArray("Depth")), field, np.abs(facing)


def stored(volume, order, flips):
    """The voxels as another program stores them, and (index as stored) -> LPS: axes in another order, some backwards."""
    image = fetch(volume)
    size = np.array(image.GetDimensions())
    values = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(size[::-1]).transpose(2, 1, 0)  # by i, j, k
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(image.GetDirectionMatrix().GetData()).reshape(3, 3) @ np.diag(image.GetSpacing())
    matrix[:3, 3] = image.GetOrigin()
    for axis in flips:
        values = np.flip(values, axis)
        matrix[:3, 3] += (size[axis] - 1) * matrix[:3, axis]
        matrix[:3, axis] *= -1
    matrix[:, :3] = matrix[:, list(order)]
    return values.transpose(order), matrix


def vector(numbers):
    return "(" + ",".join(repr(float(x)) for x in numbers) + ")"


def write_nrrd(name, values, matrix, space, signs, compressed=False):
    signs = np.array(signs)
    header = ["NRRD0004", "type: float", "dimension: 3", f"space: {space}", "sizes: {} {} {}".format(*values.shape),
              "space directions: " + " ".join(vector(signs * matrix[:3, axis]) for axis in range(3)), "kinds: domain domain domain",
              "endian: little", f"encoding: {'gzip' if compressed else 'raw'}", "space origin: " + vector(signs * matrix[:3, 3])]
    data = values.astype("<f4").tobytes(order="F")
    with open(name, "wb") as file:
        file.write(("\n".join(header) + "\n\n").encode() + (gzip.compress(data, 1) if compressed else data))
    return name


def write_meta(name, values, matrix):
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    lines = ["ObjectType = Image", "NDims = 3", "BinaryData = True", "BinaryDataByteOrderMSB = True", "CompressedData = False",
             "TransformMatrix = " + " ".join(repr(float(x)) for x in (matrix[:3, :3] / spacing).T.ravel()),
             "Offset = " + " ".join(repr(float(x)) for x in matrix[:3, 3]), "CenterOfRotation = 0 0 0",
             "ElementSpacing = " + " ".join(repr(float(x)) for x in spacing), "DimSize = {} {} {}".format(*values.shape),
             "ElementType = MET_FLOAT", "ElementDataFile = LOCAL"]
    with open(name, "wb") as file:
        file.write(("\n".join(lines) + "\n").encode() + values.astype(">f4").tobytes(order="F"))
    return name


def files(name, scan):
    """Files of a scan by what writes such ones."""
    own = os.path.join(folder, name)
    os.makedirs(own)
    found = {
        "Slicer, LPS": write_nrrd(own + "/lps.nrrd", *stored(scan, (0, 1, 2), (0, 1)), "left-posterior-superior", (1, 1, 1), True),
        "RAS": write_nrrd(own + "/ras.nrrd", *stored(scan, (2, 0, 1), (1,)), "right-anterior-superior", (-1, -1, 1)),
        "LAS, left-handed": write_nrrd(own + "/las.nrrd", *stored(scan, (1, 0, 2), ()), "LAS", (1, -1, 1)),
        "ITK": write_meta(own + "/itk.mha", *stored(scan, (0, 2, 1), (2,))),
        "ITK, left-handed": write_meta(own + "/mirrored.mha", *stored(scan, (0, 1, 2), (2,)))}
    # dcm2niix does not see a tilt that no header states: its file would be as if there were none
    if shutil.which("dcm2niix") and name != "tilted":
        for what, options in {"dcm2niix, NIfTI": ["-z", "i"], "dcm2niix, plain NIfTI": ["-z", "n"], "dcm2niix, NRRD": ["-e", "y", "-z", "n"]}.items():
            place = os.path.join(own, what)
            os.makedirs(place)
            subprocess.run(["dcm2niix", "-b", "n", "-f", "ct", "-o", place, *options, os.path.join(folder, "dicom", name)], check=True,
                           stdout=subprocess.DEVNULL)
            found[what] = next(os.path.join(place, file) for file in sorted(os.listdir(place)) if not file.endswith((".raw", ".gz"))
                               or file.endswith(".nii.gz"))
    return found


written = {}  # faces that were looked at, by the kind of file
for number, name in enumerate(SCANS):
    scan = CTSeriesReader(FileName=os.path.join(folder, "dicom", name))
    truth = {face: depths(scan, outwards) for face, outwards in FACES.items()}
    for kind, (what, path) in enumerate(files(name, scan).items()):
        volume = OpenDataFile(path)
        assert volume.SMProxy.GetXMLName() == "LacunaVolumeReader", (path, volume.SMProxy.GetXMLName())
        image = fetch(volume)
        record = vtk_to_numpy(image.GetFieldData().GetArray("DirectionMatrix"))[0]
        direction = np.array(image.GetDirectionMatrix().GetData())
        assert np.array_equal(record, direction) and np.linalg.det(direction.reshape(3, 3)) > 0
        # One face with its letter tells all six degrees of freedom, and left from right: of each scan all three are looked at, and of
        # each kind of file.
        face = list(FACES)[(number + kind) % len(FACES)]
        depth, to_world, _ = depths(volume, FACES[face])
        expected, expected_world, facing = truth[face]
        assert np.abs(to_world - expected_world).max() < MICROMETRE  # the grid is centred on the data
        both = np.isfinite(depth) & np.isfinite(expected)
        assert both.sum() > 1200 and (np.isfinite(depth) != np.isfinite(expected)).mean() < 2e-3, (what, both.sum())
        # from surface to surface: along the steep walls of the letters depths differ by more
        worst = (np.abs(depth - expected) * facing)[both].max()
        print(f"{name}, {what}, {face} face: {1000 * worst:.3f} um", flush=True)
        assert worst < MICROMETRE, (name, what, face, worst)
        written.setdefault(what, set()).add(face)
        Delete(volume)
    # and the truth is not the mirror image's
    mirrored = depths(VolumeReader(FileName=write_nrrd(os.path.join(folder, "wrong.nrrd"), *stored(scan, (0, 1, 2), ()), "RAS", (1, -1, 1))),
                      FACES["one"])[0]
    both = np.isfinite(mirrored) & np.isfinite(truth["one"][0])
    assert not both.any() or np.abs(mirrored - truth["one"][0])[both].max() > 0.5
assert all(len(faces) == len(FACES) for faces in written.values()), written
print(f"{len(written)} kinds of files lie where the DICOM series lies")
