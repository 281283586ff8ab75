# SPDX-License-Identifier: BSD-3-Clause
"""An installation that was moved serves ParaView: pvpython moved.py <where it is now> <LacunaMakeCTSeries> <folder>

PYTHONPATH alone leads there.
"""
import glob
import os
import subprocess
import sys

import lacuna.plugin

prefix = os.path.realpath(sys.argv[1])
assert os.path.realpath(lacuna.__file__).startswith(prefix + os.sep), lacuna.__file__
assert lacuna.plugin.path().startswith(prefix + os.sep), lacuna.plugin.path()
lacuna.plugin.load()
from paraview.simple import *

depth = BSplineIsoRayCaster(Input=SkullPhantom(), IsoValues=[500])
depth.UpdatePipeline()
assert depth.GetDataInformation().GetNumberOfPoints() > 10000
with open("/proc/self/maps", encoding="utf-8") as maps:
    files = {line.split()[-1] for line in maps if "acuna" in line.split()[-1]}
elsewhere = [name for name in files if name.endswith(".so") or ".so." in name if not name.startswith(prefix + os.sep)]
assert len(files) > 10 and not elsewhere, f"libraries of another place: {elsewhere}"

# compressed pixels need a program beside the libraries
if sys.argv[2]:
    from lacuna.errors import raising
    subprocess.run(sys.argv[2:4], check=True)
    scan = CTSeriesReader(FileName=os.path.join(sys.argv[3], "JPEG-LS"))
    with raising():
        scan.UpdatePipeline()
    assert scan.GetDataInformation().GetNumberOfPoints() > 1000
    (program,) = glob.glob(prefix + "/**/lacuna-decode", recursive=True)
    os.rename(program, program + ".away")
    ReloadFiles(scan)
    try:
        with raising():
            scan.UpdatePipeline()
        raise AssertionError("read without " + program)
    except RuntimeError as error:
        assert f"there is no program {program}, which comes with Lacuna" in str(error), error
    os.rename(program + ".away", program)
