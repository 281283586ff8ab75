# SPDX-License-Identifier: BSD-3-Clause
"""Readers of 3MF files that know nothing of Lacuna's writer."""
import ctypes
import ctypes.util
import xml.etree.ElementTree as ElementTree
import zipfile

import numpy as np

MILLIMETER = 1  # of the units that lib3mf counts
CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


def read_3mf(path):
    """What a reader finds that follows the specification: relationship, model, item, object."""
    with zipfile.ZipFile(path) as package:
        assert package.testzip() is None
        types = ElementTree.fromstring(package.read("[Content_Types].xml"))
        known = {e.get("Extension"): e.get("ContentType") for e in types}
        assert known["model"] == "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"
        assert known["rels"] == "application/vnd.openxmlformats-package.relationships+xml"
        rels = ElementTree.fromstring(package.read("_rels/.rels"))
        target = [r.get("Target") for r in rels
                  if r.get("Type") == "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"]
        assert len(target) == 1
        model = ElementTree.fromstring(package.read(target[0].lstrip("/")))
    objects = model.findall(f"{CORE}resources/{CORE}object")
    items = model.findall(f"{CORE}build/{CORE}item")
    assert [i.get("objectid") for i in items] == [o.get("id") for o in objects]
    assert all(i.get("transform") is None for i in items)
    mesh = objects[0].find(f"{CORE}mesh")
    return {
        "unit": model.get("unit"), "objects": len(objects), "name": objects[0].get("name"),
        "metadata": {m.get("name"): m.text for m in model.findall(f"{CORE}metadata")},
        "points": np.array([[float(v.get(k)) for k in "xyz"] for v in mesh.find(f"{CORE}vertices")]),
        "triangles": np.array([[int(t.get(k)) for k in ("v1", "v2", "v3")]
                               for t in mesh.find(f"{CORE}triangles")]),
    }


def judge_3mf(path):
    """What lib3mf, the 3MF Consortium's library (its interface of version 1), says; None without it."""
    name = ctypes.util.find_library("3MF")
    if not name:
        return None
    library = ctypes.CDLL(name)
    if not hasattr(library, "lib3mf_createmodel"):
        return None

    def call(function, *arguments):
        code = getattr(library, "lib3mf_" + function)(*arguments)
        assert code == 0, f"lib3mf_{function}: error {code & 0xffffffff:#x}"

    def number(function, handle):
        value = ctypes.c_uint32()
        call(function, handle, ctypes.byref(value))
        return value.value

    def text(function, handle, index, warning=False):
        buffer, needed, code = ctypes.create_string_buffer(1 << 20), ctypes.c_uint32(), ctypes.c_uint32()
        extra = [ctypes.byref(code)] if warning else []
        call(function, handle, ctypes.c_uint32(index), *extra, buffer, ctypes.c_uint32(1 << 20),
             ctypes.byref(needed))
        return buffer.value.decode()

    def get(function, handle, *arguments):
        result = ctypes.c_void_p()
        call(function, handle, *arguments, ctypes.byref(result))
        return result

    model = ctypes.c_void_p()
    call("createmodel", ctypes.byref(model))
    reader = get("model_queryreader", model, b"3mf")
    call("reader_setstrictmodeactive", reader, ctypes.c_int(1))
    call("reader_readfromfileutf8", reader, path.encode())
    meshes = get("model_getmeshobjects", model)
    objects, found = [], number("resourceiterator_movenext", meshes)
    while found:
        objects.append(get("resourceiterator_getcurrent", meshes))
        found = number("resourceiterator_movenext", meshes)
    mesh = objects[0]
    points = np.zeros((number("meshobject_getvertexcount", mesh), 3), np.float32)
    triangles = np.zeros((number("meshobject_gettrianglecount", mesh), 3), np.uint32)
    for function, array in (("getvertices", points), ("gettriangleindices", triangles)):
        size = ctypes.c_uint32()
        call("meshobject_" + function, mesh, array.ctypes.data_as(ctypes.c_void_p),
             ctypes.c_uint32(len(array)), ctypes.byref(size))
        assert size.value == len(array)
    return {
        "warnings": [text("reader_getwarningutf8", reader, k, True)
                     for k in range(number("reader_getwarningcount", reader))],
        "objects": len(objects), "unit": number("model_getunit", model), "points": points,
        "triangles": triangles, "manifold": bool(number("meshobject_ismanifoldandoriented", mesh)),
        "metadata": {text("model_getmetadatakeyutf8", model, k): text("model_getmetadatavalueutf8", model, k)
                     for k in range(number("model_getmetadatacount", model))},
    }
