# SPDX-License-Identifier: BSD-3-Clause
"""Errors under MPI: what goes wrong on one rank is everybody's error in filters that all ranks make together, and none waits for ever.

Run without arguments it is the test; it runs itself in pvbatch on two ranks, each of which has a time to end in.
"""
import math
import os
import resource
import signal

import lacuna_test

SECONDS = 100
NOTHING = 0, -1, 0, -1, 0, -1


# --- in pvbatch, on every rank for itself ---


def wavelet(edge):
    from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
    source = vtkRTAnalyticSource()
    source.SetWholeExtent(0, edge - 1, 0, edge - 1, 0, edge - 1)
    return source


def landmarks(edge, turned, count=8):
    """Corners of a cube; turned: mirrored, which is an error of all ranks."""
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkPolyData
    points = vtkPoints()
    for corner in range(count):
        x, y, z = (edge * (0.2 + 0.6 * (corner >> axis & 1)) for axis in range(3))
        points.InsertNextPoint(edge - x if turned else x, y, z)
    data = vtkPolyData()
    data.SetPoints(points)
    return data


def occluded_angle(source, wrong):
    from lacuna.vtkLacunaFiltersOcclusion import vtkLacunaOccludedAngle
    made = vtkLacunaOccludedAngle()
    made.SetInputConnection(source.GetOutputPort())
    made.SetNumberOfDirections(40)
    made.SetNumberOfThresholdsOverPi(6)
    made.SetMedianKernel(3)
    made.SetLocalRadii(0, 1e-3 if wrong else 0)
    return made


def mirror(source, wrong):
    from lacuna.vtkLacunaFiltersRadialBasis import vtkLacunaMirror
    made = vtkLacunaMirror()
    made.SetInputConnection(source.GetOutputPort())
    made.SetPlaneMethod(made.Given)
    made.SetOrigin(1e6 if wrong else 10, 0, 0)
    return made


def warp(source, wrong):
    from lacuna.vtkLacunaFiltersRadialBasis import vtkLacunaRBFImageWarp
    made = vtkLacunaRBFImageWarp()
    made.SetInputConnection(source.GetOutputPort())
    made.SetInputData(1, landmarks(30, False))
    made.SetInputData(2, landmarks(30, wrong))
    return made


def update(filter, extent=None):
    """The errors of an update; an extent of its own, or all."""
    said = []

    def listen(_, __, text):
        said.append(text)
    listen.CallDataType = "string0"
    heard = filter.AddObserver("ErrorEvent", listen)
    silent = filter.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
    filter.UpdateInformation()
    if extent:
        filter.UpdateExtent(extent)
    else:
        filter.UpdateWholeExtent()
    filter.RemoveObserver(heard)
    filter.GetExecutive().RemoveObserver(silent)
    return "\n".join(said)


def refused(make, rank):
    """The input does not fit into the memory of the second rank alone."""
    source = wavelet(400)
    filter = make(source, False)
    before = resource.getrlimit(resource.RLIMIT_AS)
    if rank == 1:
        resource.setrlimit(resource.RLIMIT_AS, (lacuna_test.memory_of_process("VmSize") + (150 << 20), before[1]))
    text = update(filter, (0, 9, 0, 9, 0, 9))
    resource.setrlimit(resource.RLIMIT_AS, before)
    assert "256000000 bytes" in text, text
    # there is room now, but nobody knows on which ranks
    assert "change a property" in update(filter, (0, 9, 0, 9, 0, 9))
    source.SetWholeExtent(0, 20, 0, 20, 0, 20)
    text = update(filter)
    assert not text and filter.GetOutput().GetNumberOfPoints() == 21**3, text


def unsound(make, rank):
    """What the second rank has is not sound, and then fewer than the first rank has."""
    from vtkmodules.vtkCommonDataModel import vtkImageData
    for wrong in ("spacing", "nothing", "short", "size"):
        source = wavelet(20)
        filter = make(source, False)
        source.Update()
        image = vtkImageData()
        image.DeepCopy(source.GetOutput())
        if rank == 1 and wrong == "spacing":
            image.SetSpacing(math.nan, 1, 1)
        elif rank == 1 and wrong == "nothing":
            image = vtkImageData()
        elif rank == 1 and wrong == "size":
            image.SetDimensions(20, 20, 19)
            image.GetPointData().GetScalars().SetNumberOfTuples(20 * 20 * 19)
        elif rank == 1:
            image.GetPointData().GetScalars().SetNumberOfTuples(100)
        elif wrong == "nothing":
            image.SetSpacing(1, math.nan, 1)
        filter.SetInputData(image)
        text = update(filter)
        if wrong == "size":
            assert "not the same" in text, text
            continue
        if wrong != "short" or "100" not in text:
            assert "sound" in text, text


