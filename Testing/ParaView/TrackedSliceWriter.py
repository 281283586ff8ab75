# SPDX-License-Identifier: BSD-3-Clause
"""Tracked Slice Writer in ParaView: what SaveData picks; files as other programs read them.

Other programs: VTK's readers of MetaImage and NRRD for the pixels, and parsers made here from the formats' definitions, with numpy, for everything.
"""
import gzip
import os
import re
import zlib

import lacuna
import numpy as np
from lacuna_test import output
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkMetaImageReader, vtkNrrdReader

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
TYPES = {"MET_UCHAR": "<u1", "MET_SHORT": "<i2", "MET_FLOAT": "<f4", "MET_DOUBLE": "<f8",
         "uint8": "<u1", "int16": "<i2", "float": "<f4", "double": "<f8"}


def frame_fields(pairs):
    """{field: {frame: text}}"""
    fields = {}
    for key, text in pairs.items():
        match = re.fullmatch(r"Seq_Frame(\d{4,})_(.+)", key)
        if match:
            fields.setdefault(match[2], {})[int(match[1])] = text
    return fields


def parse_metaimage(path):
    with open(path, "rb") as file:
        content = file.read()
    end = re.search(rb"^ElementDataFile = (.*)\n", content, re.MULTILINE)
    pairs = dict(line.split(" = ", 1) for line in content[:end.start()].decode().splitlines())
    assert list(pairs)[:2] == ["ObjectType", "NDims"] and pairs["NDims"] == "3"
    data = content[end.end():]
    if end[1] != b"LOCAL":
        assert not data
        with open(os.path.join(os.path.dirname(path), end[1].decode()), "rb") as file:
            data = file.read()
    if pairs["CompressedData"] == "True":
        assert len(pairs["CompressedDataSize"]) == 40 and int(pairs["CompressedDataSize"]) == len(data)
        data = zlib.decompress(data)
    assert len(pairs["DimSize"]) == 40 and pairs["Kinds"] == "domain domain list"
    size = [int(n) for n in pairs["DimSize"].split()]
    pixels = np.frombuffer(data, TYPES[pairs["ElementType"]]).reshape(size[::-1])
    return pixels, frame_fields(pairs), pairs["UltrasoundImageOrientation"], "ImageStatus"


def parse_nrrd(path):
    with open(path, "rb") as file:
        content = file.read()
    header, _, data = content.partition(b"\n\n")
    lines = [line for line in header.decode().splitlines()[1:] if not line.startswith("#")]
    pairs = dict(line.split(":=", 1) for line in lines if ":=" in line.split(": ")[0])
    fields = dict(line.split(": ", 1) for line in lines if ":=" not in line.split(": ")[0])
    if "data file" in fields:
        assert not data
        with open(os.path.join(os.path.dirname(path), fields["data file"]), "rb") as file:
            data = file.read()
    if fields["encoding"] == "gzip":
        data = gzip.decompress(data)
    assert fields["endian"] == "little" and fields["dimension"] == "3"
    assert len(fields["sizes"]) == 40 and fields["kinds"] == "domain domain list"
    size = [int(n) for n in fields["sizes"].split()]
    pixels = np.frombuffer(data, TYPES[fields["type"]]).reshape(size[::-1])
    return pixels, frame_fields(pairs), pairs["ultrasound image orientation"], "Status"


def read_with_vtk(path):
    reader = vtkNrrdReader() if path.endswith(("nrrd", "nhdr")) else vtkMetaImageReader()
    assert reader.CanReadFile(path)
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[::-1])


# Defaults in the XML are those of the class.
writer = servermanager.writers.TrackedSliceWriter()
plain = lacuna.vtkLacunaTrackedSliceWriter()
assert writer.CompressionLevel == plain.GetCompressionLevel()
assert not writer.FileName and not plain.GetFileName()

# SaveData takes this writer for tracked slices and leaves other images to ParaView's writers.
sweep = PhantomSweep(NumberOfSlices=7, ImageSize=[40, 30])
sweep.UpdatePipeline()
factory = servermanager.vtkSMProxyManager.GetProxyManager().GetWriterFactory()
factory.UpdateAvailableWriters()


