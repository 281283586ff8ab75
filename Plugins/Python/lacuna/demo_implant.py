# SPDX-License-Identifier: BSD-3-Clause
"""The implant half of the demo: CT -> depth map -> filled hole -> IGES surface."""
import os

import numpy as np
import paraview.simple as pv
from paraview import servermanager
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import lacuna
from lacuna import pictures


def refuse_orientation(name):
    """ParaView's MetaImage reader drops TransformMatrix: a patient could come out mirrored."""
    with open(name, "rb") as file:
        head = file.read(10000)
    for line in head.split(b"\n"):
        key, _, value = line.partition(b"=")
        if key.strip() in (b"TransformMatrix", b"Rotation", b"Orientation"):
            if [float(x) for x in value.split()] != [1, 0, 0, 0, 1, 0, 0, 0, 1]:
                raise ValueError(
                    f"{name} is oriented ({key.strip().decode()} = {value.strip().decode()}), which ParaView's "
                    "reader ignores; the result could be mirrored. Keep oriented images in .vti")
        if key.strip() == b"ElementDataFile":
            return


def read(options):
    """The CT proxy, the view direction, and the truth (a function of filled pixels) or None."""
    if options.ct:
        if options.ct.lower().endswith((".mha", ".mhd")):
            refuse_orientation(options.ct)
        ct = pv.OpenDataFile(options.ct)
        if ct is None:
            raise ValueError(f"ParaView has no reader for {options.ct}")
        return ct, options.view
    ct = pv.SkullPhantom()
    return ct, [-c for c in ct.DefectDirection]


def cast(ct, view, options):
    ct.UpdatePipeline()
    caster = pv.BSplineIsoRayCaster(Input=ct, IsoValues=[options.iso], ViewDirection=view)
    if abs(view[2]) > 0.9 * np.linalg.norm(view):
        caster.ViewUp = [0, -1, 0]  # seen from above: anterior (LPS: -y) is up
    caster.UpdatePipeline()
    return caster
