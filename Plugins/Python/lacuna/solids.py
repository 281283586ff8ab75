# SPDX-License-Identifier: BSD-3-Clause
"""Solids in files, with what says where they come from.

    from lacuna.solids import save_solid
    save_solid("plate.stl", plate)     # writes plate.stl and plate.stl.json
"""
import hashlib
import json
import os


def save_solid(path, proxy, **options):
    """Writes a surface by ParaView's writer for the file's ending (stl, ply, obj, vtp, ...).

    Beside it, under the same name with .json behind it, are Lacuna's version, the steps that made
    the surface with hashes of their inputs and their parameters, its measures (field data with up to
    a few numbers) and the SHA-256 of the file: formats such as STL have no room for them. Raises
    PipelineError when a filter or the writer fails. options go to ParaView's SaveData. Returns the
    record.
    """
    from lacuna import __version__
    from lacuna.errors import PipelineError, raising
    from paraview import servermanager
    from paraview.simple import SaveData
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if os.path.exists(path):
        os.remove(path)  # what is there after a failure would be taken for the new one
    with raising():
        proxy.UpdatePipeline()
        data = servermanager.Fetch(proxy)
        if data is None or data.GetNumberOfPoints() == 0:
            raise PipelineError(f"there is nothing to write to {path}")
        SaveData(path, proxy, **options)
    if not os.path.exists(path):
        raise PipelineError(f"{path} was not written")
    steps, measures = [], {}
    fields = data.GetFieldData()
    for k in range(fields.GetNumberOfArrays()):
        array = fields.GetAbstractArray(k)
        if array.GetName() == "Provenance":
            steps = [array.GetValue(i) for i in range(array.GetNumberOfValues())]
        elif fields.GetArray(k) is not None and array.GetNumberOfValues() > 0:
            values = vtk_to_numpy(fields.GetArray(k)).tolist()
            measures[array.GetName()] = values[0] if len(values) == 1 else values
    with open(path, "rb") as file:
        digest = hashlib.sha256(file.read()).hexdigest()
    record = {
        "file": os.path.basename(path), "sha256": digest, "software": "Lacuna",
        "version": __version__, "unit": "mm", "coordinates": "patient, DICOM LPS",
        "bounds": list(data.GetBounds()), "measures": measures, "steps": steps,
        "notice": "Research software, not a medical device.",
    }
    text = json.dumps(record, indent=2, default=str)
    with open(path + ".json", "w", encoding="utf-8") as file:
        file.write(text.replace("NaN", "null") + "\n")
    return record
