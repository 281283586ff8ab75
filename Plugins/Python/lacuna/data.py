# SPDX-License-Identifier: BSD-3-Clause
"""Data of ParaView's proxies, and volumes in files.

    from lacuna.data import fetch, open_volume
    volume = open_volume("head.nii.gz")   # where it lies in the patient, or an error
    top = fetch(OutputPort(model, 1))
"""
import os

import numpy


def fetch(source):
    """The data of a proxy, of its second output for OutputPort(proxy, 1): servermanager.Fetch gives that of the first.

    Images are whole, also of several ranks, and lie as they do on a server: servermanager.Fetch gives the part of the
    first rank, drops the direction and rounds origin and spacing to six digits. Arrays are the same bit for bit, in another
    order on several ranks perhaps: find them by name. Origin, spacing and direction come from points and may differ from those
    on the server in the last digits (1e-14 of the coordinates). Field data are those of the first rank that
    has a part. Raises RuntimeError when the ranks' parts leave gaps, and PipelineError when the source has failed: its
    output, or a block of it, is then empty and holds the error.
    """
    data = _fetch(source)
    for block in blocks(data):
        error = block.GetFieldData().GetAbstractArray("LacunaError")
        if error:
            from lacuna.errors import PipelineError
            raise PipelineError(error.GetValue(0))
    return data


def blocks(data):
    """The data (vtkDataObject), and all that are in them."""
    if data is None:
        return
    yield data
    if data.IsA("vtkCompositeDataSet"):
        visitor = data.NewIterator()
        visitor.InitTraversal()
        while not visitor.IsDoneWithTraversal():
            yield visitor.GetCurrentDataObject()
            visitor.GoToNextItem()


def _fetch(source):
    """See fetch."""
    from lacuna.errors import raising, set_aside
    from paraview import servermanager
    ranks = servermanager.ActiveConnection.GetNumberOfDataPartitions()
    if ranks == 1 and not servermanager.ActiveConnection.IsRemote():
        return servermanager.Fetch(source, idx=source.Port)
    if servermanager.ActiveConnection.IsRemote():
        source.SMProxy.MarkDirty(source.SMProxy)  # asked again, what has failed says so again
        with raising():
            source.UpdatePipeline()
    # images travel in the legacy format, whose reader takes words of Provenance for its own
    with set_aside(*(f"Error reading {word}!" for word in ("dimensions", "extent", "origin", "spacing"))):
        data = servermanager.Fetch(source, idx=source.Port)
        if data is None or not data.IsA("vtkImageData"):
            return data
        parts = [servermanager.Fetch(source, rank, idx=source.Port) for rank in range(ranks)] if ranks > 1 else [data]
        parts = [part for part in parts if part is not None and part.GetNumberOfPoints()]
        if not parts:
            return data
        _place(parts[0], source, servermanager)
        return _join(parts)


def _join(parts):
    """The image of which the ranks have parts."""
    if len(parts) == 1:
        return parts[0]
    from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes
    from vtkmodules.vtkFiltersCore import vtkImageAppend
    append = vtkImageAppend()
    append.PreserveExtentsOn()
    for part in parts:
        append.AddInputData(part)
    append.Update()
    image = append.GetOutput()
    extent = image.GetExtent()
    covered = numpy.zeros([extent[2 * axis + 1] - extent[2 * axis] + 1 for axis in range(3)], bool)
    for part in parts:
        its = part.GetExtent()
        covered[tuple(slice(its[2 * axis] - extent[2 * axis], its[2 * axis + 1] - extent[2 * axis] + 1) for axis in range(3))] = True
    if not covered.all():
        raise RuntimeError(f"the parts of {len(parts)} ranks leave gaps: {[part.GetExtent() for part in parts]}")
    image.SetOrigin(parts[0].GetOrigin())
    image.SetSpacing(parts[0].GetSpacing())
    image.SetDirectionMatrix(parts[0].GetDirectionMatrix())
    image.SetFieldData(parts[0].GetFieldData())
    for kind in range(vtkDataSetAttributes.NUM_ATTRIBUTES):
        active = parts[0].GetPointData().GetAbstractAttribute(kind)
        if active is not None:
            image.GetPointData().SetActiveAttribute(active.GetName(), kind)
    return image


