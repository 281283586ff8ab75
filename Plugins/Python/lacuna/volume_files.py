# SPDX-License-Identifier: BSD-3-Clause
"""Which volumes in files ParaView reads to where they are, in mm.

ParaView's readers of MetaImage and NRRD drop the orientation without a word: a patient would come out turned or
mirrored. Its reader of DICOM files drops more.

    from lacuna import volume_files
    volume_files.check("head.mha")     # ValueError if it says more than ParaView reads
"""
import os
import re

DICOM, IMAGE = "DICOM", "image"
LONGEST_HEADER = 1 << 20  # bytes
MILLIMETRES = ("mm", "millimeter", "millimeters", "millimetre", "millimetres")
ADVICE = "ParaView's reader ignores that: the result could be turned, mirrored or of another size. Open the DICOM " \
         "series, or keep oriented images in .vti"


def check(path):
    """DICOM or IMAGE: what is to read a file, CT Series Reader or what ParaView has for it.

    Images are .vti, which have their direction, and MetaImage (.mha, .mhd) and NRRD (.nrrd, .nhdr) along the axes.
    Raises ValueError for those that say that they are oriented, in other units or of unknown ones, and for other
    formats, of which it is not known here how ParaView reads them.
    """
    if not os.path.isfile(path):
        raise ValueError(f"{path}: there is no such file")
    with open(path, "rb") as file:
        head = file.read(LONGEST_HEADER)
    ending = os.path.splitext(path)[1].lower()
    if head[128:132] == b"DICM" or ending in (".dcm", ".dicom", ".ima"):
        return DICOM
    if ending in (".mha", ".mhd"):
        _check_meta_image(path, head)
    elif ending in (".nrrd", ".nhdr"):
        _check_nrrd(path, head)
    elif ending != ".vti":
        raise ValueError(f"{path}: volumes are read from DICOM series, .vti, and .mha, .mhd, .nrrd and .nhdr along the "
                         "axes. Of other formats it is not sure that ParaView heeds how the patient lay")
    return IMAGE


def _refuse(path, key, value):
    raise ValueError(f"{path} is oriented or not in mm ({key} = {value}), and {ADVICE}")


def _numbers(path, key, text):
    try:
        return [float(x) for x in text.split()]
    except ValueError:
        raise ValueError(f"{path}: {key} = {text} are not numbers") from None


def _check_meta_image(path, head):
    for line in head.splitlines():
        match = re.match(rb"\s*(\w+)\s*[=:](.*)", line)
        key, value = (part.decode("latin-1").strip() for part in match.groups()) if match else ("", "")
        if key in ("TransformMatrix", "Rotation", "Orientation"):
            if _numbers(path, key, value) != [1, 0, 0, 0, 1, 0, 0, 0, 1]:
                _refuse(path, key, value)
        elif key in ("ElementSpacing", "ElementSize"):
            if not all(x > 0 for x in _numbers(path, key, value)):
                _refuse(path, key, value)
        elif key == "DistanceUnits":
            if value not in ("", "?", *MILLIMETRES):
                _refuse(path, key, value)
        elif key == "AnatomicalOrientation":
            # letters of where the axes come from: these come from right, anterior and inferior, as in LPS
            if value not in ("", "???", "RAI"):
                _refuse(path, key, value)
        elif key == "ElementDataFile":
            return
    raise ValueError(f"{path} is no MetaImage: it has no ElementDataFile in its first {LONGEST_HEADER} bytes")


def _check_nrrd(path, head):
    if not head.startswith(b"NRRD"):
        raise ValueError(f"{path} is no NRRD file")
    header, end, _ = head.replace(b"\r\n", b"\n").partition(b"\n\n")
    if not end and len(head) == LONGEST_HEADER:
        raise ValueError(f"{path} is no NRRD file: its header has no end in its first {LONGEST_HEADER} bytes")
    for line in header.decode("latin-1").split("\n"):
        match = re.match(r"([^#:]+):(?!=)(.*)", line)
        key, value = (match.group(1).strip().lower(), match.group(2).strip()) if match else ("", "")
        if key == "space" and value.lower() not in ("left-posterior-superior", "lps"):
            _refuse(path, key, value)
        elif key == "space directions":
            vectors = re.findall(r"\(([^)]*)\)|(none)", value)
            rows = [_numbers(path, key, inside.replace(",", " ")) for inside, none in vectors if not none]
            if not all(len(row) == len(rows) and all((x > 0) if i == k else (x == 0) for k, x in enumerate(row))
                       for i, row in enumerate(rows)):
                _refuse(path, key, value)
        elif key == "spacings" and not all(x > 0 for x in _numbers(path, key, value) if x == x):
            _refuse(path, key, value)
        elif key in ("space units", "units"):
            if not all(unit in ("", *MILLIMETRES) for unit in re.findall(r'"([^"]*)"', value)):
                _refuse(path, key, value)
