# SPDX-License-Identifier: BSD-3-Clause
"""Under MPI filters that work by parts ask for their part and its neighbours, and no more of what lies upstream is made.

Run without arguments it is the test; it runs itself in pvbatch on two ranks.
"""
import sys

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


def run():
    from lacuna import plugin
    from lacuna.errors import raising
    plugin.load()
    for proxy in filters():
        with raising():
            proxy.UpdatePipeline()
        algorithm = proxy.GetClientSideObject()
        points = algorithm.GetInputDataObject(0, 0).GetNumberOfPoints()
        whole = algorithm.GetInputInformation(0, 0).Get(algorithm.GetExecutive().WHOLE_EXTENT())
        share = points
        for axis in range(3):
            share /= whole[2 * axis + 1] - whole[2 * axis] + 1
        print(proxy.GetXMLLabel(), share, flush=True)
        assert 0.45 < share < 0.6, (proxy.GetXMLLabel(), whole, points)
    print("rank done", flush=True)


def main():
    printed = lacuna_test.run_ranks(2, __file__, "in pvbatch", options=["--symmetric"])
    assert printed.count("rank done") == 2, printed


if sys.argv[1:2] == ["in pvbatch"]:
    run()
else:
    main()
