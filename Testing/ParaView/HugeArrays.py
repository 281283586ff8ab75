# SPDX-License-Identifier: BSD-3-Clause
"""What an XML image takes: all arrays that are switched on, also those that are not the active scalars, and no others."""
import base64
import os
import resource
import struct
import zlib

import lacuna
from lacuna.errors import PipelineError, raising
from lacuna_test import memory_of_process, output
from paraview.simple import *
from vtkmodules.vtkIOXML import vtkXMLImageDataReader

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())

N = 256
LARGE = 9 * 8 * N**3  # bytes of nine doubles for each point
SMALL = 2 * N**3
BLOCK = 1 << 20


def write(name, attributes, *arrays):
    """An image of zeros; arrays: name, type, components and bytes of each. Large ones, which nobody may read, hold nothing."""
    body = ""
    for array, kind, components, size in arrays:
        blocks = [] if size == LARGE else [len(zlib.compress(bytes(BLOCK)))] * (size // BLOCK)
        sizes = base64.b64encode(struct.pack(f"<{3 + len(blocks)}Q", len(blocks), BLOCK, 0, *blocks))
        values = base64.b64encode(zlib.compress(bytes(BLOCK)) * len(blocks))
        body += (f'<DataArray type="{kind}" Name="{array}" NumberOfComponents="{components}" format="binary">'
                 f'{(sizes + values).decode()}</DataArray>')
    extent = f"0 {N - 1} 0 {N - 1} 0 {N - 1}"
    path = output(name)
    with open(path, "w", encoding="ascii") as file:
        file.write(f'<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64" '
                   f'compressor="vtkZLibDataCompressor"><ImageData WholeExtent="{extent}" Origin="0 0 0" Spacing="1 1 1">'
                   f'<Piece Extent="{extent}"><PointData {attributes}>{body}</PointData></Piece></ImageData></VTKFile>')
    return path


def errors_by_vtk(path, keep):
    reader = vtkXMLImageDataReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    if keep:
        reader.GetPointDataArraySelection().DisableAllArrays()
        reader.GetPointDataArraySelection().EnableArray(keep)
    filter = lacuna.vtkLacunaContrastToSpeckle()
    filter.SetInputConnection(reader.GetOutputPort())
    texts = []

    def listen(_, __, text):
        texts.append(text)
    listen.CallDataType = "string0"
    filter.AddObserver("ErrorEvent", listen)
    filter.Update()
    return "".join(texts)


def errors_by_paraview(path, keep):
    reader = XMLImageDataReader(FileName=[path])
    if keep:
        reader.PointArrayStatus = [keep]
    filter = ContrastToSpeckle(Input=reader)
    try:
        with raising():
            filter.UpdatePipeline()
        return ""
    except PipelineError as error:
        return str(error)
    finally:
        Delete(filter)
        Delete(reader)


gradient, ct = ("gradient", "Float64", 9, LARGE), ("ct", "Int16", 1, SMALL)
cases = [("vectors, no scalars", write("HugeArraysVectors.vti", 'Vectors="gradient"', gradient), None, LARGE),
         ("small scalars, large vectors", write("HugeArraysBoth.vti", 'Scalars="ct"', ct, gradient), None, LARGE + SMALL),
         ("large vectors switched off", output("HugeArraysBoth.vti"), "ct", 0),
         ("large scalars", write("HugeArraysScalars.vti", 'Scalars="gradient"', gradient, ct), None, LARGE + SMALL),
         ("large scalars switched off", output("HugeArraysScalars.vti"), "ct", 0)]
resource.setrlimit(resource.RLIMIT_AS, (memory_of_process("VmSize") + (1 << 30), resource.RLIM_INFINITY))
for name, path, keep, size in cases:
    for errors in (errors_by_vtk, errors_by_paraview):
        text = errors(path, keep)
        print(f"{name}, {errors.__name__}: {text.strip()[:200]}", flush=True)
        assert (f"{size} bytes" in text) if size else ("bytes" not in text), (name, text)
for _, path, _, _ in cases:
    if os.path.exists(path):
        os.remove(path)
print("ok")
