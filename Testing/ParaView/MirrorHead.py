# SPDX-License-Identifier: BSD-3-Clause
"""The plane of symmetry of a real skull's CT, of the volume and of a depth map."""
import os
import time

import numpy as np
from lacuna_test import data
from paraview.simple import LoadPlugin, MetaFileSeriesReader
from paraview import servermanager

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def fetch(proxy):
    proxy.UpdatePipeline()
    return servermanager.Fetch(proxy)


def field(image, name):
    return np.array(image.GetFieldData().GetArray(name).GetTuple(0))


def report(what, image):
    print(what, *(f"{name} {field(image, name).round(4)}" for name in
                  ("MirrorPlaneNormal", "MirrorPlaneOrigin", "SymmetryScore", "SymmetryOverlap",
                   "SymmetryAmbiguity", "AsymmetryRMS")), flush=True)


head = MetaFileSeriesReader(FileNames=[data("ct_head/head.mha")])
head.UpdatePipeline()
start = time.process_time()
mirror = Mirror(Input=head)
volume = fetch(mirror)
print(f"{time.process_time() - start:.2f} s of processor time")
report("volume", volume)
# face towards +y, calvarium up: the plane's normal is nearly x
assert abs(field(volume, "MirrorPlaneNormal")[0]) > 0.99
assert field(volume, "SymmetryScore") > 0.8
assert field(volume, "SymmetryAmbiguity") < 0.8

# the frontal view of the bone tells nearly the same plane
front = BSplineIsoRayCaster(Input=head, IsoValues=[500], ViewDirection=[0, -1, 0], ViewUp=[0, 0, 1])
of_map = fetch(Mirror(Input=front))
report("depth map", of_map)
angle = np.degrees(np.arccos(min(1, field(of_map, "MirrorPlaneNormal") @ field(volume, "MirrorPlaneNormal"))))
print("planes differ by", angle, "degrees")
assert angle < 3
