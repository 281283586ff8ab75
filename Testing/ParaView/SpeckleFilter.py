# SPDX-License-Identifier: BSD-3-Clause
"""Speckle Filter and Contrast To Speckle through ParaView: defaults, phantom, state, pieces, compounding."""
import os

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from paraview.simple import *
from paraview import servermanager
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from lacuna import speckle

OPERATIONS = ["Median", "Rank", "Minimum", "Maximum", "Opening", "Closing", "OpenClose", "CloseOpen",
              "Mode", "AdaptiveMedian", "Mean", "Gaussian", "LaplacianOfGaussian"]


def check_defaults():
    """The panel's defaults are the classes' own."""
    source = PhantomSweep(NumberOfSlices=1, ImageSize=[8, 8])
    proxy = SpeckleFilter(Input=source)
    own = lacuna.vtkLacunaSpeckleFilter()
    assert proxy.Operation == OPERATIONS[own.GetOperation()]
    assert proxy.KernelShape == ["Box", "Ellipsoid"][own.GetKernelShape()]
    assert list(proxy.KernelSize) == list(own.GetKernelSize())
    for name in ("Rank", "StandardDeviation", "AdaptiveStrength"):
        assert getattr(proxy, name) == getattr(own, "Get" + name)(), name
    proxy = ContrastToSpeckle(Input=source)
    own = lacuna.vtkLacunaContrastToSpeckle()
    for name in ("InsideArray", "OutsideArray", "IsoValue"):
        assert getattr(proxy, name) == getattr(own, "Get" + name)(), name
    for name in ("InsideBounds", "OutsideBounds"):
        assert list(getattr(proxy, name)) == list(getattr(own, "Get" + name)()), name


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
        assert (results[a] >= results["Minimum"]).all() or a == "Gaussian"
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
    text = speckle.table(rows)
    assert len(text.splitlines()) == len(rows) + 2 and "Median 5x5" in text


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
        source.SetOutputScalarType(source.FLOAT)
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


check_defaults()
check_tracked_slices()
check_operations()
check_contrast()
check_selection()
check_compounding()
check_state()
