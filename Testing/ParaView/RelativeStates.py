# SPDX-License-Identifier: BSD-3-Clause
"""lacuna.states.load takes relative file names from the state file's folder, and leaves the script where it was."""
import os
import shutil

import lacuna.plugin

lacuna.plugin.load()
from lacuna import states
from lacuna.data import fetch
from lacuna.errors import raising
from lacuna_test import output
from paraview.simple import *

FOLDER = os.path.abspath(output("RelativeStates"))
THERE, HERE = os.path.join(FOLDER, "there", "sub"), os.path.join(FOLDER, "here")
shutil.rmtree(FOLDER, ignore_errors=True)
os.makedirs(THERE)
os.makedirs(os.path.join(HERE, "sub"))


def write(folder, rows, columns):
    """A table and a sweep of one name in each folder."""
    with open(os.path.join(folder, "table.csv"), "w", encoding="ascii") as file:
        file.write("a,b\n" + "1,2\n" * rows)
    SaveData(os.path.join(folder, "sweep.nhdr"), proxy=PhantomSweep(NumberOfSlices=4, ImageSize=[columns, 30], PixelSpacing=1))


write(THERE, 7, 20)
write(os.path.join(HERE, "sub"), 2, 10)  # of the same name, to be left alone
ResetSession()

os.chdir(os.path.dirname(THERE))
CSVReader(registrationName="Table", FileName=[os.path.join("sub", "table.csv")])
TrackedSliceReader(registrationName="Sweep", FileName=os.path.join("sub", "sweep.nhdr"))
CTSeriesReader(registrationName="Empty")
PolhemusVideoSource(registrationName="Live", VideoURL="lavfi:testsrc2", RecordFileName="new.mhd")
states.save("relative.pvsm")

os.chdir(HERE)
before = os.getcwd()
with raising():
    states.load(os.path.join("..", "there", "relative.pvsm"))
    assert os.getcwd() == before
    table, sweep, live = (FindSource(name) for name in ("Table", "Sweep", "Live"))
    for source in (table, sweep):
        source.UpdatePipeline()
assert fetch(table).GetNumberOfRows() == 7, fetch(table).GetNumberOfRows()
assert fetch(sweep).GetDimensions() == (20, 30, 4), fetch(sweep).GetDimensions()
assert FindSource("Empty").FileName == ""
assert live.VideoURL == "lavfi:testsrc2", live.VideoURL
assert live.RecordFileName == os.path.join(os.path.dirname(THERE), "new.mhd"), live.RecordFileName
