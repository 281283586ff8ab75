# SPDX-License-Identifier: BSD-3-Clause
"""What ParaView's window knows of the packages' plugins: paraview --script=in_window.py

Loads both as Tools > Manage Plugins does, and writes in_window.txt into the current folder.
"""
import os
import traceback

from paraview.modules.vtkRemotingCore import vtkPVPluginTracker
from paraview.simple import *

result = "works"
try:
    tracker = vtkPVPluginTracker.GetInstance()
    offered = {tracker.GetPluginName(i): i for i in range(tracker.GetNumberOfPlugins())}
    for name in ("LacunaPlugin", "LacunaPanels"):
        assert not tracker.GetPluginLoaded(offered[name])
        LoadPlugin(tracker.GetPluginFileName(offered[name]), remote=False, ns=globals())
        assert tracker.GetPluginLoaded(offered[name])
    Show(SkullPhantom())
    Render()
except BaseException:
    result = traceback.format_exc()
with open("in_window.txt", "w", encoding="utf-8") as file:
    file.write(result)
os._exit(0)
