# SPDX-License-Identifier: BSD-3-Clause
"""Readers under MPI read only their part: each rank the slices in which its part lies, and of a CT series opens no other file for pixels.

Run without arguments it is the test; it runs itself in pvbatch on all ranks at once, with the folder of files.
"""
import os
import resource
import shutil
import sys

import lacuna_test
import numpy as np
from ct_series_files import write_series

RANKS = 1, 2, 4
# ParaView divides images along their longest axis: here across the slices, also twice
SLICES, ROWS, COLUMNS = 320, 90, 120
CT_SLICES, CT_ROWS, CT_COLUMNS = 280, 100, 110
SLACK = 4096  # bytes that are read beside pixels and the system's memory, /proc/self/io for one: less than a slice


def write_sequence(folder, separate, name="slices", rows=ROWS, columns=COLUMNS):
    """Slices, slice n of grey level n, as .mha or as .mhd with a file of pixels; sparse and all 0 when it is large."""
    fields = "".join(f"Seq_Frame{n:04}_ImageToReferenceTransform = 1 0 0 0 0 1 0 0 0 0 1 {0.1 * n:.1f} 0 0 0 1\n"
                     f"Seq_Frame{n:04}_ImageToReferenceTransformStatus = OK\nSeq_Frame{n:04}_Timestamp = {n / 25}\n" for n in range(SLICES))
    header = (f"ObjectType = Image\nNDims = 3\nDimSize = {columns} {rows} {SLICES}\nElementSpacing = 1 1 1\nElementType = MET_USHORT\n"
              f"BinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\nUltrasoundImageOrientation = MF\n{fields}"
              f"ElementDataFile = {f'{name}.raw' if separate else 'LOCAL'}\n").encode("ascii")
    if rows * columns > 1e6:
        with open(os.path.join(folder, f"{name}.mha"), "wb") as file:
            file.write(header)
            file.truncate(len(header) + 2 * SLICES * rows * columns)
        return
    pixels = np.repeat(np.arange(SLICES, dtype=np.uint16), rows * columns).tobytes()
    for ending, content in (("mhd", header), ("raw", pixels)) if separate else (("mha", header + pixels),):
        with open(os.path.join(folder, f"{name}.{ending}"), "wb") as file:
            file.write(content)


# --- in pvbatch, on every rank for itself ---


def bytes_read():
    """That this process has read so far, from files or whatever else."""
    with open("/proc/self/io", encoding="ascii") as file:
        return int(next(line for line in file if line.startswith("rchar:")).split()[1])


def read_part(reader, rank, ranks, prepare=None):
    """The first and last slice of the rank's part, and how many bytes were read for it behind the headers."""
    reader.UpdateInformation()
    if prepare:
        prepare()
    before = bytes_read()
    reader.UpdatePiece(rank, ranks, 0)
    read = bytes_read() - before
    image = reader.GetOutputDataObject(0)
    extent = image.GetExtent()
    whole = reader.GetOutputInformation(0).Get(reader.GetExecutive().WHOLE_EXTENT())
    assert extent[:4] == tuple(whole[:4]), (extent, "this is no division across the slices")
    scalars = image.GetPointData().GetScalars()
    values = {image.GetScalarComponentAsDouble(extent[0], extent[2], k, 0) - k for k in range(extent[4], extent[5] + 1)}
    assert values == {0}, values
    assert scalars.GetNumberOfTuples() == (extent[1] + 1) * (extent[3] + 1) * (extent[5] - extent[4] + 1)
    return extent[4], extent[5], read


def check_part(name, part, rank, ranks, slices, size, beside):
    """The parts meet at shared slices; read: the pixels of a part, slices of so many bytes, and nothing but so many bytes beside them."""
    first, last, read = part
    steps = slices - 1
    assert abs(first - steps * rank / ranks) <= 1 and abs(last - steps * (rank + 1) / ranks) <= 1, (name, first, last)
    count = last - first + 1
    assert 0 <= read - count * size < beside + SLACK, f"{name}, rank {rank} of {ranks}: {read} bytes for {count} slices"
    print(f"{name}, rank {rank} of {ranks}: slices {first} to {last}, {read} bytes", flush=True)


def run(folder, ranks):
    from lacuna.vtkLacunaReadersCTSeries import vtkLacunaCTSeriesReader
    from lacuna.vtkLacunaReadersTrackedSlices import vtkLacunaTrackedSliceReader
    from vtkmodules.vtkParallelCore import vtkMultiProcessController
    controller = vtkMultiProcessController.GetGlobalController()
    rank = controller.GetLocalProcessId()
    assert controller.GetNumberOfProcesses() == ranks
    bytes_read()
    # Readers ask the system how much memory there is, in texts as long as its groups are many: all that is read for slices of two pixels.
    tiny = vtkLacunaTrackedSliceReader()
    tiny.SetFileName(os.path.join(folder, "tiny.mha"))
    beside = read_part(tiny, rank, ranks)[2]
    for name in ("slices.mha", "slices.mhd"):
        reader = vtkLacunaTrackedSliceReader()
        reader.SetFileName(os.path.join(folder, name))
        part = read_part(reader, rank, ranks)
        check_part(name, part, rank, ranks, SLICES, 2 * ROWS * COLUMNS, beside)

    # A preview depends on no rank's memory: on all of it, the last rank would take every second slice.
    if ranks > 1 and not lacuna_test.SANITIZED:
        before = resource.getrlimit(resource.RLIMIT_AS)
        if rank == ranks - 1:
            resource.setrlimit(resource.RLIMIT_AS, (2 ** 33, before[1]))
        reader = vtkLacunaTrackedSliceReader()
        reader.SetFileName(os.path.join(folder, "large.mha"))
        reader.UpdateInformation()
        assert reader.GetOutputInformation(0).Get(reader.GetExecutive().WHOLE_EXTENT())[5] == SLICES - 1, reader.GetPreview()
        resource.setrlimit(resource.RLIMIT_AS, before)

    own = os.path.join(folder, f"series-{ranks}-{rank}")  # of this rank, which takes others' files away
    shutil.copytree(os.path.join(folder, "series"), own)
    first = (CT_SLICES - 1) * rank // ranks - 1
    last = -(-(CT_SLICES - 1) * (rank + 1) // ranks) + 1

    def take_away():
        for n in range(CT_SLICES):
            if not first <= n <= last:
                os.remove(os.path.join(own, f"{n:03}.dcm"))

    reader = vtkLacunaCTSeriesReader()
    reader.SetFileName(own)
    part = read_part(reader, rank, ranks, take_away)
    check_part("CT series", part, rank, ranks, CT_SLICES, 2 * CT_ROWS * CT_COLUMNS, beside)
    print("rank done", flush=True)


def main():
    folder = lacuna_test.output("ReadersRanks")
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(os.path.join(folder, "series"))
    write_sequence(folder, False)
    write_sequence(folder, True)
    write_sequence(folder, False, "tiny", 1, 2)
    write_sequence(folder, False, "large", 2000, 2400)
    write_series(os.path.join(folder, "series"), [np.full((CT_ROWS, CT_COLUMNS), n) for n in range(CT_SLICES)])
    for ranks in RANKS:
        printed = lacuna_test.run_ranks(ranks, __file__, "in pvbatch", folder, str(ranks), options=["--symmetric"])
        assert printed.count("rank done") == ranks and "ERR|" not in printed, printed


if sys.argv[1:2] == ["in pvbatch"]:
    run(sys.argv[2], int(sys.argv[3]))
else:
    main()
