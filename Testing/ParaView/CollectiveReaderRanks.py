# SPDX-License-Identifier: BSD-3-Clause
"""Behind readers that all ranks must call together (raw images and NRRD, by MPI-IO), serial filters give what they give on one rank, and none fails or waits.
Volumes that do not fit into the memory are refused there, too: such readers end the program when nothing is asked of them.

Run without arguments it is the test; it runs itself in pvbatch on all ranks.
"""
import os
import resource
import sys

import lacuna_test
import numpy as np

SHAPE = 40, 30, 20  # z, y, x
FOLDER = os.path.abspath(lacuna_test.output("CollectiveReaderRanks"))


LARGE = 2048
HEADER = "NRRD0004\ntype: {0}\ndimension: 3\nsizes: {3} {2} {1}\nencoding: raw\nspacings: 1 1 1\n\n"


def write_volume():
    """A bright box in speckle, as NRRD and raw; the same of 32 GiB, sparse."""
    os.makedirs(FOLDER, exist_ok=True)
    voxels = np.random.default_rng(5).integers(20, 60, SHAPE).astype(np.uint8)
    voxels[12:28, 8:22, 4:14] += 120
    for name, header, data, size in (("box.nrrd", HEADER.format("uint8", *SHAPE), voxels.tobytes(), voxels.size), ("box.raw", "", voxels.tobytes(), voxels.size),
                                     ("large.nrrd", HEADER.format("float", LARGE, LARGE, LARGE), b"", 4 * LARGE**3), ("large.raw", "", b"", 4 * LARGE**3)):
        with open(os.path.join(FOLDER, name), "wb") as file:
            file.write(header.encode("ascii") + data)
            file.truncate(len(header) + size)


def readers(name, shape, voxel):
    """Of NRRD and raw files."""
    from paraview import servermanager
    from paraview import simple as pv
    size = {"Dimensions": list(reversed(shape))}  # ParaView 6.1
    if servermanager.sources.ImageReader().GetProperty("DataExtent") is not None:
        size = {"DataExtent": [index for count in reversed(shape) for index in (0, count - 1)]}
    return (("nrrd", lambda: pv.NrrdReader(FileName=os.path.join(FOLDER, f"{name}.nrrd"))),
            ("raw", lambda: pv.ImageReader(FileNames=[os.path.join(FOLDER, f"{name}.raw")], DataScalarType=voxel, FileDimensionality=3, **size)))


def run():
    import lacuna.plugin
    lacuna.plugin.load()
    from lacuna.errors import raising
    from paraview import simple as pv
    from paraview import servermanager

    def contrast(source):
        table = servermanager.Fetch(pv.ContrastToSpeckle(Input=source, InsideBounds=[5, 12, 10, 20, 14, 26],
                                                         OutsideBounds=[0, 19, 0, 29, 0, 8], IsoValue=100))
        return [table.GetColumn(c).GetVariantValue(0).ToString() for c in range(table.GetNumberOfColumns())]

    for name, make in readers("box", SHAPE, "unsigned char"):
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


def refuse():
    """The address space is limited."""
    refused = []
    import lacuna.plugin
    lacuna.plugin.load()
    from lacuna.errors import raising
    from paraview import simple as pv

    for name, make in readers("large", (LARGE, LARGE, LARGE), "float"):
        source = make()
        for title, filter_ in (("Mirror", pv.Mirror(Input=source)), ("Occluded Angle", pv.OccludedAngle(Input=source)),
                               ("Iso Ray Caster", pv.BSplineIsoRayCaster(Input=source, IsoValues=[100])),
                               ("Contrast", pv.ContrastToSpeckle(Input=source, IsoValue=100)), ("Phantom Sweep", pv.PhantomSweep(Input=source))):
            try:
                with raising():
                    filter_.UpdatePipeline()
            except RuntimeError as error:
                assert "34359738368 bytes" in str(error), error
                refused.append((name, title))
    assert len(refused) == 10, refused


def main():
    write_volume()
    found = {ranks: [line for line in lacuna_test.run_ranks(ranks, __file__, "in pvbatch").splitlines() if line.startswith("result")]
             for ranks in (1, 2)}
    assert len(found[1]) == 8 and len(set(found[1])) == 8, found[1]
    assert found[2] == found[1], found
    if not lacuna_test.SANITIZED:
        limit = resource.getrlimit(resource.RLIMIT_AS)[1]
        resource.setrlimit(resource.RLIMIT_AS, (12 << 30, limit))  # of this process, and those that it starts
        for ranks in (1, 2):
            lacuna_test.run_ranks(ranks, __file__, "refuse")
        refuse()
    for name in ("large.nrrd", "large.raw"):
        os.remove(os.path.join(FOLDER, name))


if sys.argv[1:2] == ["in pvbatch"]:
    run()
elif sys.argv[1:2] == ["refuse"]:
    refuse()
else:
    main()
