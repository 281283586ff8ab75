# SPDX-License-Identifier: BSD-3-Clause
"""State files that are small enough to be kept, compared and sent.

    from lacuna import states
    states.save("sweep.pvsm")   # of all that is in the pipeline browser, and its views
    states.load("sweep.pvsm")   # in place of what is there

ParaView itself reads them, too: File > Load State.
"""
import os
import xml.etree.ElementTree as ElementTree


def save(path):
    """Writes the session as a ParaView state file (.pvsm) that says only what differs from the defaults.

    It has about a sixth of the size of ParaView's own. File names are kept as they were given to the readers.
    """
    import paraview.simple as pv
    from lacuna.files import writing
    for view in pv.GetViews():
        if pv.GetLayout(view) is None:  # ParaView's window shows none of these
            pv.AssignViewToLayout(view)
    with writing(path) as name:
        _write(name)


def _write(path):
    import paraview.simple as pv
    from lacuna.files import check_whole
    from paraview import servermanager
    pv.SaveState(path)
    check_whole(path)
    session = servermanager.ActiveConnection.Session
    tree = ElementTree.parse(path)
    for element in tree.getroot().iter("Proxy"):
        if element.get("id") is None:  # mentioned, not described
            continue
        proxy = session.GetRemoteObject(int(element.get("id")))
        for child in list(element.findall("Property")):
            if child.find(".//Proxy") is not None:
                _drop(child, [domain for domain in child.findall("Domain") if domain.find("Proxy") is None])
            elif _is_default(proxy.GetProperty(child.get("name")), child):
                element.remove(child)
            else:
                _drop(child, child.findall("Domain"))
    ElementTree.indent(tree, " ")
    tree.write(path, encoding="utf-8", xml_declaration=False)


def load(path):
    """Replaces the session by that of a state file; relative file names in it are of the state file's folder."""
    import paraview.simple as pv
    pv.ResetSession()
    before = os.getcwd()
    path = os.path.abspath(path)
    folder = os.path.dirname(path)
    os.chdir(folder)  # for what is looked for while it loads
    try:
        pv.LoadState(path)
        for source in pv.GetSources().values():  # readers open their files later, when they are updated
            _make_absolute(source, folder)
    finally:
        os.chdir(before)


def _make_absolute(source, folder):
    for name in source.ListProperties():
        files = source.GetProperty(name)
        if files is None or not files.SMProperty.FindDomain("vtkSMFileListDomain"):
            continue
        given = [files.GetElement(i) for i in range(files.GetNumberOfElements())]
        absolute = [os.path.join(folder, file) if file else file for file in given]
        if absolute != given:
            files.SetData(absolute if files.GetRepeatable() else absolute[0])
            source.SMProxy.UpdateVTKObjects()


def _is_default(known, element):
    if known is None:
        return False
    return not element.findall("Element") or known.IsValueDefault()


def _drop(parent, children):
    for child in children:
        parent.remove(child)
