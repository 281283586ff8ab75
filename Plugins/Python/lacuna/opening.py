# SPDX-License-Identifier: BSD-3-Clause
"""Whatever a file is, opened where it lies.

    import lacuna
    skull = lacuna.open("scan")            # a folder of DICOM files, or one of them
    sweep = lacuna.open("sweep.igs.mha", CalibrationFileName="probe.xml")
    plate = lacuna.open("plate.stl")
"""
import os
import sys
import xml.etree.ElementTree

VOLUMES = (".mha", ".mhd", ".nrrd", ".nhdr", ".nii", ".nii.gz")
SEQUENCES = (".igs.mha", ".seq.mha", ".igs.mhd", ".seq.mhd", ".igs.nrrd", ".seq.nrrd", ".igs.nhdr", ".seq.nhdr")
SOLIDS = {".stl": ("STLReader", "FileNames"), ".ply": ("PLYReader", "FileNames"), ".obj": ("WavefrontOBJReader", "FileName")}
OUTLINES = (".mrk.json", ".json", ".csv")
PARAVIEW = {".vti": ("XMLImageDataReader", "FileName"), ".vtp": ("XMLPolyDataReader", "FileName")}
DICOM = (".dcm", ".dicom", ".ima")
READ = ("a DICOM series (its folder or a file of it), a volume (" + ", ".join(VOLUMES) + "), a tracked sweep (.igs.mha, .seq.nrrd), a solid "
        "(.stl, .ply, .obj, .3mf), outlines (.mrk.json, .csv, RT structure sets) and ParaView's .vti and .vtp")
# First bytes of what is no data of ours, whatever its name says.
OTHERS = {b"\xff\xd8\xff": "JPEG picture", b"\x89PNG": "PNG picture", b"BM": "BMP picture", b"GIF8": "GIF picture", b"II*\0": "TIFF picture",
          b"MM\0*": "TIFF picture", b"%PDF": "PDF document", b"PK\3\4": "ZIP archive", b"Rar!": "RAR archive", b"7z\xbc\xaf": "7-Zip archive"}
HEADER = 1 << 20  # bytes in which a sequence names its first frame


def open_file(path, **properties):
    """Opens a file, or a folder of DICOM files, where it lies, and returns its reader (a ParaView proxy), updated.

    It reads: DICOM series (CT Series Reader), volumes (Volume Reader), tracked sweeps (Tracked Slice Reader; also plain .mha or .nrrd
    files with poses), solids (.stl, .ply, .obj, .3mf), outlines (Outline Reader), .vti and .vtp. Loads the plugin if need be.

    properties: of the reader, such as CalibrationFileName of a sweep or SeriesUID of a DICOM folder.
    Raises FileNotFoundError, ValueError with what to do instead, and PipelineError with what the reader says.
    """
    from lacuna import session
    session.load_for(sys._getframe(1).f_globals)
    import paraview.simple as pv
    from lacuna.errors import raising
    path = os.fspath(path)
    _check_place(path)
    name, file = find_reader(path)
    if name == "TrivialProducer":
        return _open_3mf(path)
    reader = getattr(pv, name)(registrationName=os.path.basename(os.path.normpath(path)), **{file: [path] if file == "FileNames" else path},
                               **properties)
    try:
        with raising():
            reader.UpdatePipeline()
        _check_data(path, name, reader)
    except Exception:
        pv.Delete(reader)
        raise
    return _in_patient_coordinates(path, reader) if path.lower().endswith(tuple(SOLIDS)) else reader


def find_reader(path):
    """The constructor of the reader for a file or folder, and its property for the file's name. Raises ValueError with what to do."""
    if os.path.isdir(path):
        _check_folder(path)
        return "CTSeriesReader", "FileName"
    with open(path, "rb") as file:
        start = file.read(4096)
    if not start:
        raise ValueError(f"{path} is empty: it has 0 bytes. Copy it again from where it comes")
    name = path.lower()
    if start[128:132] == b"DICM":
        return "OutlineReader" if b"RTSTRUCT" in start else "CTSeriesReader", "FileName"
    kind = next((kind for begin, kind in OTHERS.items() if start.startswith(begin)), "")
    if kind and not (kind == "ZIP archive" and name.endswith(".3mf")):
        raise ValueError(f"{path} is a {kind}" + (", whatever its name says" if name.endswith(DICOM) else "") + _advice(kind))
    if name.endswith(".3mf"):
        return "TrivialProducer", ""
    if name.endswith(DICOM):  # old ones begin without the mark
        return "CTSeriesReader", "FileName"
    if name.endswith(VOLUMES):
        return "TrackedSliceReader" if name.endswith(SEQUENCES) or _is_sequence(path) else "VolumeReader", "FileName"
    if name.endswith(OUTLINES):
        return "OutlineReader", "FileName"
    if name.endswith(tuple(PARAVIEW) + tuple(SOLIDS)):
        return (PARAVIEW | SOLIDS)[os.path.splitext(name)[1]]
    raise ValueError(f"{path}: {_unknown(name, start)}")


def _advice(kind):
    if kind.endswith("picture"):
        return (". A picture does not say where it lies, nor its Hounsfield units. Export the series as DICOM files. Pictures of a tracked "
                "sweep and a table of their poses go through AssembleTrackedSlices")
    if kind.endswith("archive"):
        return ". Unpack it, and open what is in it"
    return f". lacuna.open reads {READ}"


