# SPDX-License-Identifier: BSD-3-Clause
"""Data of several blocks, which scripts can give a filter though ParaView's menu does not: those whose output has the geometry of
one input refuse them, and work with one of the blocks.
"""
import lacuna.plugin

lacuna.plugin.load()
from lacuna.errors import PipelineError, raising
from paraview.simple import *


def wavelet(n):
    return Wavelet(WholeExtent=[-n, n] * 3)


def sweep(slices):
    return PhantomSweep(NumberOfSlices=slices, ImageSize=[64, 48])


def depth(pixel):
    return BSplineIsoRayCaster(Input=SkullPhantom(Spacing=[4, 4, 4]), IsoValues=[500], PixelSpacing=pixel, ViewDirection=[-0.4, 0.2, -0.9])


def fill(maps):
    filler = RBFHoleFiller(Input=maps, DefectRegion="Sphere")
    filler.DefectRegion.Center = [28, -14, 63]
    filler.DefectRegion.Radius = 39
    return filler


CASES = (
    (wavelet(4), wavelet(5), (
        lambda volumes: SpeckleFilter(Input=volumes),
        lambda volumes: Mirror(Input=volumes, PlaneMethod="Given"),
        lambda volumes: OccludedAngle(Input=volumes, NumberOfDirections=40),
        lambda volumes: RBFImageWarp(Input=volumes, Landmarks=Sphere(Radius=3), Targets=Sphere(Radius=3.1)),
        lambda volumes: BSplineIsoRayCaster(Input=volumes, IsoValues=[150], PixelSpacing=1))),
    (sweep(10), sweep(14), (
        lambda slices: SweptVolume(Input=slices),
        lambda slices: SliceRayCaster(Input=slices),
        lambda slices: BoneEcho(Input=slices),
        lambda slices: GateSlices(Input=slices, SpeedLimit=1e6))),
    (Sphere(Radius=4), Sphere(Radius=5), (
        lambda points: RBFInterpolator(Input=points, OutputSpacing=[1, 1, 1], ScalarArray="Normals"),)),
    (depth(5), depth(6), (
        lambda maps: DepthMapShader(Input=maps),
        lambda maps: DepthMapSurface(Input=maps),
        fill)),
    (fill(depth(1.5)), fill(depth(2)), (
        lambda maps: DefectModel(Input=maps),
        lambda maps: PressOrientation(Input=maps))))

for first, second, makers in CASES:
    blocks = GroupDatasets(Input=[first, second])
    for make in makers:
        refused = make(blocks)
        try:
            with raising():
                refused.UpdatePipeline()
            raise AssertionError(f"{refused.GetXMLName()} takes blocks")
        except PipelineError as error:
            assert "input 0 has blocks, and this takes one" in str(error), error
        refused.Input = first
        with raising([]):
            refused.UpdatePipeline()
        assert refused.GetDataInformation().GetNumberOfPoints() > 0, refused.GetXMLName()
        print(refused.GetXMLName(), "refuses blocks")
