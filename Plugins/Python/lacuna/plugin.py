# SPDX-License-Identifier: BSD-3-Clause
"""Finds and loads the ParaView plugin that belongs to this package."""
import os


def path():
    """File name of the plugin: LACUNA_PLUGIN, or the one beside this package."""
    from . import _plugin_path
    here = os.path.dirname(os.path.abspath(__file__))
    name = os.environ.get("LACUNA_PLUGIN") or os.path.normpath(os.path.join(here, _plugin_path))
    if not os.path.exists(name):
        raise FileNotFoundError(f"the Lacuna plugin is not at {name}; set LACUNA_PLUGIN to its file name")
    return name


def load():
    """Loads the plugin into the current ParaView session, unless ParaView has done so when it started.

    Call it before `from paraview.simple import *`: then SweptVolume() and the others are there. Connected to a
    server, the plugin is loaded there as well, from the same place, unless the server has loaded its own.
    """
    import paraview.simple
    from paraview import servermanager
    remote = servermanager.ActiveConnection is not None and servermanager.ActiveConnection.IsRemote()
    known = hasattr(paraview.simple, "SweptVolume")  # to the server, when there is one
    if remote or not known:
        paraview.simple.LoadPlugin(path(), remote=False, ns=vars(paraview.simple))
    if remote and not known:  # ParaView fails to load what is loaded there
        paraview.simple.LoadPlugin(path(), remote=True, ns=vars(paraview.simple))
