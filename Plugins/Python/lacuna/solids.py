# SPDX-License-Identifier: BSD-3-Clause
"""Solids in files, with what says where they come from.

    from lacuna.solids import save_solid
    save_solid("plate.stl", plate)     # writes plate.stl and plate.stl.json
    save_solid("plate.3mf", plate)     # writes plate.3mf, with unit and history, and plate.3mf.json
    save_solid("plate.step", plate)    # a solid with flat faces for CAD programs, and plate.step.json
"""
import hashlib
import json
import math
import os
import re
import shutil
import zipfile
from xml.sax.saxutils import escape, quoteattr

STEP = (".step", ".stp")
NOTICE = "Research software, not a medical device."
TIMINGS = ("FitTime",)  # field data that differ from run to run; what stays the same gives the same record
# Characters that an XML file cannot have, not even escaped.
NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def save_solid(path, proxy, allow_mirrored=False, **options):
    """Writes a surface to a file: 3mf, step or stp, or what ParaView writes by the ending (stl, ply, obj, vtp, ...).

    Beside it, under the same name with .json behind it, are Lacuna's version, the steps that made
    the surface with hashes of their inputs and their parameters, its measures (field data with up to
    a few numbers; null where there is none; none behind filters of ParaView that move points, such as
    Transform) and the SHA-256 of the file: formats such as STL have no room for them. 3MF has, and
    its unit is the millimetre; it holds closed surfaces of triangles that face outwards. STEP (STEP Writer;
    Tolerance is an option) has and holds the same, as solids with flat faces within 0.02 mm. In which
    coordinates the surface is stands there, too, as lacuna.coordinates.find knows it: "unknown" if it
    does not. Raises PipelineError when a filter or the writer fails (also when the disk has no room
    left), when there is no polygon or a point is not finite, and for a mirror image of the patient
    (lacuna.coordinates) unless allow_mirrored. Neither of the two files is there then: older ones, which
    would be taken for the new ones, have .old behind their names (they may be all there is, as of a
    surface that was read from path).
    options go to ParaView's SaveData. Returns the record, as it is in the file.
    """
    from lacuna.errors import PipelineError
    from lacuna.files import is_stream

    for each in (path, path + ".json"):
        if os.path.isdir(each):
            raise PipelineError(f"{each} is a folder")
        if is_stream(each):  # which would get another name
            raise PipelineError(f"{each} is a device or a pipe; save the solid in a file, and copy that")
    try:
        return _save_solid(path, proxy, allow_mirrored, options)
    except BaseException:
        _set_aside(os.path.realpath(path), os.path.realpath(path + ".json"))
        raise


def _set_aside(*paths):
    """Gives an older solid and its record the first free names of path.old, path.old2, ...; where that cannot be, they stay."""
    number = 1
    while any(os.path.lexists(_get_old_name(each, number)) for each in paths):
        number += 1
    for each in paths:
        try:
            os.rename(each, _get_old_name(each, number))
        except OSError:
            pass  # none is there, or the folder lets nobody: what went wrong before says more


def _get_old_name(path, number):
    return f"{path}.old{number if number > 1 else ''}"


