# SPDX-License-Identifier: BSD-3-Clause
"""Tracked Slice Reader and Writer under MPI: whatever the number of ranks, the first one writes the same bytes.

Run without arguments it is the test; it runs itself in pvbatch with the folder of files.
"""
import os
import shutil
import sys

from lacuna_test import output, run_ranks
from paraview.simple import *

KINDS = ("mha", "mhd", "nrrd", "nhdr")
TIMES = (0.0, 0.45, 10.0)


def write(folder, ranks):
    LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
    sweep = PhantomSweep(NumberOfSlices=13, ImageSize=[40, 30])
    for kind in KINDS:
        for level in (0, 1):
            SaveData(os.path.join(folder, f"source-{kind}{level}.{kind}"), proxy=sweep, CompressionLevel=level)
            reader = OpenDataFile(os.path.join(folder, f"source-{kind}{level}.{kind}"))
            assert reader.GetXMLName() == "LacunaTrackedSliceReader"
            SaveData(os.path.join(folder, f"copy-{kind}{level}.{kind}"), proxy=reader, CompressionLevel=level)
            Delete(reader)
    # a part of the slices, through a filter that works in pieces
    part = TrackedSliceReader(FileName=os.path.join(folder, "source-mha0.mha"), FrameRange=[2, 10], FrameStride=2)
    SaveData(os.path.join(folder, "part.mha"), proxy=SpeckleFilter(Input=part))
    # a replay, at the beginning, in the middle, and at the end
    replay = TrackedSliceReader(FileName=os.path.join(folder, "source-mha1.mha"), ReplayInTime=1)
    replay.UpdatePipelineInformation()
    assert len(replay.TimestepValues) == 13
    view = GetAnimationScene()
    for number, time in enumerate(TIMES):
        view.AnimationTime = time
        replay.UpdatePipeline(time)
        writer = CreateWriter(os.path.join(folder, f"replay-{number}.mha"), replay, CompressionLevel=0)
        writer.UpdatePipeline(time)
        Delete(writer)
    # what cannot be written is said once, and no rank waits for another
    SaveData(os.path.join(folder, "no-such-folder", "x.mha"), proxy=sweep)


def run(folder, ranks):
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    printed = run_ranks(ranks, __file__, folder, str(ranks))
    errors = [line for line in printed.splitlines() if "ERR|" in line]
    assert len(errors) == 1 and "no-such-folder" in printed and "No such file" in printed, printed
    return {name: open(os.path.join(folder, name), "rb").read() for name in sorted(os.listdir(folder))}


def main():
    folder = output("TrackedSliceWriterRanks")
    alone = run(folder, 1)
    assert len(alone) == 2 * 2 * 6 + 1 + len(TIMES), sorted(alone)
    assert all(alone.values())
    for kind in KINDS:  # the copy has the same slices; its provenance has grown
        for raw in (name for name in alone if name.startswith("source-") and "raw" in name):
            assert alone[raw] == alone[raw.replace("source", "copy")], raw
    for number, count in enumerate((1, None, 13)):
        header = alone[f"replay-{number}.mha"].partition(b"ElementDataFile = LOCAL\n")[0]
        valid = header.count(b"ImageStatus = OK")
        assert valid == count or (count is None and 1 < valid < 13), (number, valid)
        assert valid + header.count(b"ImageStatus = INVALID") == 13
    for ranks in (2, 3):
        together = run(folder, ranks)
        assert sorted(together) == sorted(alone), ranks
        for name, content in alone.items():
            assert together[name] == content, (ranks, name)
    print("ok")


if len(sys.argv) > 2:
    write(sys.argv[1], int(sys.argv[2]))
else:
    main()