def partial(make, rank):
    """What comes before gives each rank a part of its own, whatever is asked of it, as ParaView's Resample To Image does."""
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkCommonExecutionModel import vtkTrivialProducer
    source = wavelet(20)
    source.UpdateExtent((0, 19, 0, 19, 0, 12) if rank == 0 else (0, 19, 0, 19, 12, 19))
    part = vtkImageData()
    part.DeepCopy(source.GetOutput())
    producer = vtkTrivialProducer()
    producer.SetOutput(part)
    producer.SetWholeExtent(0, 19, 0, 19, 0, 19)
    filter = make(source, False)
    filter.SetInputConnection(producer.GetOutputPort())
    text = update(filter)
    assert "only the part 0 19 0 19 " in text, text
    filter.SetInputConnection(source.GetOutputPort())
    text = update(filter)
    assert not text, text


def unpaired(rank):
    """A target that only the first rank has, and targets of which one lies elsewhere."""
    for count, edge in (7, 30), (8, 30.0001):
        filter = warp(wavelet(20), False)
        if rank == 1:
            filter.SetInputData(2, landmarks(edge, False, count))
        text = update(filter)
        assert "not the same" in text, text


def error_of(proxy):
    from lacuna.errors import PipelineError, raising
    try:
        with raising():
            proxy.UpdatePipeline()
        return ""
    except PipelineError as error:
        return str(error)


def distributed(rank):
    """Points of which ParaView gives each rank a part, or all to the first, whatever filters ask for: an error of all ranks."""
    import lacuna.plugin
    from paraview import simple as pv
    lacuna.plugin.load()
    points = pv.Elevation(Input=pv.Sphere(Radius=8))
    parts = pv.ExtractSurface(Input=pv.MergeBlocks(Input=pv.RedistributeDataSet(Input=points)))
    line = pv.PlotOverLine(Input=pv.Wavelet(), Point1=[-9, -9, -9], Point2=[9, 9, 9])
    depth = pv.BSplineIsoRayCaster(Input=pv.SkullPhantom(Spacing=[2, 2, 2]), IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9])
    filled = pv.RBFHoleFiller(Input=depth, Smoothing=5, OutputMargin=30)
    # Lacuna's serial filters: those with a grid are made by the first rank alone, the others by each that asks for all
    model, plate = pv.DefectModel(Input=filled), pv.ImplantPlate(Input=filled)
    for source, is_same in (parts, False), (line, False), (model, False), (plate, True), (points, True):
        users = [pv.RBFInterpolator(Input=source, OutputSpacing=[2] * 3), pv.RBFImageWarp(Input=pv.Wavelet(), Landmarks=pv.Sphere(), Targets=source)]
        if source is not plate:  # which has as many points as a fit takes minutes for
            users.append(pv.RBFHoleFiller(Input=depth, ControlPoints=source))
        for made in users:
            text = error_of(made)
            print(rank, made.GetXMLLabel(), source.GetXMLLabel(), repr(text), flush=True)
            assert ("not the same on all ranks" in text) != is_same, (made.GetXMLLabel(), source.GetXMLLabel(), text)
    # of the first rank's part a serial filter would make a result that looks whole
    assert "not the same on all ranks" in error_of(pv.RBFSurface(Input=parts))
    assert "not the same on all ranks" not in error_of(pv.RBFSurface(Input=line))
    selected(rank, pv, depth)


