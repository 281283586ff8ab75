# SPDX-License-Identifier: BSD-3-Clause
"""Each optional input of each proxy can be set and taken away again."""
import os

from paraview import servermanager
from paraview.simple import LoadPlugin, TrivialProducer, Wavelet
from vtkmodules.vtkCommonDataModel import vtkTable

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def connections(proxy):
    """Of all ports of the filter behind a proxy."""
    own = proxy.GetClientSideObject()
    return sum(own.GetNumberOfInputConnections(port) for port in range(own.GetNumberOfInputPorts()))


def optional_inputs(proxy):
    """Names of the input properties that need not be set."""
    names = []
    iterator = servermanager.PropertyIterator(proxy)
    for item in iterator:
        own = item.SMProperty
        hints = own.GetHints() if own.IsA("vtkSMInputProperty") else None
        if hints is not None and hints.FindNestedElementByName("Optional") is not None:
            names.append(iterator.GetKey())
    return names


found = {}
for group in ("filters", "sources"):
    for definition in servermanager.ProxyManager().NewDefinitionIterator(group):
        name = definition["key"]
        if not name.startswith("Lacuna"):
            continue
        proxy = servermanager._getPyProxy(servermanager.CreateProxy(group, name))
        proxy.UpdateVTKObjects()
        for optional in optional_inputs(proxy):
            before = connections(proxy)
            for _ in range(2):
                other = TrivialProducer() if "Table" in optional else Wavelet()
                if "Table" in optional:
                    other.GetClientSideObject().SetOutput(vtkTable())
                setattr(proxy, optional, other)
                proxy.UpdateVTKObjects()
                assert connections(proxy) == before + 1, f"{name}.{optional} is not set"
                setattr(proxy, optional, None)
                proxy.UpdateVTKObjects()
                assert connections(proxy) == before, f"{name}.{optional} cannot be taken away"
            found.setdefault(name, set()).add(optional)
print(found, flush=True)
assert found == {
    "LacunaBSplineIsoRayCaster": {"StartDepthMap"},
    "LacunaDepthMapShader": {"Volume"},
    "LacunaGateSlices": {"GateTable"},
    "LacunaImplantPlate": {"HoleMarks"},
    "LacunaOccludedAngle": {"SpaceMask"},
    "LacunaPhantomSweep": {"Input"},
    "LacunaProbeCalibration": {"Picks"},
    "LacunaRBFHoleFiller": {"Surface", "Selection", "ControlPoints", "PriorSurface"},
    "LacunaRBFSurface": {"PriorSurface"},
    "LacunaSkullBone": {"Exclude"},
    "LacunaSkullImplant": {"DefectOutline", "Template"},
    "LacunaSkullResection": {"CutOutline", "Tumour"},
}
