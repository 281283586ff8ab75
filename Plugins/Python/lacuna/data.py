# SPDX-License-Identifier: BSD-3-Clause
"""Data of ParaView's proxies, and volumes in files.

    from lacuna.data import fetch, open_volume
    volume = open_volume("head.vti")   # an error if ParaView would drop its direction
    top = fetch(OutputPort(model, 1))
"""
import os


def fetch(source):
    """The data of a proxy, of its second output for OutputPort(proxy, 1): servermanager.Fetch gives that of the first."""
    from paraview import servermanager
    return servermanager.Fetch(source, idx=source.Port)


def open_volume(path):
    """The reader (a ParaView proxy) of a volume: of a folder with a DICOM series, or of a file that ParaView reads.

    Raises ValueError for MetaImages whose orientation ParaView's reader would drop, and for what is no volume.
    """
    import lacuna.plugin
    import paraview.simple as pv
    lacuna.plugin.load()
    if os.path.isdir(path):
        reader = pv.CTSeriesReader(FileName=path)
    else:
        refuse_orientation(path)
        reader = pv.OpenDataFile(path)
    if reader is None:
        raise ValueError(f"ParaView has no reader for {path}")
    reader.UpdatePipeline()
    kind = reader.GetDataInformation().GetDataSetTypeAsString()
    if kind != "vtkImageData":
        raise ValueError(f"{path} is not a regular volume but {kind}")
    return reader


def refuse_orientation(name):
    """Raises ValueError for an oriented MetaImage: ParaView's reader drops TransformMatrix, and a patient could come out
    turned or mirrored. Files of other formats pass.
    """
    if not name.lower().endswith((".mha", ".mhd")):
        return
    with open(name, "rb") as file:
        head = file.read(10000)
    for line in head.split(b"\n"):
        key, _, value = line.partition(b"=")
        if key.strip() in (b"TransformMatrix", b"Rotation", b"Orientation"):
            if [float(x) for x in value.split()] != [1, 0, 0, 0, 1, 0, 0, 0, 1]:
                raise ValueError(
                    f"{name} is oriented ({key.strip().decode()} = {value.strip().decode()}), which ParaView's "
                    "reader ignores: the result could be turned or mirrored. Keep oriented images in .vti")
        if key.strip() == b"ElementDataFile":
            return