def selected(rank, pv, depth):
    """Numbers of points of each rank's part are refused; those of pixels are the same on all."""
    from lacuna.vtkLacunaFiltersRadialBasis import vtkLacunaRBFHoleFiller
    surface = pv.DepthMapSurface(Input=depth)
    by_number = pv.IDSelectionSource(IDs=[each for k in range(300) for each in (k % 2, k)], FieldType="POINT")
    rows = [end for row in range(60, 70) for end in (100 * row + 40, 100 * row + 54)]
    by_pixel = pv.ThresholdSelectionSource(ArrayName="PixelId", Thresholds=rows, FieldType="POINT")
    for selection, shown, said in (by_number, surface, "numbers of points"), (by_number, None, "numbers of points"), (by_pixel, surface, ""):
        made = vtkLacunaRBFHoleFiller()
        made.SetInputConnection(depth.GetClientSideObject().GetOutputPort())
        for port, source in (1, shown), (2, selection):
            if source:
                made.SetInputConnection(port, source.GetClientSideObject().GetOutputPort())
        text = update(made)
        print(rank, repr(text), flush=True)
        assert said in text if said else not text, (said, text)
    # behind Extract Selection, also where only the first rank has some of them and works
    for ids in [each for k in range(300) for each in (k % 2, k)], [each for k in range(300) for each in (0, k)]:
        extracted = pv.ExtractSelection(Input=surface, Selection=pv.IDSelectionSource(IDs=ids, FieldType="POINT"))
        for made in pv.RBFHoleFiller(Input=depth, Surface=extracted), pv.RBFSurface(Input=extracted):
            text = error_of(made)
            assert "not the same on all ranks" in text or "was extracted by a selection" in text, (made.GetXMLLabel(), text)


def transparent(rank):
    """Nothing of what the second rank has attenuates."""
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
    image = vtkImageData()
    image.SetDimensions(20, 20, 20)
    image.AllocateScalars(3, 1)
    grey = image.GetPointData().GetScalars()
    grey.Fill(100)
    for voxel in range(3000, 3400):
        grey.SetValue(voxel, 255 if rank == 0 else 200)
    opacity = vtkPiecewiseFunction()
    for value in (0, 0), (200, 0), (255, 1):
        opacity.AddPoint(*value)
    filter = occluded_angle(wavelet(20), False)
    filter.SetInputData(image)
    filter.SetAttenuation(filter.ByOpacityFunction)
    filter.SetOpacityFunction(opacity)
    text = update(filter)
    assert "attenuates" in text, text


def again(make, rank):
    """An error on all ranks, of which one wants nothing; when VTK asks again only the other one comes."""
    source = wavelet(20)
    filter = make(source, True)
    extent = (0, 9, 0, 9, 0, 9) if rank == 0 else NOTHING
    first = update(filter, extent)
    assert first, "no error"
    second = update(filter, extent)
    assert rank == 1 or first.strip()[-60:] in second or "change a property" in second, second
    text = update(make(source, False))
    assert not text, text


def absent(make, rank):
    """The second rank alone lacks the file of its input; and then it has it."""
    from lacuna.vtkLacunaReadersTrackedSlices import vtkLacunaTrackedSliceReader, vtkLacunaTrackedSliceWriter
    from lacuna.vtkLacunaSourcesPhantoms import vtkLacunaPhantomSweep
    file = lacuna_test.output(f"RanksErrors{rank}.igs.mha")
    if os.path.exists(file):
        os.remove(file)

    def write():
        sweep = vtkLacunaPhantomSweep()
        sweep.SetNumberOfSlices(6)
        sweep.SetImageSize(24, 18)
        sweep.Update()
        writer = vtkLacunaTrackedSliceWriter()
        writer.SetInputDataObject(sweep.GetOutput())
        writer.SetFileName(file)
        writer.Update()
    if rank == 0:
        write()
    reader = vtkLacunaTrackedSliceReader()
    reader.SetFileName(file)
    filter = make(reader, False)
    silent = reader.AddObserver("ErrorEvent", lambda *_: None)
    text = update(filter)
    assert "RanksErrors1" in text, text
    reader.RemoveObserver(silent)
    write()
    reader.Modified()  # on both: what has failed together is tried again together
    text = update(filter)
    assert not text and filter.GetOutput().GetNumberOfPoints() > 0, text


def expect(word, ask):
    """Asking is an error that has the word in it."""
    from lacuna.errors import PipelineError, raising
    try:
        with raising():
            ask()
    except PipelineError as error:
        assert word in str(error), (word, str(error))
        return
    raise AssertionError(f"nothing is said of {word!r}")


def holds(word, proxy):
    """The output of a proxy on this rank is empty and holds the error that has the word in it."""
    data = proxy.GetClientSideObject().GetOutputDataObject(0)
    error = data.GetFieldData().GetAbstractArray("LacunaError")
    assert error and word in error.GetValue(0), (word, error)
    assert data.GetNumberOfElements(data.ROW if data.IsA("vtkTable") else data.POINT) == 0, word


