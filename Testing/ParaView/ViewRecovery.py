# SPDX-License-Identifier: BSD-3-Clause
"""After an error a view shows nothing of the old result, and the next good value appears: every proxy, in a view.

ViewRecovery.py [program that makes a CT series]

Each proxy is shown beside what follows it. One of its properties gets a value that is an error, then the good one again; then
the same with an input of blocks, or that value once more. What is shown must be empty in between, and the same picture as before
at the end: twice, since ParaView once stopped updating a view after the first error. Nothing is updated but by rendering.
"""
import sys

import lacuna.plugin

lacuna.plugin.load()
import numpy as np
import paraview.simple as pv
from every_proxy import PIPELINES, every_kind, make_files
from lacuna.errors import PipelineError, raising
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter

BAD = {  # a property of each proxy, and a value that is an error
    "LacunaAssembleTrackedSlices": ("PixelSpacing", -1),
    "LacunaBSplineIsoRayCaster": ("ViewUp", [0, 0, 0]),
    "LacunaBoneEcho": ("Thickness", -1),
    "LacunaCTSeriesReader": ("FileName", "none"),
    "LacunaContrastToSpeckle": ("InsideBounds", [1, 2, 1, 2, 1e9, 2e9]),
    "LacunaDefectModel": ("Margin", -1),
    "LacunaDepthMapShader": ("DepthArray", "none"),
    "LacunaDepthMapSurface": ("MaximumAngle", -1),
    "LacunaGateSlices": ("SpeedLimit", -1),
    "LacunaImplantPlate": ("Thickness", -1),
    "LacunaIncompleteShape": ("PresentFraction", 2),
    "LacunaMillingToolPath": ("ToolRadius", -1),
    "LacunaMirror": ("Normal", [0, 0, 0]),
    "LacunaOccludedAngle": ("NumberOfDirections", 0),
    "LacunaOcclusionSurface": ("Smoothing", -1),
    "LacunaOutlinedStructures": ("Smoothing", -1),
    "LacunaOutlineReader": ("FileName", "none"),
    "LacunaPhantomSweep": ("NumberOfSlices", 0),
    "LacunaPressOrientation": ("FlangeWidth", -1),
    "LacunaProbeCalibration": ("PixelSpacing", -1),
    "LacunaRBFHoleFiller": ("SupportMargin", -1),
    "LacunaRBFImageWarp": ("Smoothing", -1),
    "LacunaRBFInterpolator": ("Smoothing", -1),
    "LacunaRBFSurface": ("Smoothing", -1),
    "LacunaScanRegion": ("TickLength", -1),
    "LacunaSkullBone": ("Level", 1e6),
    "LacunaSkullImplant": ("EdgeClearance", -1),
    "LacunaSkullResection": ("Bevel", -1),
    "LacunaSkullPhantom": ("Spacing", [-1, 1, 1]),
    "LacunaSliceOutliner": ("Slice", -1),
    "LacunaSlicePlanes": ("Stride", 0),
    "LacunaSliceRayCaster": ("ViewUp", [0, 0, 0]),
    "LacunaSpeckleFilter": ("KernelSize", [0, 3, 1]),
    "LacunaSweptVolume": ("OutputSpacing", [-1, 1, 1]),
    "LacunaTemporalCalibration": ("MaximumLag", -1),
    "LacunaTrackedSliceReader": ("FileName", "none"),
    "LacunaVolumeReader": ("FileName", "none"),
    "LacunaTrackerSelfTest": ("SpeedLimit", -1),
}
# VTK executes them for each block
TAKE_BLOCKS = {"LacunaContrastToSpeckle", "LacunaImplantPlate", "LacunaMillingToolPath", "LacunaOcclusionSurface", "LacunaOutlinedStructures", "LacunaScanRegion",
               "LacunaSkullImplant", "LacunaSlicePlanes", "LacunaTemporalCalibration", "LacunaTrackerSelfTest"}
NOT_SHOWN = "LacunaPolhemusVideoSource", "LacunaIGESWriter", "LacunaTrackedSliceWriter", "LacunaGCodeWriter", "LacunaSTEPWriter"


def kind(proxy):
    return proxy.GetXMLName()


def elements(proxy):
    """What the Information panel tells: points and rows of all outputs."""
    total = 0
    for port in range(proxy.SMProxy.GetNumberOfOutputPorts()):
        information = servermanager.OutputPort(proxy, port).GetDataInformation()
        total += information.GetNumberOfPoints() + information.GetNumberOfRows()
    return total


def picture(view):
    """The colours of a rendered view."""
    taken = vtkWindowToImageFilter()
    taken.SetInput(view.GetRenderWindow())
    taken.ReadFrontBufferOff()
    taken.ShouldRerenderOff()
    taken.Update()
    return vtk_to_numpy(taken.GetOutput().GetPointData().GetScalars()).copy()


def connected(proxy, name="Input"):  # not inputs, a name that programmable sources remove
    """The outputs that an input property holds."""
    prop = proxy.SMProxy.GetProperty(name)
    return [servermanager.OutputPort(servermanager._getPyProxy(prop.GetProxy(i)), prop.GetOutputPortForConnection(i))
            for i in range(prop.GetNumberOfProxies())] if prop and prop.IsA("vtkSMInputProperty") else []


def followers(proxy, among):
    """Those that are made of it, and of these: what passes an error on once passes it on further."""
    found, new = [], [proxy]
    for _ in range(2):
        makers, new = {each.SMProxy.GetGlobalIDAsString() for each in new}, []
        for source in among:
            of = {each.SMProxy.GetGlobalIDAsString() for name in source.ListProperties() for each in connected(source, name)}
            if makers & of and source not in found:
                new.append(source)
        found += new
    return found


