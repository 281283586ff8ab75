# SPDX-License-Identifier: BSD-3-Clause
"""What panels of the ParaView application say and do: units, what 0 means, empty fields, sliders, places and
marks of regions, and the guide."""
import lacuna_window

ADVANCED = "propertiesPanel/AdvancedButton"


def drag(window, name, steps):
    """Drags the handle of a slider by so many pixels."""
    width, height, value = (float(window.get(name, attribute)) for attribute in ("width", "height", "value"))
    handle = 5 + (width - 10) * value / 400
    window.drag([(handle, height / 2), (handle + steps, height / 2)], name)


def points_of(source):
    """Of a source of this process: N x 3."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    return vtk_to_numpy(source.GetClientSideObject().GetOutputDataObject(0).GetPoints().GetData())


def test(window):
    import numpy as np
    import lacuna.window
    from lacuna.data import fetch
    from paraview import servermanager
    from paraview.simple import GetActiveSource, GetActiveView, GetDisplayProperties, SetActiveSource
    window.resize(1500, 1000)
    window.menu("Lacuna/Sample CT: Skull with a Hole")
    phantom = GetActiveSource()
    phantom.Spacing = [2.5, 2.5, 2.5]
    assert phantom.Sutures
    view = GetActiveView()
    camera = view.GetActiveCamera()
    camera.SetPosition(200, -100, 450)
    camera.SetFocalPoint(0, 0, 0)
    camera.SetViewUp(0, -1, 0)

    # Labels have units; an empty field is its default
    window.menu("Lacuna/Skull and implant/Depth map of a skull: B-Spline Iso Ray Caster")
    caster = GetActiveSource()
    assert window.get("LacunaLabel_PixelSpacing") == "Pixel Spacing (mm)<br><small>0: smallest voxel edge</small>"
    window.press(ADVANCED)
    first, second, third = (f"{lacuna_window.PANEL}FocalPoint/DoubleLineEdit{n}" for n in range(3))
    assert window.get(first) == "" and window.get(first, "placeholderText") == "middle of the volume"
    for name, text in ((first, "1.5"), (second, "-2"), (third, "3")):
        window.type(name, text)
    window.press(lacuna_window.ACCEPT)
    assert list(caster.FocalPoint) == [1.5, -2, 3]
    for name in (first, second, third):
        window.type(name, "")
    window.press(lacuna_window.ACCEPT)
    window.check_messages()
    assert list(caster.FocalPoint) == [1e299] * 3
    window.press(ADVANCED)

    # A slider changes the picture without Apply
    level = caster.IsoValues[0]
    drag(window, "LacunaSlider_IsoValues", 12)
    assert caster.IsoValues[0] > level
    caster.IsoValues = [500]

    # The hole filler: what its default is called, and regions over the hole
    window.menu("Lacuna/Skull and implant/Fill a hole of a depth map: RBF Hole Filler")
    filler = GetActiveSource()
    assert window.get(lacuna_window.PANEL + "DefectRegion/comboBox", "currentText") == "Automatic (all enclosed holes)"
    assert window.get("LacunaSliders", "visible") == "false", "it was not applied"
    direction = np.array(phantom.DefectDirection)
    direction /= np.linalg.norm(direction)
    truth = phantom.GetClientSideObject()
    middle = direction * truth.IntersectOuterSurface([0, 0, 0], direction)
    regions = filler.GetProperty("DefectRegion").SMProperty.FindDomain("vtkSMProxyListDomain")
    found = {regions.GetProxy(n).GetXMLName(): servermanager._getPyProxy(regions.GetProxy(n)) for n in range(regions.GetNumberOfProxies())}
    assert np.linalg.norm(np.array(found["Sphere"].Center) - middle) < 12, (found["Sphere"].Center, middle)
    rim = np.array(found["LacunaSplineLoop"].Points).reshape(-1, 3)
    assert len(rim) == 8 and not any(truth.IsInDefect(*point) for point in rim), "the loop is around the hole"
    assert all(20 < np.linalg.norm(point - middle) < 50 for point in rim)

    # What will be replaced is seen before Apply: the hole, and what a sphere covers
    caster_view = np.array(fetch(caster).GetFieldData().GetArray("ImageToWorld").GetTuple(0)).reshape(4, 4)[:3, 2]
    hidden = view.SMProxy.GetProperty("HiddenRepresentations")
    window.wait_for("the marks", lambda: lacuna.window._marks)
    marks = points_of(lacuna.window._marks[0][1])
    assert np.linalg.norm(marks - middle, axis=1).min() < 5, "they cover the middle of the hole"
    assert hidden.GetNumberOfProxies() == len(lacuna.window._marks) == 1
    window.choose(lacuna_window.PANEL + "DefectRegion/comboBox", "Sphere")
    window.wait_for("other marks", lambda: len(points_of(lacuna.window._marks[0][1])) != len(marks))
    marks = points_of(lacuna.window._marks[0][1])
    aside = np.linalg.norm(np.cross(marks - np.array(found["Sphere"].Center), caster_view), axis=1)
    assert aside.max() < found["Sphere"].Radius + 0.1, "as the viewer sees the sphere"
    assert filler.DefectRegion.SMProxy.GetXMLName() == "None", "nothing is applied yet"
    # arrays count, too: where all is the defect no bone is left to fill from
    window.press("propertiesPanel/AdvancedButton")
    window.choose(lacuna_window.PANEL + "DefectArray/ComboBox", "Depth")
    window.wait_for("no marks", lambda: not lacuna.window._marks)
    window.choose(lacuna_window.PANEL + "DefectArray/ComboBox", "None")
    window.wait_for("the marks again", lambda: lacuna.window._marks)
    window.press("propertiesPanel/AdvancedButton")

    # P puts the sphere's middle on the bone under the mouse, in the patient's millimetres
    direction = np.array([-0.3, -0.5, 0.8]) / np.linalg.norm([-0.3, -0.5, 0.8])
    bone = direction * truth.IntersectOuterSurface([0, 0, 0], direction)
    renderer = view.GetRenderer()
    renderer.SetWorldPoint(*bone, 1)
    renderer.WorldToDisplay()
    column, row = renderer.GetDisplayPoint()[:2]
    width, height = view.GetRenderWindow().GetSize()
    wide, high = (float(window.get(lacuna_window.VIEW, attribute)) for attribute in ("width", "height"))
    window.point(column * wide / width, high - row * high / height)
    window.key(ord("P"))
    center = [float(window.get(f"{lacuna_window.PANEL}DefectRegion/center{axis}")) for axis in "XYZ"]
    assert np.linalg.norm(np.array(center) - bone) < 4, (center, bone)

    window.choose(lacuna_window.PANEL + "DefectRegion/comboBox", "Automatic (all enclosed holes)")
    window.press(lacuna_window.ACCEPT)
    assert not lacuna.window._marks
    assert GetDisplayProperties(filler, view).Representation == "Relief in Space"
    drag(window, "LacunaSlider_SupportMargin", 10)
    assert filler.SupportMargin > 12
    SetActiveSource(phantom)
    window.wait(100)
    assert window.get("LacunaSliders", "visible") == "false"

    # The guide, by the button of the panel
    SetActiveSource(filler)
    window.wait(100)
    window.press("propertiesPanel/Help")
    assert window.get("LacunaGuide", "visible") == "true"
    assert window.get("LacunaGuide/Pages", "source").endswith("/rbf-hole-filler.md")
    assert len(window.get("LacunaGuide/Pages", "plainText")) > 5000
    window.check_messages()


lacuna_window.main(test)