def written(file, controller):
    """A file when both ranks are there: the first one alone writes it, and the second does not wait for that."""
    controller.Barrier()
    with open(file, "rb") as opened:
        content = opened.read()
    controller.Barrier()
    return content


def saved(controller):
    """What is wrong on all ranks alike is said each time, and a file that was good stays."""
    from lacuna.errors import raising
    from paraview import simple as pv
    sweep = pv.PhantomSweep(NumberOfSlices=6, ImageSize=[64, 48])
    smooth = pv.SpeckleFilter(Input=sweep, KernelSize=[3, 3, 1])
    file = lacuna_test.output("RanksErrors.nhdr")
    pv.SaveData(file, proxy=smooth)
    before = written(file, controller)
    for proxy, name, bad, good, word in ((sweep, "NumberOfSlices", 0, 6, "NumberOfSlices is 0"),
                                         (smooth, "KernelSize", [0, 3, 1], [3, 3, 1], "KernelSize is 0 voxels")):
        setattr(proxy, name, bad)
        for said in word, "":  # then ParaView finds that the writer does not take empty data
            expect(said, lambda: pv.SaveData(file, proxy=smooth))
            assert written(file, controller) == before, name
            holds(word, smooth)
        setattr(proxy, name, good)
    with raising():
        pv.SaveData(file, proxy=smooth)
    assert written(file, controller) == before


def of_files(rank, controller):
    """A file that is not there, that one rank lacks, or that is damaged where the first rank alone reads: said by all, each time, and a file
    that was good stays."""
    from lacuna.errors import raising
    from paraview import simple as pv
    good, damaged, missing = (lacuna_test.output(f"RanksErrors{name}.mha") for name in ("Good", "Damaged", "Missing"))
    pv.SaveData(good, proxy=pv.PhantomSweep(NumberOfSlices=40, ImageSize=[64, 48]))
    content = written(good, controller)
    own = lacuna_test.output(f"RanksErrorsOfRank{rank}.mha")  # as one path on two nodes: the second rank's is not there
    if rank == 0:
        with open(own, "wb") as file:
            file.write(content)
        middle = len(content) * 3 // 4
        with open(damaged, "wb") as file:
            file.write(content[:middle] + bytes(64) + content[middle + 64:])
    controller.Barrier()
    reader = pv.TrackedSliceReader(FileName=good)
    smooth = pv.SpeckleFilter(Input=reader, KernelSize=[3, 3, 1])
    file = lacuna_test.output("RanksErrorsSlices.nhdr")
    results = pv.ScanRegion(Input=reader), pv.SweptVolume(Input=reader, OutputSpacing=[2] * 3), smooth
    for name, word in (missing, "RanksErrorsMissing"), (own, "RanksErrorsOfRank1"), (damaged, "RanksErrorsDamaged"):
        print(f"rank {rank} {word} {name}", flush=True)
        reader.FileName = good
        with raising():
            for proxy in results:
                proxy.UpdatePipeline()
            pv.SaveData(file, proxy=smooth)
        before = written(file, controller)
        reader.FileName = name
        for proxy in results:
            expect(word, proxy.UpdatePipeline)
            holds(word, proxy)
        for _ in range(2):
            expect("", lambda: pv.SaveData(file, proxy=smooth))
            assert written(file, controller) == before
        if name != damaged:
            of_new(pv.TrackedSliceReader, name, word)
    of_new(pv.CTSeriesReader, good, "RanksErrorsGood")
    of_new(pv.TrackedSliceReader, "", "FileName is not set")


def of_new(reader, name, word):
    """The same of readers that have not read anything before, by themselves and behind ParaView's filters, which ask for pieces."""
    from paraview import simple as pv
    expect(word, lambda: reader(FileName=name).UpdatePipeline())
    for behind in pv.Contour, pv.SliceRayCaster:
        made = reader(FileName=name)
        expect(word, lambda made=made, behind=behind: behind(Input=made).UpdatePipeline())
        behind(Input=made).UpdatePipeline()
        holds(word, made)


