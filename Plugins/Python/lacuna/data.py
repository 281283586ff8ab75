# SPDX-License-Identifier: BSD-3-Clause
"""Data of ParaView's proxies, and volumes in files.

    from lacuna.data import fetch, open_volume
    volume = open_volume("head.mha")   # an error if ParaView would drop how it lies
    top = fetch(OutputPort(model, 1))
"""
import os


def fetch(source):
    """The data of a proxy, of its second output for OutputPort(proxy, 1): servermanager.Fetch gives that of the first."""
    from paraview import servermanager
    return servermanager.Fetch(source, idx=source.Port)


def open_volume(path):
    """The reader (a ParaView proxy) of a volume: of a folder with a DICOM series or a file of one, or of an image in a file.

    Raises ValueError for files whose orientation or unit ParaView's reader would drop, for formats of which that is not
    known (lacuna.volume_files), and for what is no volume; PipelineError with what the reader says.
    """
    import lacuna.plugin
    import paraview.simple as pv
    from lacuna import volume_files
    from lacuna.errors import raising
    lacuna.plugin.load()
    if os.path.isdir(path) or volume_files.check(path) == volume_files.DICOM:
        reader = pv.CTSeriesReader(FileName=path)
    else:
        reader = pv.OpenDataFile(path)
    if reader is None:
        raise ValueError(f"ParaView has no reader for {path}")
    with raising():
        reader.UpdatePipeline()
    kind = reader.GetDataInformation().GetDataSetTypeAsString()
    if kind != "vtkImageData" or reader.GetDataInformation().GetNumberOfPoints() == 0:
        raise ValueError(f"{path} is not a regular volume but {kind}")
    return reader