class Views:
    """A render view and a spreadsheet, in which each output is drawn once and shown by turns: to make them takes longer than all else here.
    Each pipeline has its own: a view of ParaView 6.1 keeps a texture for each hidden surface, until there are no more and nothing is drawn."""

    def __init__(self):
        self.drawing, self.sheet = pv.CreateView("RenderView"), pv.CreateView("SpreadSheetView")
        self.drawing.ViewSize = [200, 160]
        self.drawing.OrientationAxesVisibility = 0
        self.displays = {}
        self.empty = self.draw()
        self.comes_back_after_blocks = self.try_blocks()

    def try_blocks(self):
        """Whether ParaView draws a filter of its own again when its input had blocks in between; 5.13 and 6.1 draw nothing."""
        ball = pv.Sphere()
        shrunk = pv.Shrink(Input=ball)
        pv.Show(shrunk, self.drawing)
        pv.ResetCamera(self.drawing)
        before = self.draw()
        shrunk.Input = pv.GroupDatasets(Input=[ball])
        self.draw()
        shrunk.Input = ball
        after = self.draw()
        pv.Hide(shrunk, self.drawing)
        return np.array_equal(after, before)

    def show(self, proxies):
        """All outputs of these and of no others."""
        for display in self.displays.values():
            if display.Visibility:
                display.Visibility = 0
        for proxy in proxies:
            for port in range(proxy.SMProxy.GetNumberOfOutputPorts()):
                output = servermanager.OutputPort(proxy, port)
                key = proxy.SMProxy.GetGlobalIDAsString(), port
                if key not in self.displays:
                    information = output.GetDataInformation()
                    self.displays[key] = pv.Show(output, self.sheet if information.DataSetTypeIsA("vtkTable") else self.drawing)
                    if information.DataSetTypeIsA("vtkImageData"):
                        self.displays[key].SetRepresentationType("Surface")  # an outline shows the grid that was announced, not data
                self.displays[key].Visibility = 1
        pv.ResetCamera(self.drawing)

    def close(self):
        for each in (self.drawing, self.sheet):
            pv.Delete(each)

    def draw(self):
        for each in (self.drawing, self.sheet):
            pv.Render(each)
        return picture(self.drawing)


def bad_values(proxy):
    """(property, its value, a value that is an error): of the properties, then blocks as the input, or the same again."""
    name, bad = BAD[kind(proxy)]
    good = getattr(proxy, name)
    good = good.GetData() if hasattr(good, "GetData") else good
    good = list(good) if hasattr(good, "__len__") and not isinstance(good, str) else good
    yield name, good, bad
    if connected(proxy) and kind(proxy) not in TAKE_BLOCKS:
        good = connected(proxy)
        yield "Input", good if len(good) > 1 else good[0], pv.GroupDatasets(registrationName="Blocks", Input=good[:1])
    else:
        yield name, good, bad


def check(proxy, among, views):
    for name, good, bad in bad_values(proxy):
        shown = [proxy, *followers(proxy, among)]
        if name == "Input":  # one of these does; VTK itself refuses blocks among several inputs of a port, before the filter learns of them
            shown = [proxy, *(each for each in shown[1:] if len(connected(each)) == 1)][:2]
        views.show(shown)
        before, sizes = views.draw(), [elements(each) for each in shown]
        setattr(proxy, name, bad)
        try:
            with raising():
                drawn = views.draw()
            raise AssertionError(f"{kind(proxy)}.{name} = {bad} is no error")
        except PipelineError as error:
            told = str(error)
        left = {kind(each): elements(each) for each in shown if elements(each)}
        assert not left, f"{kind(proxy)}: after an error ({told}) there is still data: {left}"
        assert np.array_equal(drawn, views.empty), f"{kind(proxy)}: after an error the view shows the old result"
        setattr(proxy, name, good)
        with raising():
            after = views.draw()
        assert [elements(each) for each in shown] == sizes, f"{kind(proxy)}: {sizes} became {[elements(each) for each in shown]}"
        is_same = np.array_equal(after, before) or name == "Input" and not views.comes_back_after_blocks
        assert is_same, f"{kind(proxy)}: after an error the view does not show the good result"
        print(f"{kind(proxy)}: {name} = {bad}: {told[:90]}", flush=True)


make_files("ViewRecovery", *sys.argv[1:2])
checked, failures = set(), []
for pipeline in PIPELINES:
    views = Views()
    earlier = set(pv.GetSources())  # they stay, hidden, for it takes seconds to delete them
    pipeline()
    firsts = {}
    for key, proxy in sorted(pv.GetSources().items(), key=lambda item: int(item[1].SMProxy.GetGlobalIDAsString())):
        if kind(proxy).startswith("Lacuna") and key not in earlier:
            firsts.setdefault(kind(proxy), proxy)
    for name, proxy in reversed(firsts.items()):  # what follows first: it is not made anew then for what it follows
        if name in BAD and name not in checked:
            checked.add(name)
            try:
                check(proxy, list(firsts.values()), views)
            except (AssertionError, PipelineError) as failure:
                print(f"{name} FAILED: {failure}", flush=True)
                failures.append(name)
    views.close()
missing = every_kind() - checked - set(NOT_SHOWN)
if len(sys.argv) < 2:
    missing -= {"LacunaCTSeriesReader"}
assert not missing, f"not shown in a view: {missing}"
assert not failures, failures
