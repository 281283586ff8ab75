# SPDX-License-Identifier: BSD-3-Clause
"""The places that messages of Lacuna's filters name are marked in the view, and are no longer once they are mended."""
import lacuna_window
from lacuna_window import PANEL


def check_texts():
    """Which words are places: not those of a way to go, of another frame or of a range of slices."""
    from lacuna import places
    points, voxels, slices = places.find("The least certain place is (186.8, 124.0, 66.6) mm, 20 mm away; most at (1, -2.5, 3e1) mm, near 4 5 6 mm")
    assert points == [((186.8, 124, 66.6), "(186.8, 124.0, 66.6) mm"), ((1, -2.5, 30), "(1, -2.5, 3e1) mm"), ((4, 5, 6), "(4, 5, 6) mm")], points
    assert not voxels and not slices
    assert places.find("move it by at least (1, 2, 3) mm") == [[], [], []]
    assert places.find("near (1, 2, 3) mm of the transmitter")[0] == []
    assert places.find("not finite at voxel (1, 2, 3)")[1] == [(1, 2, 3)]
    assert places.find("2 of 9 slices are faster than 5 mm/s: slices 3, 5, 7 to 9 and 4 more")[2] == [3, 5, 7, 9]
    assert places.find("slice 12: its pose is an outlier")[2] == [12]
    assert places.find("the sweep has slices 0 to 20")[2] == []


def test(window):
    import numpy as np
    from lacuna import places
    from paraview.simple import Delete, GetActiveSource, GetActiveView, GetSources

    check_texts()
    window.resize_view(992, 665)

    # slices: too fast ones, then none
    window.menu("Lacuna/Sample Sweep: Ultrasound")
    view = GetActiveView()
    hidden = view.SMProxy.GetProperty("HiddenRepresentations")
    sources = len(GetSources())
    window.menu("Lacuna/Ultrasound/Slices as pictures in space: Slice Planes")
    planes = GetActiveSource()
    window.choose(PANEL + "ColorBy/ComboBox", "Speed")
    window.type(PANEL + "SpeedLimit/DoubleLineEdit0", 1)
    window.press(lacuna_window.ACCEPT)
    said = window.take_messages()
    assert "faster than" in said, said
    marks = places._marks[planes.SMProxy.GetGlobalID()]
    assert marks, said
    assert len(GetSources()) == sources + 1, f"marks are in the pipeline browser: {list(GetSources())}"
    assert hidden.GetNumberOfProxies() == len(marks)
    corners = np.reshape(marks[0][1].Points, (4, 3))
    low, high = np.array(planes.GetDataInformation().GetBounds()).reshape(3, 2).T
    assert (corners > low - 0.1).all() and (corners < high + 0.1).all() and np.ptp(corners, axis=0).max() > 20, "around a slice, in mm"
    window.compare("PlacesSlices", likeness=0.9)
    window.type(PANEL + "SpeedLimit/DoubleLineEdit0", 100000)
    window.apply()
    assert not places._marks and hidden.GetNumberOfProxies() == 0, "nothing is wrong any more"
    window.type(PANEL + "SpeedLimit/DoubleLineEdit0", 1)
    window.press(lacuna_window.ACCEPT)
    window.take_messages()
    assert places._marks
    Delete(planes)
    window.wait(100)
    assert not places._marks and hidden.GetNumberOfProxies() == 0, "its filter is gone"
    window.check_messages()


lacuna_window.main(test, "faster than")
