# SPDX-License-Identifier: BSD-3-Clause
"""Behind readers that all ranks must call together (raw images and NRRD, by MPI-IO), serial filters give what they give on one rank, and none fails or waits.

Run without arguments it is the test; it runs itself in pvbatch on all ranks.
"""
import os
import sys

import lacuna_test
import numpy as np

SHAPE = 40, 30, 20  # z, y, x
FOLDER = os.path.abspath(lacuna_test.output("CollectiveReaderRanks"))


def write_volume():
    """A bright box in speckle, as NRRD and raw."""
    os.makedirs(FOLDER, exist_ok=True)
    voxels = np.random.default_rng(5).integers(20, 60, SHAPE).astype(np.uint8)
    voxels[12:28, 8:22, 4:14] += 120
    header = ("NRRD0004\ntype: uint8\ndimension: 3\nsizes: {2} {1} {0}\nencoding: raw\nspacings: 1 1 1\n\n").format(*SHAPE)
    with open(os.path.join(FOLDER, "box.nrrd"), "wb") as file:
        file.write(header.encode("ascii") + voxels.tobytes())
    with open(os.path.join(FOLDER, "box.raw"), "wb") as file:
        file.write(voxels.tobytes())


def run():
    import lacuna.plugin
    lacuna.plugin.load()
    from lacuna.errors import raising
    from paraview import simple as pv
    from paraview import servermanager

    def nrrd():
        return pv.NrrdReader(FileName=os.path.join(FOLDER, "box.nrrd"))

    def raw():
        depth, height, width = SHAPE
        return pv.ImageReader(FileNames=[os.path.join(FOLDER, "box.raw")], DataScalarType="unsigned char",
                              DataExtent=[0, width - 1, 0, height - 1, 0, depth - 1], FileDimensionality=3)

    def contrast(source):
        table = servermanager.Fetch(pv.ContrastToSpeckle(Input=source, InsideBounds=[5, 12, 10, 20, 14, 26],
                                                         OutsideBounds=[0, 19, 0, 29, 0, 8], IsoValue=100))
        return [table.GetColumn(c).GetVariantValue(0).ToString() for c in range(table.GetNumberOfColumns())]

    for name, make in (("nrrd", nrrd), ("raw", raw)):
        with raising():
            print("result", name, "at first", contrast(make()))
            parts = make()
            parts.UpdatePipeline()  # each rank has a part
            print("result", name, "after parts", contrast(parts))
            parts.UpdatePipeline()
            smooth = pv.SpeckleFilter(Input=parts, KernelSize=[3, 3, 3])
            print("result", name, "smoothed", contrast(smooth))
            smooth.KernelSize = [5, 5, 5]
            smooth.UpdatePipeline()
            print("result", name, "smoothed more", contrast(smooth), flush=True)


def main():
    write_volume()
    found = {ranks: [line for line in lacuna_test.run_ranks(ranks, __file__, "in pvbatch").splitlines() if line.startswith("result")]
             for ranks in (1, 2)}
    assert len(found[1]) == 8 and len(set(found[1])) == 8, found[1]
    assert found[2] == found[1], found


if sys.argv[1:2] == ["in pvbatch"]:
    run()
else:
    main()
