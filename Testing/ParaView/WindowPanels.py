# SPDX-License-Identifier: BSD-3-Clause
"""What panels of the ParaView application say and do: units, what 0 means, empty fields, sliders, places of regions, and the guide."""
import lacuna_window

ADVANCED = "propertiesPanel/AdvancedButton"


def drag(window, name, steps):
    """Drags the handle of a slider by so many pixels."""
    width, height, value = (float(window.get(name, attribute)) for attribute in ("width", "height", "value"))
    handle = 5 + (width - 10) * value / 400
    window.drag([(handle, height / 2), (handle + steps, height / 2)], name)


def test(window):
    import numpy as np
    from paraview import servermanager
    from paraview.simple import GetActiveSource, GetActiveView, SetActiveSource
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
    window.press(lacuna_window.ACCEPT)
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