def _save_solid(path, proxy, allow_mirrored, options):
    """save_solid; the old files stay where they are until both new ones are whole in a folder beside them."""
    from lacuna import __version__, coordinates
    from lacuna.data import fetch
    from lacuna.errors import PipelineError, raising
    from lacuna.files import folder_beside

    target = os.path.realpath(path)  # a link stays
    with raising():
        proxy.UpdatePipeline()
        data = fetch(proxy)
    if data is None or data.GetNumberOfPoints() == 0:
        raise PipelineError(f"there is nothing to write to {path}")
    _check_surface(path, data)
    if coordinates.is_mirrored(proxy) and not allow_mirrored:
        raise PipelineError(f"{path}: this is a mirror image of the patient (by Mirror, Reflect or a negative Scale of "
                            "Transform); check the side, and give allow_mirrored=True if the mirrored one is wanted")
    place = coordinates.find(proxy)
    steps, measures = _steps_and_measures(data)
    if not coordinates.keeps_points(proxy):
        measures = {}  # of the surface before it was moved or scaled
    try:
        with folder_beside(target) as folder:
            root, ending = os.path.splitext(os.path.basename(path))
            name = os.path.join(folder, root + ending.lower())  # ParaView knows its writers by these only
            if ending.lower() == ".3mf":
                _write_3mf(name, path, data, proxy.GetXMLLabel(), f"Lacuna {__version__}", place, steps)
            else:
                if ending.lower() in STEP:
                    options = {"Note": f"Coordinates: {place} (mm). {NOTICE}", "AllowMirrored": int(allow_mirrored)} | options
                _write_by_paraview(name, path, proxy, options)
            with open(name, "rb") as file:
                digest = hashlib.sha256(file.read()).hexdigest()
            record = _without_nan({
                "file": os.path.basename(path), "sha256": digest, "software": "Lacuna",
                "version": __version__, "unit": "mm", "coordinates": place,
                "bounds": list(data.GetBounds()), "measures": measures, "steps": steps,
                "notice": NOTICE,
            })
            record_name = name + ".json"
            with open(record_name, "w", encoding="utf-8") as file:
                file.write(json.dumps(record, indent=2, allow_nan=False) + "\n")
            _replace(target, name, os.path.realpath(path + ".json"), record_name)
    except OSError as error:
        raise PipelineError(f"{path} cannot be written: {error.strerror}") from error
    return record


def _replace(path, solid, beside, record):
    """Gives both their names; an older record is never beside another solid than its own."""
    from lacuna.files import take_access
    if os.path.exists(path):
        take_access(solid, path)
        take_access(record, beside if os.path.exists(beside) else path)
    older = record + ".old"
    if os.path.lexists(beside):
        shutil.move(beside, older)  # its link may lead to another disk
    try:
        os.replace(solid, path)
    except OSError:
        if os.path.lexists(older):
            shutil.move(older, beside)
        raise
    shutil.move(record, beside)


def _check_surface(path, data):
    """Raises PipelineError for what has no surface, is of several blocks, or has points that are nowhere."""
    import numpy as np
    from lacuna.errors import PipelineError
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if data.IsA("vtkCompositeDataSet"):
        raise PipelineError(f"{path}: these are several blocks; apply Merge Blocks and Extract Surface first")
    if not data.IsA("vtkPointSet"):
        return
    if data.IsA("vtkPolyData") and data.GetNumberOfPolys() + data.GetNumberOfStrips() == 0:
        raise PipelineError(f"{path}: there is no polygon to write, only points or lines")
    bad = np.flatnonzero(~np.isfinite(vtk_to_numpy(data.GetPoints().GetData())).all(axis=1))
    if bad.size:
        raise PipelineError(f"{path}: point {bad[0]} of the surface is not finite")


