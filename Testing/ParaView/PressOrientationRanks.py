# SPDX-License-Identifier: BSD-3-Clause
"""The mould, its path and program, the model and the plate under MPI: one of each, whatever the number of ranks.

Run without arguments it is the test; it runs itself in pvbatch with the folder of files.
"""
import hashlib
import os
import re
import shutil
import sys

from lacuna_test import output, run_ranks
from paraview.simple import *


def write(folder):
    LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
    skull = SkullPhantom(Spacing=[3, 3, 3])
    depth = BSplineIsoRayCaster(Input=skull, IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9])
    filled = RBFHoleFiller(Input=depth, Smoothing=5, OutputMargin=30)
    press = PressOrientation(Input=filled)
    model = DefectModel(Input=filled)
    path = MillingToolPath(Input=press)
    for name, proxy in (("mould", ExtractSurface(Input=press)), ("top", ExtractSurface(Input=OutputPort(model, 1))),
                        ("model", model), ("plate", ImplantPlate(Input=filled))):
        SaveData(os.path.join(folder, name + ".stl"), proxy=proxy)
    SaveData(os.path.join(folder, "mould.igs"), proxy=press)
    SaveData(os.path.join(folder, "mould.nc"), proxy=path, AcceptWarnings=1)
    path.UpdatePipeline()
    counts = [proxy.GetDataInformation().GetNumberOfPoints() for proxy in (press, path)]
    with open(os.path.join(folder, "points.txt"), "w", encoding="ascii") as file:
        file.write(f"{counts}\n")


def run(ranks):
    folder = output("PressOrientationRanks%d" % ranks)
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    printed = run_ranks(ranks, __file__, folder)
    assert "ERR" not in printed, printed[-3000:]  # what a rank has to say would not be in the files
    found = {}
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), "rb") as file:
            content = file.read()
        if name.endswith(".igs"):
            content = b"".join(line for line in content.splitlines() if line[72:73] != b"G")  # the date is there
        elif name.endswith(".nc"):
            content = re.sub(rb"\(\d{4}-\d\d-\d\d \d\d:\d\d\)", b"", content)
        found[name] = (len(content), hashlib.sha256(content).hexdigest())
    with open(os.path.join(folder, "points.txt"), encoding="ascii") as file:
        print(ranks, "ranks: points", file.read().strip(), flush=True)
    return found


def main():
    alone = run(1)
    assert len(alone) == 7 and min(size for name, (size, _) in alone.items() if name != "points.txt") > 1000, alone
    for ranks in (2, 3):
        together = run(ranks)
        assert together == alone, (ranks, {name for name in alone if together.get(name) != alone[name]})
    print("ok")


if len(sys.argv) == 2:
    write(sys.argv[1])
else:
    main()
