# SPDX-License-Identifier: BSD-3-Clause
"""Data of ParaView's proxies, and volumes in files.

    from lacuna.data import fetch, open_volume
    volume = open_volume("head.mha")   # an error if ParaView would drop how it lies
    top = fetch(OutputPort(model, 1))
"""
import os


def fetch(source):
    """The data of a proxy, of its second output for OutputPort(proxy, 1): servermanager.Fetch gives that of the first.

    Images from a server have the direction that they have there, which servermanager.Fetch drops.
    """
    from paraview import servermanager
    data = servermanager.Fetch(source, idx=source.Port)
    if servermanager.ActiveConnection.IsRemote() and data is not None and data.IsA("vtkImageData") and data.GetNumberOfPoints():
        _turn(data, source, servermanager)
    return data


def _turn(image, source, servermanager):
    """Gives a fetched image the direction that it has on the server: that of the points at its corner."""
    extent = image.GetExtent()
    corner = [min(bound, extent[2 * (axis // 2)] + axis % 2) for axis, bound in enumerate(extent)]
    counts = [corner[2 * axis + 1] - corner[2 * axis] + 1 for axis in range(3)]
    few = servermanager.filters.ExtractSubset(Input=servermanager.OutputPort(source, source.Port), VOI=corner)
    points = servermanager.Fetch(servermanager.filters.ImageDatatoPointSet(Input=few))
    columns, stride = [], 1
    for axis in range(3):
        step = [b - a for a, b in zip(points.GetPoint(0), points.GetPoint(stride))] if counts[axis] > 1 else None
        columns.append(step and [value / image.GetSpacing()[axis] for value in step])
        stride *= counts[axis]
    missing = [axis for axis in range(3) if columns[axis] is None]
    if len(missing) == 1:  # the axes are right-handed
        a, b = columns[(missing[0] + 1) % 3], columns[(missing[0] + 2) % 3]
        columns[missing[0]] = [a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3] for k in range(3)]
    if len(missing) < 2:
        image.SetDirectionMatrix([columns[column][row] for row in range(3) for column in range(3)])


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