def of_first_rank():
    """Wrong where the first rank alone works, or is asked for something: said by all, whose outputs are empty. What is mended works again,
    and so does a writer behind it that gathers from all ranks."""
    from lacuna.errors import raising
    from paraview import simple as pv
    wavelet, pieces = pv.Wavelet(WholeExtent=[0, 9, 0, 9, 0, 9]), pv.Sphere(ThetaResolution=12)
    depth = pv.BSplineIsoRayCaster(Input=pv.SkullPhantom(Spacing=[2] * 3), IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9], PixelSpacing=2)
    filled = pv.RBFHoleFiller(Input=depth, Smoothing=5, OutputMargin=30)
    angle = pv.OccludedAngle(Input=wavelet, NumberOfDirections=6)
    values = pv.Calculator(Input=pieces, ResultArrayName="Value", Function="coordsX")
    grid = pv.RBFInterpolator(Input=values, ScalarArray="Value", Kernel="Linear", OutputSpacing=[0.1] * 3)
    of_grid = pv.ContrastToSpeckle(Input=grid, InsideBounds=[-0.3, 0.3] * 3)
    # the second rank makes no part of what these give to a serial filter
    smooth = pv.SpeckleFilter(Input=wavelet, KernelSize=[3, 3, 1])
    of_smooth = pv.ContrastToSpeckle(Input=smooth, InsideBounds=[0, 4] * 3)
    gated = pv.GateSlices(Input=pv.PhantomSweep(NumberOfSlices=40, ImageSize=[64, 48]), SpeedLimit=1000)
    of_gated = pv.ScanRegion(Input=gated)
    for proxy, cause, name, bad, good, word in (
            (pv.ImplantPlate(Input=filled), None, "Input", depth, filled, "'Fitted'"),
            (pv.ImplantPlate(Input=filled), depth, "IsoValues", [], [500], "iso"),
            (pv.DefectModel(Input=filled), None, "Input", depth, filled, "'Fitted'"),
            (pv.PressOrientation(Input=filled), None, "PlateMargin", 300.0, 10.0, "beyond the defect"),
            (pv.OcclusionSurface(Input=angle, Data=wavelet), None, "Data", pv.Wavelet(WholeExtent=[0, 3] * 3), wavelet, "other voxels"),
            (pv.ContrastToSpeckle(Input=wavelet), None, "InsideBounds", [90, 91] * 3, [0, 4] * 3, "no sample is inside"),
            (of_grid, grid, "ScalarArray", "No", "Value", "'No'"),
            (of_smooth, smooth, "ScalarArray", "No", "RTData", "'No'"),
            (of_smooth, smooth, "KernelSize", [0, 3, 1], [3, 3, 1], "KernelSize is 0 voxels"),
            (of_gated, gated, "SpeedLimit", 0, 1000, "nothing to gate by")):
        print(proxy.GetXMLLabel(), flush=True)
        file = lacuna_test.output("RanksErrors.csv")
        for _ in range(2):
            setattr(cause or proxy, name, bad)
            expect(word, proxy.UpdatePipeline)
            holds(word, proxy)
            setattr(cause or proxy, name, good)
            with raising():
                pv.SaveData(file, proxy=proxy)


def at_other_times():
    """Of data without times VTK makes nothing anew when another time is asked for: then one rank alone is asked for another part, and waits
    for nobody."""
    from lacuna.errors import raising
    from paraview import simple as pv
    depth = pv.BSplineIsoRayCaster(Input=pv.SkullPhantom(Spacing=[4] * 3, DefectRadius=25, DefectDirection=[0.5, -0.2, 0.8]), IsoValues=[500],
                                   PixelSpacing=4, ViewDirection=[-0.5, 0.2, -0.8])
    filled = pv.RBFHoleFiller(Input=depth, Smoothing=5, OutputMargin=30)
    with raising():
        for time, filter in enumerate((pv.ImplantPlate, pv.PressOrientation, pv.DepthMapSurface, pv.DefectModel, pv.DepthMapSurface, pv.ImplantPlate)):
            made = filter(Input=filled)
            made.UpdatePipeline(float(time))
            pv.SaveData(lacuna_test.output("RanksErrors.csv"), proxy=made)
    outside = pv.ContrastToSpeckle(Input=pv.Wavelet(WholeExtent=[0, 9] * 3), InsideBounds=[90, 91] * 3)
    expect("no sample is inside", lambda: outside.UpdatePipeline(0.0))
    for ask in lambda: outside.UpdatePipeline(1.0), lambda: pv.SaveData(lacuna_test.output("RanksErrors.csv"), proxy=outside):
        ask()
        holds("no sample is inside", outside)


