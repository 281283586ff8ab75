# SPDX-License-Identifier: BSD-3-Clause
"""Files in the ParaView application: every kind is written by File > Save Data and opened by File > Open; macros are imported.

WindowFiles.py <folder of the macros> [program that makes a CT series]
"""
import glob
import os
import shutil
import subprocess
import sys

import lacuna_window
import numpy as np
from lacuna_window import PANEL

FOLDER = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "WindowFiles")
MACROS = "LACUNA_MACROS"


def path(name):
    return os.path.join(FOLDER, name)


def test(window):
    from lacuna.data import fetch
    from paraview.simple import GetActiveSource
    from vtkmodules.util.numpy_support import vtk_to_numpy

    window.resize(1300, 900)
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

    # macros: imported once, then they are in the menu
    for name in ("Lacuna_Sweep_to_surface", "Lacuna_CT_to_IGES"):
        file = os.path.join(os.environ[MACROS], name + ".py")
        window.menu("Macros/Import new macro...", lambda: window.choose_file(file))
        assert window.has_menu("Macros/" + name)
    window.press("actionPBHideAll")
    window.select("pipelineBrowser", "PhantomSweep1")
    window.menu("Macros/Lacuna_Sweep_to_surface")
    window.check_messages()
    surface = GetActiveSource()
    assert surface.SMProxy.GetXMLName() == "Contour" and surface.GetDataInformation().GetNumberOfPoints() > 100
    window.compare("FilesMacro")


if lacuna_window.IS_INSIDE:
    lacuna_window.inside(test)
else:
    shutil.rmtree(FOLDER, ignore_errors=True)
    os.makedirs(FOLDER)
    if len(sys.argv) > 2:
        subprocess.run([sys.argv[2], path("ct")], check=True)
    said = lacuna_window.run(__file__, **{MACROS: sys.argv[1]})
    assert "WARN|" not in said
    print("ok")
