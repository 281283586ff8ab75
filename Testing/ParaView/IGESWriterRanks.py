# SPDX-License-Identifier: BSD-3-Clause
"""IGES Writer under MPI: whatever the number of ranks, the first one writes the same file.

Run without arguments it is the test; it runs itself in pvbatch with the folder of files.
"""
import os
import shutil
import sys

from lacuna_test import output, run_ranks
from paraview.simple import *


def write(folder):
    LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
    phantom = SkullPhantom(Spacing=[3, 3, 3])
    depth = BSplineIsoRayCaster(Input=phantom, IsoValues=[500], ViewDirection=[0, 0, -1])
    filled = RBFHoleFiller(Input=depth)
    SaveData(os.path.join(folder, "implant.igs"), filled)
    SaveData(os.path.join(folder, "trimmed.igs"), filled, DefectOutline="Trim", Tolerance=0.01)
    group = GroupDatasets(Input=[filled, Ellipse(), PointSource(NumberOfPoints=3, Radius=0)])
    SaveData(os.path.join(folder, "group.igs"), group)


def run(ranks):
    folder = output("IGESWriterRanks%d" % ranks)
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    run_ranks(ranks, __file__, folder)
    files = {}
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), encoding="ascii") as file:
            files[name] = [line for line in file if line[72] != "G"]  # the date is there
    return files


def main():
    alone = run(1)
    assert sorted(alone) == ["group.igs", "implant.igs", "trimmed.igs"], sorted(alone)
    assert any(line.startswith("     144") for line in alone["trimmed.igs"])
    for ranks in (2, 3):
        together = run(ranks)
        assert sorted(together) == sorted(alone), ranks
        for name, lines in alone.items():
            assert together[name] == lines, (ranks, name)
    print("ok")


if len(sys.argv) == 2:
    write(sys.argv[1])
else:
    main()