def by_default(rank):
    """After lacuna.load() calls raise by themselves: an error of one rank, and what is held, on both; and when it is mended on both, nothing."""
    import lacuna
    from lacuna.errors import PipelineError, raise_errors
    from paraview import servermanager
    from paraview import simple as pv
    lacuna.load()
    sweep = lacuna.PhantomSweep(NumberOfSlices=1, ImageSize=[64, 48])
    volume = lacuna.SweptVolume(Input=sweep, OutputSpacing=[2] * 3)
    alone = pv.ProgrammableSource(Script="" if rank == 0 else "from vtkmodules.vtkCommonCore import vtkOutputWindow\n"
                                  "vtkOutputWindow.GetInstance().DisplayErrorText('of one rank')")
    for word, ask in (("slices are too few", volume.UpdatePipeline), ("slices are too few", volume.UpdatePipeline),
                      ("slices are too few", lambda: servermanager.Fetch(volume)), ("of one rank", alone.UpdatePipeline)):
        try:
            ask()
        except PipelineError as error:
            assert word in str(error), (word, str(error))
            continue
        raise AssertionError(f"nothing is said of {word!r}")
    sweep.NumberOfSlices = 12
    volume.UpdatePipeline()
    assert volume.GetDataInformation().GetNumberOfPoints() > 100
    raise_errors(False)


def stopped(make, rank):
    """Stopped on one rank, at some moment."""
    source = wavelet(48)
    for moment in (0.0, 0.1, 0.16, 0.2, 0.32, 0.45, 0.6, 0.8, 0.95):
        filter = make(source, False)

        stops = [rank == 1]

        def stop(caller, _, moment=moment, stops=stops):
            if stops[0] and caller.GetProgress() >= moment:
                caller.AbortExecuteOn()
        filter.AddObserver("ProgressEvent", stop)
        update(filter)
        stops[0] = False
        filter.AbortExecuteOff()
        update(filter, (0, 47, 0, 47, 3, 9))  # of what all ranks know to have failed
        filter.Modified()
        text = update(filter)
        assert not text and filter.GetOutput().GetNumberOfPoints() == 48 ** 3, text


def afterwards(make, rank):
    """Stopped on both ranks, then made: another part of the result is there for one of them alone."""
    source = wavelet(24)
    filter = make(source, False)
    stop = [True]
    filter.AddObserver("ProgressEvent", lambda caller, _: stop[0] and caller.AbortExecuteOn())
    parts = (0, 23, 0, 23, 0, 12), (0, 23, 0, 23, 12, 23)
    update(filter, parts[rank])
    stop[0] = False
    filter.AbortExecuteOff()
    filter.Modified()
    text = update(filter, parts[rank])
    assert not text, text
    if rank == 0:
        text = update(filter, parts[1])
        assert not text, text
        assert filter.GetOutput().GetNumberOfPoints() > 0
        for first in (3, 8):  # a stop of what one rank does alone is nothing to the others
            stop[0] = True
            update(filter, (0, 23, 0, 23, first, first + 1))
            stop[0] = False
            filter.AbortExecuteOff()
            text = update(filter, (0, 23, 0, 23, first, first + 2))
            assert not text, text
            assert filter.GetOutput().GetNumberOfPoints() > 0


def run():
    from vtkmodules.vtkParallelCore import vtkMultiProcessController
    controller = vtkMultiProcessController.GetGlobalController()
    assert controller.GetNumberOfProcesses() == 2
    rank = controller.GetLocalProcessId()
    for make in (occluded_angle, mirror, warp):
        for what in (refused, unsound, absent, partial, again, stopped, afterwards):
            signal.alarm(SECONDS)  # ends a rank that waits for ever
            print(f"rank {rank}: {make.__name__} {what.__name__}", flush=True)
            what(make, rank)
            controller.Barrier()
    signal.alarm(SECONDS)
    unpaired(rank)
    distributed(rank)
    transparent(rank)
    signal.alarm(SECONDS)
    saved(controller)
    signal.alarm(SECONDS)
    of_files(rank, controller)
    signal.alarm(SECONDS)
    of_first_rank()
    signal.alarm(SECONDS)
    at_other_times()
    signal.alarm(SECONDS)
    by_default(rank)
    signal.alarm(0)


lacuna_test.on_two_ranks(__file__, run)
