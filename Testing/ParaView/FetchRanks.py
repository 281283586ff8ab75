# SPDX-License-Identifier: BSD-3-Clause
"""lacuna.data.fetch gives on several ranks, in pvbatch and from a server, what it gives on one: whole images with all arrays, that lie as they did.

Run without arguments it is the test; it runs itself in pvbatch.
"""
import hashlib
import os
import sys

import lacuna_test


def describe(image):
    """The image but what differs between numbers of ranks (Provenance and times), its place to 10⁻⁹ mm."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    points = image.GetPointData()
    arrays = [points.GetArray(index) for index in range(points.GetNumberOfArrays())]
    fields = image.GetFieldData()
    place = [*image.GetOrigin(), *image.GetSpacing(), *(image.GetDirectionMatrix().GetElement(k // 3, k % 3) for k in range(9))]
    return [image.GetExtent(), [round(number, 9) + 0.0 for number in place], points.GetScalars() and points.GetScalars().GetName(),
            sorted((array.GetName(), hashlib.sha256(vtk_to_numpy(array).tobytes()).hexdigest()[:16]) for array in arrays),
            sorted(fields.GetArrayName(index) for index in range(fields.GetNumberOfArrays()))]


def make_sweep_without_a_pose():
    """Writes the sequence that fetched() reads, whose second pose is no number; before any rank does."""
    lines = ["ObjectType = Image", "NDims = 3", "DimSize = 5 4 7", "ElementSpacing = 1 1 1", "ElementType = MET_UCHAR",
             "UltrasoundImageOrientation = MF", "UltrasoundImageType = BRIGHTNESS"]
    for frame in range(7):
        x = "nan" if frame == 1 else frame
        lines += [f"Seq_Frame{frame:04}_ImageToReferenceTransform = 1 0 0 {x} 0 1 0 0 0 0 1 {frame} 0 0 0 1",
                  f"Seq_Frame{frame:04}_ImageToReferenceTransformStatus = OK", f"Seq_Frame{frame:04}_Timestamp = {frame}"]
    written = lacuna_test.output(f"FetchRanks-{os.getpid()}.igs.mha")
    with open(written, "wb") as file:
        file.write("\n".join([*lines, "ElementDataFile = LOCAL", ""]).encode() + bytes(range(140)))
    os.replace(written, lacuna_test.output("FetchRanks.igs.mha"))  # another test may be reading it


def fetched():
    """Descriptions of outputs of all pipelines: volume, depth map that is turned, filled map, closed shape, slices fewer than some ranks."""
    import lacuna.plugin
    lacuna.plugin.load()
    import paraview.simple as pv
    from lacuna.data import fetch
    from lacuna.errors import raising
    sweep = pv.PhantomSweep(NumberOfSlices=12, ImageSize=[40, 30], PixelSpacing=1)
    depth = pv.BSplineIsoRayCaster(Input=pv.SkullPhantom(Spacing=[4] * 3, DefectRadius=25, DefectDirection=[0.5, -0.2, 0.8]), IsoValues=[500],
                                   PixelSpacing=30 / 7, ViewDirection=[-0.5, 0.2, -0.8])
    proxies = [pv.SweptVolume(Input=sweep, OutputSpacing=[2] * 3), depth, pv.RBFHoleFiller(Input=depth),
               pv.OccludedAngle(Input=pv.IncompleteShape(Shape="Sphere", Dimensions=[40] * 3), NumberOfDirections=20),
               pv.PhantomSweep(NumberOfSlices=2, ImageSize=[5, 3]),
               pv.Wavelet(WholeExtent=[-7, 5, 3, 9, -11, 8]),
               pv.TrackedSliceReader(FileName=lacuna_test.output("FetchRanks.igs.mha"))]
    with raising():
        return [describe(fetch(proxy)) for proxy in proxies]


def main():
    lines = {}
    make_sweep_without_a_pose()
    for ranks in 1, 3:
        printed = lacuna_test.run_ranks(ranks, __file__, "in pvbatch")
        lines[ranks] = [line for line in printed.splitlines() if line.startswith("fetched ")]
        assert len(lines[ranks]) == 7, printed
    assert lines[1] == lines[3], lines
    assert all("(0, -1" not in line for line in lines[1]), lines


if sys.argv[1:2] == ["in pvbatch"]:
    for each in fetched():
        print("fetched", each, flush=True)
elif __name__ == "__main__":
    main()
