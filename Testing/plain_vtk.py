# SPDX-License-Identifier: BSD-3-Clause
"""The package lacuna with VTK alone, as in the user guide: a skull's hole filled, without ParaView."""
import lacuna
from vtkmodules.vtkCommonDataModel import vtkSphere

skull = lacuna.vtkLacunaSkullPhantom()
caster = lacuna.vtkLacunaBSplineIsoRayCaster()
caster.SetInputConnection(skull.GetOutputPort())
caster.SetIsoValue(0, 500)
caster.SetViewDirection(-0.4, 0.2, -0.9)
caster.SetPixelSpacing(2)
ball = vtkSphere()
ball.SetCenter(28, -14, 63)
ball.SetRadius(39)
filler = lacuna.vtkLacunaRBFHoleFiller()
filler.SetInputConnection(caster.GetOutputPort())
filler.SetDefectRegion(ball)
filler.SetNodeSpacing(3)
filler.SetKernel(lacuna.choices(filler, "Kernel")["ThinPlate"])
assert lacuna.choices(filler, "Trend") == {"None": 0, "Ellipsoid": 1}
for wrong, error in (("Kernels", KeyError), ("KernelLength", ValueError), ("DefectArray", ValueError)):
    try:
        lacuna.choices(filler, wrong)
        raise AssertionError(wrong)
    except error as e:
        assert wrong in str(e) and "vtkLacunaRBFHoleFiller" in str(e), e
filler.Update()

points = filler.GetOutput().GetPointData()
field = filler.GetOutput().GetFieldData()
to_world = [field.GetArray("ImageToWorld").GetComponent(0, i) for i in range(16)]
ray = [to_world[2], to_world[6], to_world[10]]
width = filler.GetOutput().GetDimensions()[0]
worst = filled = 0
for pixel in range(0, points.GetArray("FilledMask").GetNumberOfTuples(), 7):
    if points.GetArray("FilledMask").GetValue(pixel):
        column, row = pixel % width, pixel // width
        start = [to_world[4 * r] * column + to_world[4 * r + 1] * row + to_world[4 * r + 3] for r in range(3)]
        truth = skull.IntersectOuterSurface(start, ray)
        worst = max(worst, abs(points.GetArray("Depth").GetValue(pixel) - truth))
        filled += 1
print(f"{filled} filled pixels tried, largest error {worst:.2f} mm")
assert filled > 100
assert worst < 1.5  # a defect of 78 mm seen in pixels of 2 mm
assert lacuna.__version__ in filler.GetOutput().GetFieldData().GetAbstractArray("Provenance").GetValue(0)
