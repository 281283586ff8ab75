# SPDX-License-Identifier: BSD-3-Clause
"""Speckle Filter and Contrast To Speckle through ParaView: defaults, phantom, compounding, state, trace."""
import os

import lacuna.plugin
import numpy as np
from lacuna_test import check_defaults

lacuna.plugin.load()
from paraview.simple import *
from paraview import servermanager, smtrace
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from lacuna import speckle
from lacuna.errors import PipelineError, raising

OPERATIONS = ["Median", "Rank", "Minimum", "Maximum", "Opening", "Closing", "OpenClose", "CloseOpen",
              "Mode", "AdaptiveMedian", "Mean", "Gaussian", "LaplacianOfGaussian", "TopHat"]


def check_panels():
    """The panel's defaults are the classes' own."""
    source = PhantomSweep(NumberOfSlices=1, ImageSize=[8, 8])
    proxy = SpeckleFilter(Input=source)
    own = lacuna.vtkLacunaSpeckleFilter()
    names = ["KernelSize", "ScalarArray", "Rank", "StandardDeviation", "AdaptiveStrength"]
    check_defaults(proxy, own, names, {"Operation": OPERATIONS, "KernelShape": ["Box", "Ellipsoid"]})
    proxy = ContrastToSpeckle(Input=source)
    own = lacuna.vtkLacunaContrastToSpeckle()
    names = ["ScalarArray", "InsideArray", "OutsideArray", "IsoValue", "InsideBounds", "OutsideBounds"]
    check_defaults(proxy, own, names)


def check_arrays():
    """The input's own scalars, whichever source is active; a chosen array; a wrong name is an error."""
    other = Wavelet()
    other.UpdatePipeline()
    sweep = PhantomSweep(NumberOfSlices=1, ImageSize=[30, 20], SpeckleLevel=0.3)
    both = Calculator(Input=sweep, ResultArrayName="Double", Function="2 * Intensity")
    SetActiveSource(other)
    proxy = SpeckleFilter(Input=sweep)
    contrast = ContrastToSpeckle(Input=sweep, InsideBounds=[0, 9, 0, 9, 0, 0])
    with raising():
        proxy.UpdatePipeline()
        mean = servermanager.Fetch(contrast).GetColumnByName("InsideMean").GetValue(0)
    assert servermanager.Fetch(proxy).GetPointData().GetScalars().GetName() == "Intensity"
    proxy = SpeckleFilter(Input=both, ScalarArray="Double")
    points = servermanager.Fetch(proxy).GetPointData()
    raw = vtk_to_numpy(servermanager.Fetch(sweep).GetPointData().GetScalars())
    assert (vtk_to_numpy(points.GetArray("Intensity")) == raw).all()
    assert (vtk_to_numpy(points.GetArray("Double")) != 2 * raw).any()
    double = ContrastToSpeckle(Input=both, ScalarArray="Double", InsideBounds=[0, 9, 0, 9, 0, 0])
    assert abs(servermanager.Fetch(double).GetColumnByName("InsideMean").GetValue(0) - 2 * mean) < 1e-9
    try:
        with raising():
            SpeckleFilter(Input=sweep, ScalarArray="Echo").UpdatePipeline()
        raise AssertionError("a missing array was accepted")
    except PipelineError as error:
        assert "no point array 'Echo'" in str(error), error


def check_tracked_slices():
    """A filtered sweep is still a sweep, filtered slice by slice, and goes on to a volume."""
    sweep = PhantomSweep(NumberOfSlices=6, ImageSize=[64, 48], PixelSpacing=1, SpeckleLevel=0.3)
    raw = servermanager.Fetch(sweep)
    median = SpeckleFilter(Input=sweep, KernelSize=[3, 3, 1])
    out = servermanager.Fetch(median)
    shape = raw.GetDimensions()[::-1]
    before = vtk_to_numpy(raw.GetPointData().GetScalars()).reshape(shape)
    after = vtk_to_numpy(out.GetPointData().GetScalars()).reshape(shape)
    padded = np.pad(before, ((0, 0), (1, 1), (1, 1)), mode="edge")
    windows = np.stack([padded[:, j:j + shape[1], i:i + shape[2]] for j in range(3) for i in range(3)])
    assert (np.median(windows, axis=0) == after).all()
    for name in ("ImageToReference", "Timestamp", "SliceStatus", "FrameNumber"):
        a, b = (vtk_to_numpy(d.GetFieldData().GetArray(name)) for d in (raw, out))
        assert (a == b).all(), name
    volume = SweptVolume(Input=median, OutputSpacing=[2, 2, 2])
    volume.UpdatePipeline()
    assert volume.GetDataInformation().GetNumberOfPoints() > 1000


