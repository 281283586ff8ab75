# SPDX-License-Identifier: BSD-3-Clause
"""Another program, dcm2niix, puts every voxel of the test scans at the same place of the patient."""
import glob
import os
import shutil
import struct
import subprocess
import sys

import lacuna
import lacuna_test
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

if not shutil.which("dcm2niix"):
    print("skipped: no dcm2niix", flush=True)
    sys.exit(lacuna_test.SKIPPED)
folder = lacuna_test.output("CT geometry")
shutil.rmtree(folder, ignore_errors=True)
subprocess.run([sys.argv[1], folder], check=True)
NUMBERS = {2: "u1", 4: "<i2", 8: "<i4", 16: "<f4", 512: "<u2"}  # NIfTI's datatype


def read_nifti(name):
    """Voxels as [k, j, i] and the matrix from (i, j, k, 1) to LPS in mm."""
    with open(name, "rb") as file:
        content = file.read()
    size = struct.unpack("<8h", content[40:56])
    number = NUMBERS[struct.unpack("<h", content[70:72])[0]]
    offset = int(struct.unpack("<f", content[108:112])[0])
    slope, intercept = struct.unpack("<2f", content[112:120])
    voxels = np.frombuffer(content, number, offset=offset).reshape(size[3], size[2], size[1])
    to_ras = np.array(struct.unpack("<12f", content[280:328])).reshape(3, 4)
    return voxels * (slope or 1) + intercept, np.diag([-1, -1, 1]) @ to_ras


for name in ("axial", "prone", "feet first", "descending", "coronal", "sagittal", "oblique", "12 bits", "multi-frame",
             "JPEG lossless"):
    scan = os.path.join(folder, name)
    subprocess.run(["dcm2niix", "-z", "n", "-b", "n", "-o", folder, "-f", "nifti-" + name.replace(" ", "-"), scan],
                   stdout=subprocess.DEVNULL, check=True)
    files = glob.glob(os.path.join(folder, "nifti-" + name.replace(" ", "-") + "*.nii"))
    assert len(files) == 1, files
    theirs, to_patient = read_nifti(files[0])
    reader = lacuna.vtkLacunaCTSeriesReader()
    reader.SetFileName(scan)
    reader.Update()
    image = reader.GetOutput()
    ours = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[::-1])
    assert ours.size == theirs.size
    to_index = image.GetPhysicalToIndexMatrix()
    to_index = np.array([[to_index.GetElement(r, c) for c in range(4)] for r in range(3)])
    k, j, i = np.mgrid[:theirs.shape[0], :theirs.shape[1], :theirs.shape[2]]
    points = to_patient @ np.stack([i.ravel(), j.ravel(), k.ravel(), np.ones(i.size)])
    index = to_index @ np.vstack([points, np.ones(i.size)])
    nearest = np.rint(index).astype(int)
    off = np.abs(index - nearest).max()  # its matrix is in single precision
    assert off < 1e-4, (name, off)
    assert (nearest >= 0).all()
    assert (ours[nearest[2], nearest[1], nearest[0]] == theirs.ravel()).all(), name
    print(f"{name}: {theirs.size} voxels at the same place", flush=True)