def _place(image, source, servermanager):
    """Gives a fetched image the place that it has on the server, where the points at its corner are: the legacy format has no direction, and
    six digits of origin and spacing."""
    extent = image.GetExtent()
    corner = [min(bound, extent[2 * (axis // 2)] + axis % 2) for axis, bound in enumerate(extent)]
    counts = [corner[2 * axis + 1] - corner[2 * axis] + 1 for axis in range(3)]
    few = servermanager.filters.ExtractSubset(Input=servermanager.OutputPort(source, source.Port), VOI=corner)
    # field data would travel, too, as text in which the reader of grids takes NaN for a word of its own
    bare = servermanager.filters.PassArrays(Input=servermanager.filters.ImageDatatoPointSet(Input=few), PointDataArrays=[],
                                            CellDataArrays=[], FieldDataArrays=[])
    points = servermanager.Fetch(bare)
    first = numpy.array(points.GetPoint(0))
    spacing, columns, stride = numpy.array(image.GetSpacing()), [None] * 3, 1
    for axis in range(3):
        if counts[axis] > 1:
            step = numpy.array(points.GetPoint(stride)) - first
            spacing[axis] = numpy.linalg.norm(step)
            columns[axis] = step / spacing[axis]
        stride *= counts[axis]
    missing = [axis for axis in range(3) if columns[axis] is None]
    if len(missing) == 1:  # the axes are right-handed
        columns[missing[0]] = numpy.cross(columns[(missing[0] + 1) % 3], columns[(missing[0] + 2) % 3])
    elif len(missing) == 2:  # a row: the others are any across it
        known = ({0, 1, 2} - set(missing)).pop()
        across = numpy.cross(columns[known], numpy.eye(3)[numpy.argmin(abs(columns[known]))])
        columns[(known + 1) % 3] = across / numpy.linalg.norm(across)
        columns[(known + 2) % 3] = numpy.cross(columns[known], columns[(known + 1) % 3])
    elif missing:
        columns = list(numpy.eye(3))
    direction = numpy.array(columns).T
    image.SetSpacing(spacing)
    image.SetDirectionMatrix(direction.ravel())
    image.SetOrigin(first - direction @ (spacing * extent[::2]))


def _is_dicom(path):
    """By the content; by the name for files that begin without the mark."""
    with open(path, "rb") as file:
        return file.read(132)[128:] == b"DICM" or path.lower().endswith((".dcm", ".dicom", ".ima"))


def open_volume(path):
    """The reader (a ParaView proxy) of a volume, updated: CT Series Reader for a folder with a DICOM series or a file of one, Volume
    Reader for .mha, .mhd, .nrrd, .nhdr, .nii and .nii.gz, ParaView's own for .vti.

    Raises ValueError for other formats, of which it is not known here that ParaView heeds how the patient lay, and for what
    is no volume; PipelineError with what the reader says.
    """
    import lacuna.plugin
    import paraview.simple as pv
    from lacuna.errors import raising
    if not os.path.exists(path):
        raise ValueError(f"{path}: there is no such file")
    lacuna.plugin.load()
    name = os.path.basename(path).lower()
    if os.path.isdir(path) or _is_dicom(path):
        reader = pv.CTSeriesReader(FileName=path)
    elif name.endswith((".mha", ".mhd", ".nrrd", ".nhdr", ".nii", ".nii.gz")):
        reader = pv.VolumeReader(FileName=path)
    elif name.endswith(".vti"):
        reader = pv.XMLImageDataReader(FileName=[path])
    else:
        raise ValueError(f"{path}: volumes are read from DICOM series, .mha, .mhd, .nrrd, .nhdr, .nii, .nii.gz and .vti. Of other formats "
                         "it is not sure that ParaView heeds how the patient lay")
    with raising():
        reader.UpdatePipeline()
    kind = reader.GetDataInformation().GetDataSetTypeAsString()
    if kind != "vtkImageData" or reader.GetDataInformation().GetNumberOfPoints() == 0:
        raise ValueError(f"{path} is not a regular volume but {kind}")
    return reader
