# SPDX-License-Identifier: BSD-3-Clause
"""Which DICOM series an implant was made from stands in every file, as the FNV-1a hash of its UID, and nothing else does
that could tell who the patient is: not even when the reader is asked to keep the identity in its output."""
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile

from lacuna.errors import raising
from lacuna.solids import save_solid
from lacuna_test import output
from letter_block import HALF, face_axes
from paraview.simple import ExtractSurface, LoadPlugin, SaveData

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
folder = output("series in files")
shutil.rmtree(folder, ignore_errors=True)
scans = os.path.join(folder, "Doe^Jane")
subprocess.run([sys.argv[1], scans], check=True)

# As CTTestSeries.cxx writes them
UID = "1.2.826.0.1.3680043.2.1125.1"
SECRETS = ["Secret", "19010203", "1.2.826", "Letter F", "Doe^Jane", "20260102"]


def fnv1a(text):
    """64 bits, by Fowler, Noll and Vo."""
    value = 0xcbf29ce484222325
    for byte in text.encode("ascii"):
        value = (value ^ byte) * 0x100000001b3 % 2 ** 64
    return f"{value:016x}"


assert fnv1a("") == "cbf29ce484222325" and fnv1a("foobar") == "85944171f73967e8"  # of the authors' test vectors
SERIES = f"Series=fnv1a:{fnv1a(UID)}"


def texts_of(path):
    """All that is in a file, and what a person finds in it about its making."""
    with open(path, "rb") as file:
        everything = file.read()
    if path.endswith(".3mf"):
        with zipfile.ZipFile(path) as package:
            everything = b"".join(package.read(name) for name in package.namelist())
        return everything, everything.decode("utf-8")
    text = everything.decode("latin-1")
    if path.endswith(".json"):
        return everything, "\n".join(json.loads(text)["steps"])
    if path.endswith(".igs"):  # start section: columns of 72
        return everything, "".join(line[:72] for line in text.splitlines() if line[72] == "S")
    if path.endswith(".nc"):  # comments; words that had to be cut go on behind "..."
        return everything, "".join(re.findall(r"\((.*)\)", text)).replace("......", "")
    return everything, None


for keep in (0, 1):
    scan = CTSeriesReader(FileName=os.path.join(scans, "oblique"), KeepPatientIdentity=keep)
    along, up, normal = face_axes(0)
    depth = BSplineIsoRayCaster(Input=scan, IsoValues=[0], PixelSpacing=1, ViewDirection=list(-normal),
                                ViewUp=list(up), FocalPoint=list(HALF * normal), ImageSize=[46, 46])
    filled = RBFHoleFiller(Input=depth, NodeSpacing=3)
    filled.DefectRegion = "Cylinder"
    filled.DefectRegion.Center, filled.DefectRegion.Axis = list(HALF * normal), list(normal)
    filled.DefectRegion.Radius = 15
    plate = ImplantPlate(Input=filled)
    model = DefectModel(Input=filled, Margin=4)
    mould = PressOrientation(Input=filled, PlateMargin=1, FlangeWidth=8, ConvexSide="Outward")
    path = MillingToolPath(Input=mould)
    with raising([]):
        path.UpdatePipeline()
    identity = scan.GetClientSideObject().GetOutput().GetFieldData().GetAbstractArray("PatientName")
    assert (identity.GetValue(0) == "Secret^Name") if keep else identity is None

    for file, proxy in (("plate.stl", plate), ("plate.3mf", plate), ("model.ply", model), ("model.3mf", model),
                        ("mould.stl", ExtractSurface(Input=mould))):
        save_solid(os.path.join(folder, file), proxy)
    for file, proxy in (("surface.igs", filled), ("mould.igs", mould), ("mould.nc", path)):
        with raising([]):
            SaveData(os.path.join(folder, file), proxy)
    written = [name for name in sorted(os.listdir(folder)) if name != "Doe^Jane"]
    assert len(written) == 13, written
    for file in written:
        everything, made_by = texts_of(os.path.join(folder, file))
        if made_by is not None:
            wanted = SERIES.upper() if file.endswith(".nc") else SERIES
            assert wanted in made_by, (file, wanted, made_by)
            assert "vtklacunactseriesreader" in made_by.lower(), file
        for secret in SECRETS:
            assert secret.lower().encode() not in everything.lower(), (keep, file, secret)
        os.remove(os.path.join(folder, file))
    print(f"KeepPatientIdentity {keep}: {', '.join(written)}", flush=True)
print("ok")
