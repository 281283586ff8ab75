# SPDX-License-Identifier: BSD-3-Clause
"""Every proxy in a pipeline: state files and Python traces bring back the same pipeline, which makes the same data.

StatesAndTraces.py [program that makes a CT series]

Each pipeline is built while ParaView traces it, saved as .pvsm by ParaView and by lacuna.states, and as .py. Each of the
four is loaded into an empty session, and every output, and every file that was written, is compared bit for bit.
"""
import os
import sys

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
import pipelines
from every_proxy import PIPELINES, WRITERS, every_kind, make_files, path, written
from lacuna import states
from lacuna.errors import raising
from paraview import servermanager, smstate, smtrace
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy


# (kind, port) of images that cannot be turned: stacks, whose poses tell where the slices are, the map of errors over such an image, and
# what is made along the axes. Every other image is turned in one of the pipelines.
ALONG_AXES = {*((f"Lacuna{kind}", 0) for kind in ("AssembleTrackedSlices", "BoneEcho", "GateSlices", "PhantomSweep", "PolhemusVideoSource",
                                                   "ProbeCalibration", "TrackedSliceReader")),
              ("LacunaPolhemusVideoSource", 1), ("LacunaProbeCalibration", 3), ("LacunaRBFSurface", 1),
              *((f"Lacuna{kind}", 0) for kind in ("IncompleteShape", "RBFInterpolator", "SkullPhantom"))}


def remember_definitions():
    """ParaView's Python goes through all definitions for each proxy that it meets, which takes most of this test's time."""
    search, found = servermanager.ProxyNamespace._findProxy, {}

    def find(self, name=None, xmlname=None):
        key = frozenset(self.xmlGroups), name, xmlname
        if key not in found:
            definition = search(self, name, xmlname)
            if definition is None:
                return None
            found[key] = definition
        return found[key]

    servermanager.ProxyNamespace._findProxy = find


def properties():
    """What the panel shows of each source: (source, property) and its values, of sub-proxies also."""
    found = {}

    def collect(name, proxy):
        for prop in proxy.ListProperties():
            value = proxy.GetProperty(prop)
            command = not hasattr(type(value), "GetData")
            if command or value.SMProperty.GetInformationOnly() or value.SMProperty.IsA("vtkSMInputProperty"):
                continue
            data = value.GetData()
            if isinstance(data, servermanager.Proxy):
                found[name, prop] = data.GetXMLName()
                collect(f"{name}.{prop}", data)
            elif not (hasattr(data, "__len__") and any(isinstance(each, servermanager.Proxy) for each in data)):
                found[name, prop] = list(data) if hasattr(data, "__len__") and not isinstance(data, str) else data

    for (name, _), source in GetSources().items():
        if source.GetXMLName().startswith("Lacuna"):
            collect(name, source)
    return found


def run(text, name):
    """A Python script as ParaView's File > Load State and Macros do."""
    exec(compile(text, name, "exec"), {"__name__": "__main__"})


def check_directions(name, made):
    """Every image that is turned says so twice, so that a filter which resets its direction is noticed; no other data do."""
    kinds = {registered: source.GetXMLName() for (registered, _), source in GetSources().items()}
    for key, data in made.items():
        record = data.GetFieldData().GetArray("DirectionMatrix")
        if not data.IsA("vtkImageData"):
            assert record is None, (name, key, "is no image")
            continue
        direction = np.array(data.GetDirectionMatrix().GetData())
        is_turned = not np.array_equal(direction, np.eye(3).ravel())
        images.setdefault((kinds[key[0]], key[1]), set()).add(is_turned)
        assert record is not None or not is_turned, (name, key, "has no record")
        assert record is None or np.array_equal(vtk_to_numpy(record)[0], direction), (name, key)


def check(pipeline):
    name = pipeline.__name__
    for each in written():
        os.remove(path(each))
    with raising():
        smtrace.start_trace()
        pipeline()
        trace = smtrace.stop_trace()
        made, panel, saved = pipelines.outputs(), properties(), written()
    check_directions(name, made)
    kinds = {source.GetXMLName() for source in GetSources().values()}
    state = path(name + ".pvsm")
    SaveState(state)
    python = smstate.get_state()
    states.save(path(name + "-small.pvsm"))
    for suffix, text in (("-trace.py", trace), ("-state.py", python)):
        with open(path(name + suffix), "w", encoding="utf-8") as file:
            file.write(text)
    ways = {"state file": lambda: LoadState(state), "small state file": lambda: states.load(path(name + "-small.pvsm")),
            "Python state": lambda: run(python, name + "-state.py"), "trace": lambda: run(trace, name + "-trace.py")}
    for what, load in ways.items():
        ResetSession()
        for each in written():
            os.remove(path(each))
        with raising():
            load()
            pipelines.check_same(made, pipelines.outputs(), f"{name}, {what}")
        again = properties()
        assert again == panel, (name, what, {key: (panel.get(key), again.get(key)) for key in set(panel) | set(again) if panel.get(key) != again.get(key)})
        if what == "trace":
            assert written() == saved, f"{name}: the trace writes other files than {sorted(saved)}"
    print(f"{name}: {len(made)} outputs of {len(kinds)} kinds, {len(saved)} files; all four ways bring the same", flush=True)
    ResetSession()
    return kinds | {kind for ending, kind in WRITERS.items() if f"written.{ending}" in saved}


images = {}  # (kind, port) of those that were made: whether one was turned, and one was not
remember_definitions()
make_files("StatesAndTraces", *sys.argv[1:])
seen = set()
for pipeline in PIPELINES:
    seen |= check(pipeline)
along_axes = {key for key, found in images.items() if key[0].startswith("Lacuna") and True not in found}
assert along_axes == ALONG_AXES, ("never turned here:", along_axes - ALONG_AXES, "turned though it is along the axes:", ALONG_AXES - along_axes)
missing = every_kind() - seen
assert missing <= ({"LacunaCTSeriesReader"} if len(sys.argv) < 2 else set()), f"no pipeline here has {sorted(missing)}"
