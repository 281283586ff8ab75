# SPDX-License-Identifier: BSD-3-Clause
"""Under MPI filters that work by parts ask for their part and its neighbours, and no more of what lies upstream is made; and what a serial filter
has asked for does not stay.

Run without arguments it is the test; it runs itself in pvbatch on two ranks.
"""
import lacuna_test

TABLE = """
import numpy as np
for i, value in enumerate(np.eye(4).ravel()):
    output.RowData.append(np.full(40, value), f"m{i}")
"""


def filters():
    """Each with inputs of its own, of which nobody else asks for more."""
    from paraview import simple as pv

    def sweep():
        return pv.PhantomSweep(NumberOfSlices=40, ImageSize=[32, 24])

    def depth_map():
        return pv.BSplineIsoRayCaster(Input=pv.SkullPhantom(Spacing=[4] * 3), IsoValues=[500], ImageSize=[60, 90])
    poses = pv.ProgrammableSource(OutputDataSetType="vtkTable", Script=TABLE)
    yield pv.SpeckleFilter(Input=sweep(), KernelSize=[3, 3, 3])
    yield pv.GateSlices(Input=sweep(), SpeedLimit=1000)
    yield pv.AssembleTrackedSlices(Input=pv.Wavelet(WholeExtent=[0, 31, 0, 23, 0, 39]), Poses=poses, PoseFormat="Matrix", PoseColumns=["m"],
                                   PixelSpacing=0.4, RowOrder="TopRowFirst")
    yield pv.SlicePlanes(Input=sweep())
    yield pv.DepthMapShader(Input=depth_map())
    yield pv.DepthMapSurface(Input=depth_map())


def check_half(label, data, info):
    """What this rank has of an image is its half, with what is on the border."""
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    whole = info.Get(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT())
    share = data.GetNumberOfPoints()
    for axis in range(3):
        share /= whole[2 * axis + 1] - whole[2 * axis] + 1
    print(label, share, flush=True)
    assert 0.45 < share < 0.6, (label, whole, data.GetExtent())


def after_serial():
    """A serial filter asks for all on each rank: who comes then has parts of both ranks again."""
    from lacuna.errors import raising
    from paraview import simple as pv
    from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter
    from vtkmodules.vtkParallelCore import vtkMultiProcessController
    files = [lacuna_test.output(f"PartsRanks{time}.vti") for time in range(3)]
    controller = vtkMultiProcessController.GetGlobalController()
    if controller.GetLocalProcessId() == 0:
        for time, file in enumerate(files):
            source, writer = vtkRTAnalyticSource(), vtkXMLImageDataWriter()
            source.SetWholeExtent(0, 9, 0, 39, 0, 9)
            source.SetXMag(1 + time)
            writer.SetInputConnection(source.GetOutputPort())
            writer.SetFileName(file)
            writer.SetDataModeToBinary()
            writer.Write()
    controller.Barrier()
    smooth = pv.SpeckleFilter(Input=pv.XMLImageDataReader(FileName=files), KernelSize=[3, 3, 1])
    contrast = pv.ContrastToSpeckle(Input=smooth, InsideBounds=[0, 5] * 3)
    algorithm = smooth.GetClientSideObject()
    with raising():
        for time in (1.0, 0.0, 2.0, 2.0):
            contrast.UpdatePipeline(time)
            smooth.UpdatePipeline(time)
            check_half(f"after Contrast To Speckle at {time}", algorithm.GetOutputDataObject(0), algorithm.GetOutputInformation(0))


def run():
    from lacuna import plugin
    from lacuna.errors import raising
    plugin.load()
    for proxy in filters():
        with raising():
            proxy.UpdatePipeline()
        algorithm = proxy.GetClientSideObject()
        check_half(proxy.GetXMLLabel(), algorithm.GetInputDataObject(0, 0), algorithm.GetInputInformation(0, 0))
    after_serial()


lacuna_test.on_two_ranks(__file__, run)
