# SPDX-License-Identifier: BSD-3-Clause
"""What is made of a filled defect: a plate with drainage, the model to fit it in, and both moulds to press it.

    pvpython in_paraview.py [folder for picture and state file, default: .]

Writes plate-model-mould.png and plate-model-mould.pvsm, for File > Load State.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import pictures, states
from paraview.simple import *

# Of your own: lacuna.data.open_volume("folder of DICOM files")
skull = SkullPhantom(registrationName="CT")
VIEW = dict(ViewDirection=[-0.4, 0.2, -0.9], ViewUp=[0, -1, 0])
depth = BSplineIsoRayCaster(registrationName="Depth map", Input=skull, IsoValues=[500], **VIEW)
filled = RBFHoleFiller(registrationName="Filled", Input=depth, Smoothing=5, OutputMargin=8)

# In patient coordinates
plate = ImplantPlate(registrationName="Plate", Input=filled, Thickness=1, Side="Outward", EdgeClearance=-5, Bevel=0.5, DrainageSpacing=8)
bone = DepthMapSurface(registrationName="Bone", Input=depth, MaximumAngle=80)

# In press coordinates: lying flat
model = DefectModel(registrationName="Model", Input=filled)
moulds = [PressOrientation(registrationName=kind + " mould", Input=filled, Mould=kind, OutputSpacing=0.4) for kind in ("Female", "Male")]

PLASTIC = (0.45, 0.60, 0.80)
view = pictures.new_view((560, 520))
pictures.show_surface(bone, view, pictures.BONE)
pictures.show_surface(plate, view, PLASTIC)
pictures.add_title(view, "Plate, in the patient")
pictures.look(view, VIEW["ViewDirection"], VIEW["ViewUp"], 1.7)
views = [view]
for source, title in ((model, "Model"), (moulds[0], "Female mould"), (moulds[1], "Male mould")):
    view = pictures.new_view((560, 520))
    surface = source if source is model else ExtractSurface(registrationName="Surface of the " + title.lower(), Input=source)
    pictures.show_surface(surface, view, pictures.BONE)
    pictures.add_title(view, title)
    pictures.look(view, (0.25, 0.75, -0.65), (0, 0, 1), 1.2 if source is model else 1)
    views.append(view)
layout = pictures.lay_out(views, "Plate, model and moulds")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "plate-model-mould.png"))
states.save(os.path.join(folder, "plate-model-mould.pvsm"))