def _unknown(name, start):
    if name.endswith(".xml") and b"PlusConfiguration" in start:
        return "this is a calibration of PLUS. Give it with its sweep: lacuna.open(sweep, CalibrationFileName=...)"
    if name.endswith((".raw", ".zraw", ".raw.gz")):
        return "these are pixels without a header. Open the .mhd or .nhdr file that belongs to them"
    if name.endswith(".pvsm"):
        return "this is a state of ParaView. lacuna.states.load opens it"
    return (f"what this is is not known. lacuna.open reads {READ}. ParaView's OpenDataFile knows more formats, but may not lay them where "
            "they lie in the patient")


def _check_place(path):
    """Raises FileNotFoundError, with names that are near."""
    from lacuna.session import proposal
    from paraview import servermanager
    if os.path.exists(path):
        return
    if servermanager.ActiveConnection.IsRemote():
        raise FileNotFoundError(f"{path} is not on this computer, where lacuna.open looks what it is. For a file of the server use its "
                                "reader, such as lacuna.VolumeReader(FileName=...)")
    folder = os.path.dirname(path) or "."
    while not os.path.isdir(folder):
        path, folder = folder, os.path.dirname(folder) or "."
    there = os.listdir(folder)
    near = proposal(os.path.basename(path), there)
    raise FileNotFoundError(f"there is no {path}" + ("" if there else f": the folder {folder} is empty") + near)


def _check_folder(path):
    """Raises ValueError for a folder in which nothing can be DICOM, with what can be opened instead."""
    files = [os.path.join(place, name) for place, _, names in os.walk(path) for name in names]
    if not files:
        raise ValueError(f"the folder {path} is empty")
    others = []
    for file in files[:1000]:
        try:
            if find_reader(file)[0] in ("CTSeriesReader", "OutlineReader") and not file.lower().endswith(OUTLINES):
                return
            others.append(file)
        except (OSError, ValueError):
            pass
    if len(files) > 1000:
        return  # the reader looks at all
    raise ValueError(f"the folder {path} has no DICOM file" + (
        f". Open one of its files: {', '.join(sorted(others)[:5])}" if others else f", and nothing else that lacuna.open reads: {READ}"))


def _is_sequence(path):
    """Whether a MetaImage or NRRD file has fields of frames."""
    with open(path, "rb") as file:
        header = file.read(HEADER)
    for end in (b"\nElementDataFile", b"\n\n", b"\r\n\r\n"):
        header = header.partition(end)[0]
    return b"\nSeq_Frame" in header


def _check_data(path, name, reader):
    """Raises ValueError where a reader found nothing, or slices that nobody can lay in space."""
    information = reader.GetDataInformation()
    if name == "TrackedSliceReader" and information.GetFieldDataInformation().GetArrayInformation("ImageToReference") is None:
        found = calibrations(os.path.dirname(path) or ".")
        raise ValueError(
            f"{path} is a sweep without a calibration: where its slices lie on the probe is not known. Give CalibrationFileName=, a "
            "configuration of PLUS with the Image to Probe transform" + (f". Beside it there is {' and '.join(found)}" if found else "") +
            f". To calibrate the probe by this sweep, read it by lacuna.TrackedSliceReader(FileName={path!r})")
    if information.GetNumberOfPoints() == 0:
        raise ValueError(f"{path} has nothing in it: no point was read")


def calibrations(folder):
    """Names of the device set configurations of PLUS (XML) in a folder that have a transform from Image to Probe."""
    found = []
    try:
        for name in sorted(os.listdir(folder)):
            path = os.path.join(folder, name)
            if name.lower().endswith(".xml") and os.path.isfile(path) and os.path.getsize(path) <= HEADER and _is_calibration(path):
                found.append(path)
    except OSError:
        pass  # what cannot be read is not offered
    return found


def _is_calibration(path):
    try:
        root = xml.etree.ElementTree.parse(path).getroot()
    except (xml.etree.ElementTree.ParseError, ValueError):
        return False
    return any(each.get("From") == "Image" and each.get("To") == "Probe" for each in root.iter("Transform"))


def _in_patient_coordinates(path, reader):
    """A solid that says it lies in RAS, as 3D Slicer once wrote them, turned to LPS: by half a turn about z, never mirrored."""
    import paraview.simple as pv
    with open(path, "rb") as file:
        if b"SPACE=RAS" not in file.read(4096):
            return reader
    turned = pv.Transform(registrationName=os.path.basename(path) + " in LPS", Input=reader)
    turned.Transform.Rotate = [0, 0, 180]
    turned.UpdatePipeline()
    return turned


def _open_3mf(path):
    import paraview.simple as pv
    from lacuna.as_made import read
    from paraview import servermanager
    if servermanager.ActiveConnection.IsRemote():
        raise ValueError(f"{path}: 3MF is read on this computer, not on a server. Save the solid as .stl")
    surface = read(path)
    producer = pv.TrivialProducer(registrationName=os.path.basename(path))
    producer.GetClientSideObject().SetOutput(surface)
    producer.UpdatePipeline()
    return producer
