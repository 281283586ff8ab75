# SPDX-License-Identifier: BSD-3-Clause
"""Files in the ParaView application: every kind is written by File > Save Data and opened by File > Open.

WindowFiles.py [program that makes a CT series]
"""
import glob
import os
import shutil
import subprocess
import sys

import lacuna_window
import numpy as np
from lacuna_window import PANEL

NIFTI_AXES = [[0.8, 0.6, 0], [0.6, -0.8, 0], [0, 0, -1]]  # of columns, rows and slices, as coordinates to the right, the front and up
NIFTI_SPACING, NIFTI_ORIGIN = [0.6, 0.7, 2], [-5, 6, 7]
FOLDER = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "WindowFiles")


def path(name):
    return os.path.join(FOLDER, name)


def write_nifti(name):
    """A turned volume whose voxels are numbered, by VTK's writer."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkCommonMath import vtkMatrix4x4
    from vtkmodules.vtkIOImage import vtkNIFTIImageHeader, vtkNIFTIImageWriter
    image, place, header, writer = vtkImageData(), vtkMatrix4x4(), vtkNIFTIImageHeader(), vtkNIFTIImageWriter()
    image.SetDimensions(7, 6, 5)
    image.SetSpacing(NIFTI_SPACING)
    image.GetPointData().SetScalars(numpy_to_vtk(np.arange(7 * 6 * 5, dtype=np.int16)))
    place.DeepCopy([x for row, start in zip(NIFTI_AXES, NIFTI_ORIGIN) for x in (*row, start)] + [0, 0, 0, 1])
    header.SetXYZTUnits(header.UnitsMM)
    writer.SetInputData(image)
    writer.SetNIFTIHeader(header)
    writer.SetSFormMatrix(place)
    writer.SetQFormMatrix(place)
    writer.SetFileName(name)
    writer.Write()


def test(window):
    from lacuna.data import fetch
    from paraview.simple import GetActiveSource
    from vtkmodules.util.numpy_support import vtk_to_numpy

    window.resize_view(992, 665)
    window.menu("Sources/Lacuna/Phantom Sweep")
    for name, values in {"NumberOfSlices": (12,), "ImageSize": (80, 60)}.items():
        for k, value in enumerate(values):
            window.type(f"{PANEL}{name}/LineEdit{k}", value)
    window.type(PANEL + "PixelSpacing/DoubleLineEdit0", 0.8)
    window.apply()
    sweep = GetActiveSource()
    assert (list(sweep.ImageSize), sweep.NumberOfSlices, sweep.PixelSpacing) == ([80, 60], 12, 0.8)
    expected = vtk_to_numpy(fetch(sweep).GetPointData().GetScalars())

    # sequences
    for ending in ("igs.mha", "mhd", "nrrd", "nhdr"):
        name = path("sweep." + ending)
        window.select("pipelineBrowser", "PhantomSweep1")
        window.save_file(name, "Tracked", lambda: window.press("OKButton"))
        # endings of sequences alone are read without a question
        window.open_file(name, None if ending == "igs.mha" else "Tracked Slice Reader")
        reader = GetActiveSource()
        assert reader.SMProxy.GetXMLName() == "LacunaTrackedSliceReader", ending
        window.apply()
        data = fetch(reader)
        assert np.array_equal(vtk_to_numpy(data.GetPointData().GetScalars()), expected), ending
        assert data.GetFieldData().GetArray("ImageToReference").GetNumberOfTuples() == 12
        print(ending, "ok", flush=True)
    window.compare("FilesSweep")

    # a DICOM series, by one of its files
    series = sorted(glob.glob(path("ct/axial/*.dcm")))
    if series:
        window.open_file(series[0], "CT Series Reader")
        assert GetActiveSource().SMProxy.GetXMLName() == "LacunaCTSeriesReader"
        window.apply()
        assert fetch(GetActiveSource()).GetDimensions()[2] == len(series)

    # a NIfTI volume, which other formats and readers do not contend for
    window.open_file(path("turned.nii"))
    reader = GetActiveSource()
    assert reader.SMProxy.GetXMLName() == "LacunaVolumeReader"
    window.apply()
    volume = fetch(reader)
    assert np.array_equal(vtk_to_numpy(volume.GetPointData().GetScalars()), np.arange(7 * 6 * 5))
    index = [6, 5, 4]
    right, front, up = np.array(NIFTI_AXES) @ (np.array(NIFTI_SPACING) * index) + NIFTI_ORIGIN
    assert np.allclose(volume.GetPoint(volume.GetNumberOfPoints() - 1), [-right, -front, up], atol=1e-5)  # LPS; of 32-bit numbers

    # outlines: those of 3D Slicer without a question, tables by choice
    for name, choice in (("Liver.mrk.json", None), ("liver.csv", "Outline Reader")):
        window.open_file(path(name), choice)
        assert GetActiveSource().SMProxy.GetXMLName() == "LacunaOutlineReader", name
        window.apply()
        assert fetch(GetActiveSource()).GetNumberOfLines() == 1, name


if lacuna_window.IS_INSIDE:
    lacuna_window.inside(test)
else:
    shutil.rmtree(FOLDER, ignore_errors=True)
    os.makedirs(FOLDER)
    write_nifti(path("turned.nii"))
    with open(path("Liver.mrk.json"), "w", encoding="ascii") as markups:
        markups.write('{"markups": [{"type": "ClosedCurve", "controlPoints": [{"position": [0, 0, 0]}, {"position": [9, 0, 0]}, '
                      '{"position": [9, 7, 0]}]}]}')
    with open(path("liver.csv"), "w", encoding="ascii") as table:
        table.write("structure,outline,x,y,z\nLiver,1,0,0,0\nLiver,1,9,0,0\nLiver,1,9,7,0\n")
    if len(sys.argv) > 1:
        subprocess.run([sys.argv[1], path("ct")], check=True)
    lacuna_window.check_warnings(lacuna_window.run(__file__))
    print("ok")