def _steps_and_measures(data):
    """The provenance of data (vtkDataObject) as a list, and its other field data of numbers as a dict."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    steps, measures = [], {}
    fields = data.GetFieldData()
    for k in range(fields.GetNumberOfArrays()):
        array = fields.GetAbstractArray(k)
        name = array.GetName()
        if name == "Provenance":
            steps = [array.GetValue(i) for i in range(array.GetNumberOfValues())]
        elif fields.GetArray(k) is not None and array.GetNumberOfValues() > 0 and name not in TIMINGS:
            values = vtk_to_numpy(fields.GetArray(k)).tolist()
            measures[name] = values[0] if len(values) == 1 else values
    return steps, measures


def _without_nan(value):
    """The same with None for each number that is not finite, for which JSON has no word."""
    if isinstance(value, dict):
        return {name: _without_nan(each) for name, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_without_nan(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _write_by_paraview(name, path, proxy, options):
    """Writes the file name, alone in its folder, for path; raises for formats of several files."""
    from lacuna.errors import raising
    from lacuna.files import check_whole, only_file
    from paraview.simple import SaveData

    if name.endswith(".vtp"):
        # Debian 12's libexpat breaks ParaView 5.11's reading of its default, raw bytes; VTK 9.6 writing anything else than
        # appended ends the program when the disk is full
        options = {"DataMode": "Appended", "EncodeAppendedData": 1} | options
    with raising():
        SaveData(name, proxy, **options)
    only_file(name, path)
    check_whole(name)


def _check_closed(path, points, triangles):
    """Raises PipelineError unless triangles bound a solid: each edge of two, once each way, facing outwards."""
    import numpy as np
    from lacuna.errors import PipelineError

    count = len(points)
    starts, ends = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    flat = np.flatnonzero(starts == ends)
    if flat.size:
        raise PipelineError(f"{path}: triangle {flat[0] // 3} has a corner twice; apply Clean first")
    there, again = np.unique(starts * count + ends, return_counts=True)
    twice = there[again > 1]
    if twice.size:
        x, y, z = points[twice[0] // count]
        raise PipelineError(f"{path}: the surface branches or is turned over: {twice.size} edges have more than one "
                            f"triangle on the same side, such as one at {x:g} {y:g} {z:g} mm")
    alone = np.setdiff1d(ends * count + starts, there)
    if alone.size:
        x, y, z = points[alone[0] // count]
        raise PipelineError(
            f"{path}: 3MF holds closed surfaces, and this one is open: {alone.size} edges have a triangle on one side "
            f"only, such as one at {x:g} {y:g} {z:g} mm. Write another format, or if points are there twice (Generate "
            "Surface Normals splits them) apply Clean first")
    a, b, c = (points[triangles[:, k]] - points[0] for k in range(3))
    if np.einsum("ij,ij->", a, np.cross(b, c)) < 0:
        raise PipelineError(f"{path}: the surface is inside out; turn its triangles (Generate Surface Normals, "
                            "Flip Normals)")


def _write_3mf(name, path, data, title, application, place, steps):
    """One object in the 3MF core format (1.x), with the points as they are, without a transform.

    Coordinates have six decimals, a nanometre. Metadata: Title, Application, Description (unit,
    coordinates and the steps, one a line). No date, so that the same plate gives the same file.
    """
    from lacuna.errors import PipelineError
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if not data.IsA("vtkPolyData"):
        raise PipelineError(f"{path}: 3MF holds a surface (polygonal data), this is a {data.GetClassName()}")
    cells = data.GetPolys()
    offsets = vtk_to_numpy(cells.GetOffsetsArray())
    count = cells.GetNumberOfCells()
    if count == 0 or data.GetNumberOfCells() != count or (offsets[1:] - offsets[:-1] != 3).any():
        raise PipelineError(f"{path}: 3MF holds triangles only; apply Extract Surface and Triangulate first")
    points = vtk_to_numpy(data.GetPoints().GetData())
    triangles = vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, 3).astype("int64")
    _check_closed(path, points.astype(float), triangles)
    description = "\n".join(
        [f"Coordinates: {place} (mm). {NOTICE}"] + [f"Made by: {step}" for step in steps])
    metadata = {"Title": title, "Application": application, "Description": description}
    lines = ['<?xml version="1.0" encoding="UTF-8"?>',
             '<model unit="millimeter" xml:lang="en-US" '
             'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">']
    lines += [f' <metadata name="{name}">{escape(NO_XML.sub("", text))}</metadata>' for name, text in metadata.items()]
    lines += [" <resources>", f'  <object id="1" type="model" name={quoteattr(title)}>', "   <mesh>",
              "    <vertices>"]
    lines += ['     <vertex x="%.6f" y="%.6f" z="%.6f"/>' % tuple(p) for p in points.tolist()]
    lines += ["    </vertices>", "    <triangles>"]
    lines += ['     <triangle v1="%d" v2="%d" v3="%d"/>' % tuple(t) for t in triangles.tolist()]
    lines += ["    </triangles>", "   </mesh>", "  </object>", " </resources>",
              ' <build><item objectid="1"/></build>', "</model>", ""]
    parts = {
        "[Content_Types].xml": '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
        '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
        '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>'
        "</Types>\n",
        "_rels/.rels": '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
        '<Relationship Id="model" Target="/3D/3dmodel.model" '
        'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>\n',
        "3D/3dmodel.model": "\n".join(lines),
    }
    with zipfile.ZipFile(name, "w", zipfile.ZIP_DEFLATED) as package:
        for part, text in parts.items():
            package.writestr(zipfile.ZipInfo(part), text.encode(), zipfile.ZIP_DEFLATED)
