# SPDX-License-Identifier: BSD-3-Clause
"""Data of ParaView's proxies.

    from lacuna.data import fetch
    top = fetch(OutputPort(model, 1))
"""


def fetch(source):
    """The data of a proxy, of its second output for OutputPort(proxy, 1): servermanager.Fetch gives that of the first."""
    from paraview import servermanager
    return servermanager.Fetch(source, idx=source.Port)