def pick(source, extension):
    writer = factory.CreateWriter(output("picked." + extension), source.SMProxy, 0)
    return writer and writer.GetXMLName()


wavelet = Wavelet()
wavelet.UpdatePipeline()
volume = SweptVolume(Input=sweep, OutputSpacing=[1, 1, 1])
volume.UpdatePipeline()
for extension in ("igs.mha", "mha", "mhd", "nrrd", "igs.nhdr", "MHA", "IGS.MHA", "MHD", "NRRD", "NHDR"):
    assert pick(sweep, extension) == "LacunaTrackedSliceWriter", extension
assert pick(sweep, "vti") == "XMLImageDataWriter"
assert pick(wavelet, "mhd") == pick(volume, "mhd") == "MetaImageWriter"

# Everything in the files is what the pipeline has, in whatever program.
stack = servermanager.Fetch(sweep)
pixels = vtk_to_numpy(stack.GetPointData().GetScalars()).reshape(7, 30, 40)
poses = vtk_to_numpy(stack.GetFieldData().GetArray("ImageToReference"))
times = vtk_to_numpy(stack.GetFieldData().GetArray("Timestamp"))
assert len(np.unique(pixels)) > 2 and not np.array_equal(pixels, pixels[:, :, ::-1])
for extension in ("igs.mha", "mhd", "nrrd", "nhdr"):
    for level in (0, 1, 9):
        path = output("TrackedSliceWriter." + extension)
        SaveData(path, sweep, CompressionLevel=level)
        parse = parse_nrrd if extension in ("nrrd", "nhdr") else parse_metaimage
        parsed, fields, orientation, image_status = parse(path)
        assert parsed.dtype.newbyteorder("=") == pixels.dtype and np.array_equal(parsed, pixels), path
        assert np.array_equal(read_with_vtk(path), pixels), path
        assert orientation == "MFA"
        assert [fields[image_status][k] for k in range(7)] == ["OK"] * 7
        assert [float(fields["Timestamp"][k]) for k in range(7)] == list(times)

        # the poses, from the transforms in the file
        def matrix(name, k):
            assert fields[name + "TransformStatus"][k] == "OK"
            return np.array(fields[name + "Transform"][k].split(), float).reshape(4, 4)

        for k in range(7):
            pose = matrix("ProbeToReference", k) @ matrix("ImageToProbe", k)
            assert np.allclose(pose.ravel(), poses[k], rtol=0, atol=1e-9), (path, k)

        again = OpenDataFile(path)
        copy = servermanager.Fetch(again)
        assert np.allclose(vtk_to_numpy(copy.GetFieldData().GetArray("ImageToReference")), poses,
                           rtol=0, atol=1e-9)
        assert copy.GetFieldData().GetAbstractArray("Provenance").GetNumberOfValues() == 2
        Delete(again)

# Extensions in capitals, as old systems make them.
for extension in ("MHA", "MHD", "NRRD", "NHDR"):
    path = output("CAPITALS." + extension)
    SaveData(path, sweep)
    again = OpenDataFile(path)
    assert again.GetXMLName() == "LacunaTrackedSliceReader"
    assert np.array_equal(vtk_to_numpy(servermanager.Fetch(again).GetPointData().GetScalars()), pixels.ravel()), extension
    Delete(again)

# A script may also use the writer by name, and the class in VTK.
path = output("ByName.mha")
CreateWriter(path, sweep, CompressionLevel=0).UpdatePipeline()
assert np.array_equal(parse_metaimage(path)[0], pixels)
path = output("InVTK.nhdr")
plain.SetInputData(stack)
plain.SetFileName(path)
assert plain.Write() == 1 and plain.GetFileSize() > 0
assert np.array_equal(parse_nrrd(path)[0], pixels)

# Something else is refused.
other = vtkImageData()
other.SetDimensions(2, 2, 2)
other.AllocateScalars(3, 1)
plain.SetInputData(other)
plain.SetFileName(output("other.mha"))
errors = []
plain.AddObserver("ErrorEvent", lambda *_: errors.append(1))
assert plain.Write() == 0 and errors and not os.path.exists(output("other.mha"))