def check_operations():
    """Every operation by its name; a percentile of 0 is the minimum; Gaussian lengths are pixels here."""
    sweep = PhantomSweep(NumberOfSlices=2, ImageSize=[40, 30], PixelSpacing=1, SpeckleLevel=0.3)
    results = {}
    for operation in OPERATIONS:
        proxy = SpeckleFilter(Input=sweep, Operation=operation, KernelSize=[3, 3, 1], Rank=0)
        results[operation] = vtk_to_numpy(servermanager.Fetch(proxy).GetPointData().GetScalars())
        assert results[operation].dtype == (np.float32 if operation == "LaplacianOfGaussian" else np.uint8)
    assert (results["Rank"] == results["Minimum"]).all()
    assert (results["Opening"] <= results["Closing"]).all()
    for a in ("Median", "Mode", "AdaptiveMedian", "Mean", "Gaussian"):
        if a != "Gaussian":  # which looks beyond the window
            assert (results[a] >= results["Minimum"]).all(), a
        assert results[a].std() < vtk_to_numpy(servermanager.Fetch(sweep).GetPointData().GetScalars()).std()


def check_contrast():
    """Filters raise the CSR of the phantom's object, and leave fewer thresholded regions."""
    sweep = PhantomSweep(NumberOfSlices=1, SpeckleLevel=0.4)
    image = speckle.truth_masks(sweep, inside=(100, 260), outside=(50, 70))
    rows = speckle.compare(image, inside_array="Inside", outside_array="Outside", iso_value=120)
    by_name = {row["filter"]: row for row in rows}
    raw = by_name["none"]
    assert raw["Regions"] > 200
    for name in ("Median 5x5", "Mean 5x5", "Gaussian 1.41", "Mode 5x5", "OpenClose 5x5"):
        assert by_name[name]["CSR"] > 1.4 * raw["CSR"], name
        assert by_name[name]["Regions"] < raw["Regions"] / 5, name
    double = Calculator(Input=image, ResultArrayName="Double", Function="2 * Intensity")
    filters = {"Mean 5x5": speckle.FILTERS["Mean 5x5"]}
    row = speckle.compare(double, filters, inside_array="Inside", outside_array="Outside", scalar_array="Double")[0]
    assert abs(row["InsideMean"] / by_name["Mean 5x5"]["InsideMean"] - 2) < 0.01
    text = speckle.table(rows)
    assert len(text.splitlines()) == len(rows) + 2 and "Median 5x5" in text


def check_real_slice():
    """On real ultrasound filters leave a third of the thresholded regions, as in the thesis (63, mean 17, median 20)."""
    name = os.path.join(os.environ.get("LACUNA_TEST_DATA", ""), "ultrasound_spine", "SpinePhantomFreehand.igs.mha")
    if not os.path.exists(name):
        print(f"without the real slice: {name} is not there", flush=True)
        return
    image = TrackedSliceReader(FileName=name, FrameRange=[10, 10], ReferenceFrame="Tracker")
    rows = speckle.compare(image, inside_bounds=[200, 620, 20, 120, 10, 10], iso_value=60)
    regions = {row["filter"]: row["Regions"] for row in rows}
    print("real slice:", regions)
    assert [regions[name] for name in ("none", "Mean 5x5", "Median 5x5", "Gaussian 1.41")] == [79, 22, 25, 27]


def check_selection():
    """A selection becomes a region by Extract Selection with Preserve Topology."""
    sweep = PhantomSweep(NumberOfSlices=1, ImageSize=[40, 30], SpeckleLevel=0.3)
    sweep.UpdatePipeline()
    selection = IDSelectionSource(FieldType="POINT", IDs=[0, 0, 0, 1, 0, 40])
    extract = ExtractSelection(Input=sweep, Selection=selection, PreserveTopology=1)
    row = speckle.measure(extract, inside_array="vtkInsidedness")
    assert row["InsideCount"] == 3 and row["OutsideCount"] == 1197, row


def check_compounding():
    """Mean of n independent speckle images: SNR grows as the root of n; maximum: nearly so."""
    def slice_of(seed):
        source = lacuna.vtkLacunaPhantomSweep()
        source.SetNumberOfSlices(1)
        source.SetImageSize(320, 240)
        source.SetSpeckleLevel(0.52)  # standard deviation / mean of fully developed speckle
        source.SetOutputScalarType(source.Float)
        source.SetSeed(seed)
        source.Update()
        return source.GetOutput()

    def snr(values, like):
        image = type(like)()
        image.DeepCopy(like)
        array = numpy_to_vtk(values, deep=1)
        array.SetName("Intensity")
        image.GetPointData().SetScalars(array)
        contrast = lacuna.vtkLacunaContrastToSpeckle()
        contrast.SetInputData(image)
        contrast.SetInsideBounds(2, 60, 2, 60, 0, 0)  # plain tissue in the upper left corner
        contrast.Update()
        return contrast.GetOutput().GetColumnByName("InsideSNR").GetValue(0)

    images = [slice_of(seed) for seed in range(16)]
    values = np.stack([vtk_to_numpy(i.GetPointData().GetScalars()) for i in images])
    single = np.mean([snr(v, images[0]) for v in values])
    assert abs(single - 1 / 0.52) < 0.05, single
    for n in (4, 9, 16):
        mean = snr(values[:n].mean(axis=0), images[0]) / single
        maximum = snr(values[:n].max(axis=0), images[0]) / single
        print(f"compounding {n}: mean {mean:.2f}, maximum {maximum:.2f}, root {n ** 0.5:.2f}")
        assert abs(mean / n ** 0.5 - 1) < 0.04, (n, mean)
        assert maximum / n ** 0.5 > 0.88, (n, maximum)


