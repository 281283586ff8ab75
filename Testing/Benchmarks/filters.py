# SPDX-License-Identifier: BSD-3-Clause
"""Whole filters that have no program of their own, in VTK alone.

    . build/release/lacuna-env.sh
    python3 Testing/Benchmarks/filters.py [--benchmark_filter=Mirror]

Mirror: Skull Phantom of 256 voxels along each edge, with the plane found and given. SlicePlanes: 200 slices of 640 x 480, one thread,
drawn with at most so many points. Writer: the sweep of ultrasound_spine in LACUNA_TEST_DATA by level of compression.
"""
import os
import tempfile

from harness.rows import Program


def update(filter_):
    def measured():
        filter_.Modified()
        filter_.Update()
        return {"MB": filter_.GetOutputDataObject(0).GetActualMemorySize() * 1024 / 1e6}
    return measured


def mirror(edge, has_plane):
    def prepare():
        import lacuna
        skull = lacuna.vtkLacunaSkullPhantom()
        skull.SetSpacing(*[173.5 / edge] * 3)
        skull.Update()
        filter_ = lacuna.vtkLacunaMirror()
        filter_.SetInputData(skull.GetOutput())
        if has_plane:
            filter_.SetPlaneMethod(filter_.Given)
            filter_.SetOrigin(0, 0, 0)
            filter_.SetNormal(1, 0, 0)
        return update(filter_)
    return prepare


def slice_planes(points):
    def prepare():
        import lacuna
        sweep = lacuna.vtkLacunaPhantomSweep()
        sweep.SetNumberOfSlices(200)
        sweep.SetImageSize(640, 480)
        sweep.Update()
        planes = lacuna.vtkLacunaSlicePlanes()
        planes.SetInputData(sweep.GetOutput())
        planes.SetMaximumNumberOfPoints(points)
        return update(planes)
    return prepare


def writer(level):
    def prepare():
        import lacuna
        reader = lacuna.vtkLacunaTrackedSliceReader()
        path = os.path.join(os.environ.get("LACUNA_TEST_DATA", ""), "ultrasound_spine", "SpinePhantomFreehand.igs.mha")
        if not os.path.exists(path):
            return None
        reader.SetFileName(path)
        reader.Update()
        folder = tempfile.TemporaryDirectory(prefix="lacuna-benchmark-")
        target = os.path.join(folder.name, "sweep.igs.mha")
        written = lacuna.vtkLacunaTrackedSliceWriter()
        written.SetInputData(reader.GetOutput())
        written.SetFileName(target)
        written.SetCompressionLevel(level)

        def measured(_keep=folder):
            written.Modified()
            written.Write()
            return {"MB": os.path.getsize(target) / 1e6}
        return measured
    return prepare


program = Program(__doc__)
program.add("Mirror/edge:256", mirror(256, False))
program.add("MirrorGivenPlane/edge:256", mirror(256, True))
for most in (1000000, 4000000, 100000000):
    program.add(f"SlicePlanes/points:{most}", slice_planes(most))
for compression in (0, 1, 6, 9):
    program.add(f"Writer/level:{compression}", writer(compression))

if __name__ == "__main__":
    program.main()
