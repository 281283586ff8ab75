# SPDX-License-Identifier: BSD-3-Clause
"""Both main jobs and the questions of new users in the ParaView application, by mouse and by words that are seen alone.

Each session begins with a fresh window. Without files of yours (LACUNA_CLICKS_CT, LACUNA_CLICKS_SWEEP) they are those of phantoms.
LACUNA_CLICKS: a folder for the pictures, the clicks and the answers (Testing/Tools/clicks.py makes a page of them).
"""
import json
import os
import shutil
import sys

import lacuna_window

SESSIONS = "ct", "sweep", "bone", "hole", "calibrate", "live"
FOLDER = os.environ.get("LACUNA_CLICKS")
QUESTION_MARK = "propertiesPanel/Help", "?"
SKULL, SWEEP, SOLID = "skull", "sweep.igs.mha", "implant.stl"


class Session:
    """What is done and asked in one window."""

    def __init__(self, screen):
        self.screen, self.answers = screen, []

    def open(self, name):
        yield from self.screen.click("File")
        yield from self.screen.click("Open")
        yield from self.screen.click(name)
        yield from self.screen.click("OK")
        if self.screen.sees("Set reader as default"):  # several readers; Lacuna's is marked
            yield from self.screen.click("OK")
        yield from self.screen.click("Apply")

    def answer(self, question, since, *seen):
        """A question is answered by what is seen now. since: how many clicks there were before; seen: words, or whether it is seen."""
        for each in seen:
            assert self.screen.words_of(each) if isinstance(each, str) else each, f"{question} {each} is not seen in:\n{self.screen.words()}"
        clicks = self.screen.clicks[since:]
        self.answers.append([question, " > ".join(words for words, _ in clicks), len(clicks), sum(seconds for _, seconds in clicks)])
        print(f"{question} {len(clicks)} clicks, {self.answers[-1][3]:.1f} s", file=sys.__stdout__, flush=True)


def texts():
    """What the active view says: letters at its edges, facts, titles of colours."""
    from lacuna.data import fetch
    from paraview.simple import GetActiveView
    found = []
    for each in GetActiveView().Representations:
        if not each.Visibility:
            continue
        if each.GetProperty("Title"):
            found.append(each.Title)
        elif each.GetProperty("WindowLocation") and each.Input is not None:
            table = fetch(each.Input)
            found += [table.GetValue(row, 0).ToString() for row in range(table.GetNumberOfRows())] if table.IsA("vtkTable") else []
    from lacuna import views
    for marks, _camera, _tag in views._marked.values():
        found += [source.Text for source, _ in marks.values()]
    return found


def ct(session):
    from paraview.simple import GetActiveSource
    screen = session.screen
    yield from session.open(next(name for name in os.listdir(".") if name.startswith(SKULL)))
    session.answer("How do I open my CT?", 0, GetActiveSource().GetDataInformation().GetNumberOfPoints() > 1000)
    count = len(screen.clicks)
    session.answer("Which side is left?", count, "L" in texts())
    yield from screen.click("Lacuna")
    yield from screen.click("CT to Implant")
    facts = " ".join(texts())
    session.answer("How do I get an implant?", count, GetActiveSource().GetXMLName() == "LacunaSkullImplant")
    count = len(screen.clicks)
    session.answer("How large are hole and implant, in millilitres?", count, " ml" in facts and "cm^2" in facts)
    session.answer("How thick is the implant?", count, " mm thick" in facts)
    session.answer("How exact is it?", count, "RMS" in facts and "predicted error" in facts)
    session.answer("Where is the level of bone?", count, "Level (HU)")
    yield from screen.click("Lacuna")
    yield from screen.click("Save Solid (STL, PLY, 3MF, STEP)")
    yield from screen.type(SOLID)
    yield from screen.click("OK")
    session.answer("How do I print it (STL, 3MF)?", count, os.path.getsize(SOLID) > 10000 and os.path.exists(SOLID + ".json"))
    screen.end()
    assert len(screen.clicks) <= 12, screen.clicks
    count = len(screen.clicks)
    yield from screen.click(*QUESTION_MARK)
    session.answer("What does this setting mean?", count, "EdgeClearance")


def sweep(session):
    from paraview.simple import GetActiveSource
    screen = session.screen
    yield from session.open(SWEEP)
    count = len(screen.clicks)
    yield from screen.click("Lacuna")
    yield from screen.click("Sweep to Surface")
    session.answer("How do I get a surface of my sweep?", 0, GetActiveSource().GetXMLName() == "Contour", "Level")
    screen.end()
    assert len(screen.clicks) <= 12, screen.clicks
    count, before = len(screen.clicks), GetActiveSource().Isosurfaces[0]
    yield from screen.slide("LacunaSlider_ContourValues", "the slider Level")
    session.answer("The surface is too thick or too thin.", count, GetActiveSource().Isosurfaces[0] != before)


