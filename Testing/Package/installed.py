# SPDX-License-Identifier: BSD-3-Clause
"""What a user of the Debian packages does in pvpython: sees the plugins offered, loads one, fills a hole.

pvpython --force-offscreen-rendering installed.py <version> <folder for the results>
"""
import os
import sys

from paraview.modules.vtkRemotingCore import vtkPVPluginTracker

version, folder = sys.argv[1:]
tracker = vtkPVPluginTracker.GetInstance()
offered = {tracker.GetPluginName(i): i for i in range(tracker.GetNumberOfPlugins())}
for name in ("LacunaPlugin", "LacunaPanels"):
    assert name in offered, f"ParaView does not list {name}: {sorted(offered)}"
    assert not tracker.GetPluginLoaded(offered[name]), f"{name} was loaded unasked"
    assert os.path.isfile(tracker.GetPluginFileName(offered[name]))

import lacuna
import lacuna.plugin
from paraview import servermanager

assert lacuna.__version__ == version, lacuna.__version__
for name in ("__init__.pyi", "proxies.xml"):  # for editors and lacuna.help
    assert os.path.getsize(os.path.join(os.path.dirname(lacuna.__file__), name)) > 10000, name
assert os.path.samefile(lacuna.plugin.path(), tracker.GetPluginFileName(offered["LacunaPlugin"]))
lacuna.plugin.load()
from paraview.simple import *

assert tracker.GetPluginLoaded(offered["LacunaPlugin"])
information = servermanager.vtkSMProxyManager.GetProxyManager().GetPluginManager().GetLocalInformation()
versions = {information.GetPluginName(i): information.GetPluginVersion(i) for i in range(information.GetNumberOfPlugins())}
assert versions["LacunaPlugin"] in (version, ""), versions  # ParaView 6.1 knows none of plugins in its folder for others
skull = SkullPhantom()
depth = BSplineIsoRayCaster(Input=skull, IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9])
filled = RBFHoleFiller(Input=depth, SupportMargin=12)
filled.DefectRegion = "Sphere"
filled.DefectRegion.Center = [28, -14, 63]
filled.DefectRegion.Radius = 39
iges = os.path.join(folder, "implant.igs")
SaveData(iges, proxy=filled)
assert os.path.getsize(iges) > 10000
print("installed: pvpython works")