def check_compounding_of_sweeps():
    """The same by Swept Volume: more sweeps of Phantom Sweep in a volume, more SNR."""
    def snr(count, compounding, level=0.52):  # as fully developed speckle
        sweeps = [PhantomSweep(NumberOfSlices=12, ImageSize=[64, 48], PixelSpacing=1, SpeckleLevel=level, Seed=seed,
                               OutputScalarType="Float") for seed in range(count)]
        volume = SweptVolume(Input=sweeps, OutputSpacing=[1, 1, 1], PixelSampling="Nearest",
                             Compounding=compounding, OutputScalarType="Float")
        volume.UpdatePipeline()
        x0, x1, y0, y1, z0, z1 = volume.GetDataInformation().GetBounds()
        corner = [x0 + 2, x0 + 14, y0 + 2, y0 + 12, z1 - 20, z1]
        return speckle.measure(volume, inside_bounds=corner)["InsideSNR"]

    assert snr(1, "Mean", 0) == np.inf  # plain tissue
    for compounding, least in (("Mean", 0.97), ("Maximum", 0.87)):
        single = snr(1, compounding)
        for n in (4, 9):
            gain = snr(n, compounding) / single
            print(f"compounding {n} sweeps, {compounding}: {gain:.2f}, root {n ** 0.5:.2f}")
            assert least < gain / n ** 0.5 < 1.03, (compounding, n, gain)


def check_trace():
    """What ParaView's trace writes makes the same filters again."""
    sweep = PhantomSweep(NumberOfSlices=1, ImageSize=[40, 30], SpeckleLevel=0.3)
    smtrace.start_trace()
    opening = SpeckleFilter(registrationName="TraceFilter", Input=sweep, Operation="Opening",
                            KernelShape="Ellipsoid", KernelSize=[7, 5, 1])
    contrast = ContrastToSpeckle(registrationName="TraceContrast", Input=opening,
                                 InsideBounds=[0, 20, 0, 20, 0, 0], IsoValue=60)
    trace = smtrace.stop_trace()
    for line in ("Operation = 'Opening'", "KernelShape = 'Ellipsoid'", "KernelSize = [7, 5, 1]",
                 "InsideBounds = [0.0, 20.0, 0.0, 20.0, 0.0, 0.0]", "IsoValue = 60.0"):
        assert line.replace(" ", "") in trace.replace(" ", ""), (line, trace)  # ParaView 6.1 writes fewer blanks
    before = servermanager.Fetch(contrast).GetColumnByName("CSR").GetValue(0)
    Delete(contrast)
    Delete(opening)
    exec(compile(trace, "trace", "exec"), {})
    again = FindSource("TraceContrast")
    assert servermanager.Fetch(again).GetColumnByName("CSR").GetValue(0) == before


def check_state():
    """A state file brings filter and measure back."""
    sweep = PhantomSweep(NumberOfSlices=1, ImageSize=[60, 50], SpeckleLevel=0.3)
    opening = SpeckleFilter(Input=sweep, Operation="Opening", KernelSize=[7, 5, 1], KernelShape="Ellipsoid")
    contrast = ContrastToSpeckle(Input=opening, InsideBounds=[0, 20, 0, 20, 0, 0], IsoValue=60)
    RenameSource("StateContrast", contrast)
    before = servermanager.Fetch(contrast).GetColumnByName("CSR").GetValue(0)
    name = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "SpeckleFilter.pvsm")
    servermanager.SaveState(name)
    ResetSession()
    LoadState(name)
    contrast = FindSource("StateContrast")
    assert contrast.Input.KernelShape == "Ellipsoid" and list(contrast.Input.KernelSize) == [7, 5, 1]
    assert servermanager.Fetch(contrast).GetColumnByName("CSR").GetValue(0) == before


check_panels()
check_arrays()
check_tracked_slices()
check_operations()
check_contrast()
check_real_slice()
check_selection()
check_compounding()
check_compounding_of_sweeps()
check_trace()
check_state()