def bone(session):
    """Of a sweep of yours alone: the phantom has no bone."""
    from paraview.simple import GetActiveSource
    screen = session.screen
    yield from session.open(SWEEP)
    yield from screen.click("Lacuna")
    yield from screen.click("Sweep to Bone")
    session.answer("How do I get the bone in my sweep, without gel and skin?", 0, GetActiveSource().GetXMLName() == "Contour")
    screen.end()
    assert len(screen.clicks) <= 12, screen.clicks


def hole(session):
    import lacuna.window
    screen = session.screen
    yield from screen.click("Lacuna")
    yield from screen.click("Sample CT: Skull with a Hole")
    count = len(screen.clicks)
    yield from screen.click("Lacuna")
    yield from screen.click("Skull and implant")
    yield from screen.click("Depth map of a skull: B-Spline Iso Ray Caster")
    yield from screen.click("Apply")
    yield from screen.click("Lacuna")
    yield from screen.click("Skull and implant")
    yield from screen.click("Fill a hole of a depth map: RBF Hole Filler")
    session.answer("How do I mark a hole?", count, "Defect Region", bool(lacuna.window._marks))
    screen.end()


def calibrate(session):
    screen = session.screen
    yield from screen.click("Lacuna")
    yield from screen.click("Sample Sweep: Ultrasound")
    count = len(screen.clicks)
    yield from screen.click("Lacuna")
    yield from screen.click("Ultrasound")
    yield from screen.click("Where pixels lie: Probe Calibration")
    yield from screen.click(*QUESTION_MARK)
    session.answer("How do I calibrate the probe?", count, "Probe Calibration")
    screen.end()


def live(session):
    screen = session.screen
    yield from screen.click("Lacuna")
    yield from screen.click("Live Layout")
    session.answer("How do I scan with a tracker, and record?", 0, "Tracker Connection", "Start")
    screen.end()


def test(window):
    import lacuna_clicks
    name = os.environ["LACUNA_CLICKS_SESSION"]
    window.resize(*lacuna_clicks.WINDOW)
    screen = lacuna_clicks.Screen(window, FOLDER and os.path.join(FOLDER, name))
    session = Session(screen)
    streams, (sys.stdout, sys.stderr) = (sys.stdout, sys.stderr), window.streams  # what is printed goes where a user sees it
    try:
        screen.run(lambda _: globals()[name](session))
    finally:
        sys.stdout, sys.stderr = streams
        for number, (words, seconds) in enumerate(screen.clicks, 1):
            print(f"{number:2} {seconds:5.1f} s  {words}", flush=True)
    window.take_messages()
    if FOLDER:
        with open(os.path.join(FOLDER, name, "answers.json"), "w", encoding="utf-8") as file:
            json.dump(session.answers, file, indent=1)


def prepare(folder):
    """The files that a user has: those of yours, or of phantoms."""
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    given = [os.environ.get("LACUNA_CLICKS_" + name) for name in ("CT", "SWEEP")]
    if not all(given):
        import lacuna.plugin
        lacuna.plugin.load()
        from paraview.simple import PhantomSweep, SaveData, SkullPhantom
    if given[0]:
        shutil.copy(given[0], os.path.join(folder, SKULL + os.path.splitext(given[0])[1]))
    else:
        SaveData(os.path.join(folder, SKULL + ".vti"), proxy=SkullPhantom(Spacing=[2, 2, 2]), DataMode="Binary")
    if given[1]:
        shutil.copy(given[1], os.path.join(folder, SWEEP))
        for name in os.listdir(os.path.dirname(given[1])):
            if name.endswith(".xml"):  # its calibration
                shutil.copy(os.path.join(os.path.dirname(given[1]), name), folder)
    else:
        SaveData(os.path.join(folder, SWEEP), proxy=PhantomSweep(NumberOfSlices=30, ImageSize=[160, 120], PixelSpacing=0.4))


if lacuna_window.IS_INSIDE:
    lacuna_window.inside(test)
else:
    place = os.path.join(os.path.abspath(os.environ["LACUNA_TEST_OUTPUT"]), "WindowClicks")
    prepare(place)
    os.chdir(place)
    for session_name in os.environ.get("LACUNA_CLICKS_ONLY", " ".join(SESSIONS)).split():
        if session_name == "bone" and not os.environ.get("LACUNA_CLICKS_SWEEP"):
            continue
        lacuna_window.run(os.path.join(os.path.dirname(os.path.abspath(lacuna_window.__file__)), "WindowClicks.py"), seconds=1800,
                          LACUNA_CLICKS_SESSION=session_name)
    print("ok")
