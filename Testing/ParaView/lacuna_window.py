# SPDX-License-Identifier: BSD-3-Clause
"""Tests in the ParaView application: starts it with a script, and lets that press, look and wait.

    lacuna_window.main(test)  # calls test(window)

or, where something is to be prepared outside of ParaView,

    if lacuna_window.IS_INSIDE: lacuna_window.inside(test)
    else: lacuna_window.run(__file__)

The test fails when there is a warning or an error in the window Output Messages, or a dialog that it does not expect.
"""
import ctypes
import os
import re
import subprocess
import sys
import tempfile
import time
import traceback

INSIDE = "LACUNA_INSIDE_PARAVIEW"
IS_INSIDE = INSIDE in os.environ
RENEW = "LACUNA_RENEW_BASELINES"
BASELINES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "Baselines")
F9 = 0x01000038  # of Qt::Key
VIEW = "MultiViewWidget/Viewport"
ACCEPT = "propertiesPanel/Accept"
PANEL = "propertiesPanel/PropertiesFrame/"


def run(script, seconds=600, expected=None, **environment):
    """Runs paraview with the script; returns what it has printed. Without a display the test is skipped.

    expected: a part of the only error that may be printed; the script takes it from the messages, too.
    """
    if not os.environ.get("DISPLAY"):
        print("skipped: the application needs a display")
        sys.exit(77)
    command = [os.environ["LACUNA_PARAVIEW"], "--dr", "--script=" + os.path.abspath(script)]
    with tempfile.TemporaryFile("w+") as file, tempfile.TemporaryDirectory(prefix="lacuna-home-") as home:
        environment = {**os.environ, **environment, INSIDE: "1", "QT_LOGGING_RULES": "*.debug=false",
                       "HOME": home, "XDG_CONFIG_HOME": home}  # nobody's macros and settings
        try:
            status = subprocess.run(command, stdout=file, stderr=subprocess.STDOUT, timeout=seconds, env=environment,
                                    check=False).returncode
        finally:
            file.seek(0)
            said = file.read()
            print(said, flush=True)
    errors = [line for line in said.splitlines() if "ERR|" in line and not (expected and expected in line)]
    assert status == 0 and not errors, (status, errors)
    return said


def leave(*error):
    """Ends the application after an error outside of test, with which it would stay open."""
    sys.__stdout__.write("".join(traceback.format_exception(*error)))
    sys.__stdout__.flush()
    os._exit(1)


if IS_INSIDE:
    sys.excepthook = leave


def main(test, expected=""):
    """Runs the script of test in paraview, and there test(window), which prints no warning without the words expected."""
    if IS_INSIDE:
        inside(test)
    said = run(test.__code__.co_filename)  # paraview's scripts have no __file__
    check_warnings(said, expected)
    print("ok")


def check_warnings(said, expected=""):
    """No warning without the words expected, but for what Mesa's compiler says of the shaders of VTK 9.6."""
    warnings = [line for line in said.splitlines() if "WARN|" in line and not (expected and expected in line)
                and not ("SHADER_COMPILER" in line and "g_dataPos" in line)]
    assert not warnings, warnings


def inside(test):
    """Runs test(window) in paraview and ends it."""
    status = 1
    streams = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__  # not to ParaView's messages
    try:
        from paraview.simple import GetSettingsProxy
        GetSettingsProxy("ColorPalette").Background = [0.32, 0.34, 0.43]  # that of the baselines; ParaView 6 has another
        window = Window()
        window.streams = streams
        test(window)
        window.check_messages()
        status = 0
    except BaseException:
        traceback.print_exc()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


class Window:
    """The main window, or the dialog that is open. Names are those of Qt's objects (describe tells them), "panel/Accept" is an Accept in a panel."""

    def __init__(self):
        self.library = ctypes.PyDLL(os.environ["LACUNA_WINDOW"])
        for name in ("get", "describe", "entries", "messages", "unexpected"):
            getattr(self.library, "lacuna_" + name).restype = ctypes.c_char_p
        self.begin = time.monotonic()
        self.handlers = []
        self.failures = []
        self.call = ctypes.CFUNCTYPE(None)(self.handle_dialog)
        self.wait(500)
        self.library.lacuna_watch()

    def wait(self, milliseconds):
        self.library.lacuna_wait(milliseconds)
        self.check_dialogs()

    def describe(self, name=""):
        """Classes and names of what is seen in it, for whoever writes a test."""
        return self.library.lacuna_describe(name.encode()).decode()

    def get(self, name, attribute="text"):
        value = self.library.lacuna_get(name.encode(), attribute.encode())
        assert value is not None, f"nothing is called {name}, or has no {attribute}"
        return value.decode()

    def press(self, name, *dialogs):
        """Presses a button; dialogs: functions of no arguments, each for a dialog that then comes up."""
        pending = self.expect(dialogs)
        assert self.library.lacuna_press(name.encode()), f"{name} is not there or disabled"
        self.finish(pending)

    def has_menu(self, path):
        """Whether the menus have it, as "Filters/Lacuna/Mirror", and it can be chosen."""
        found = self.library.lacuna_menu_has(path.encode())
        assert found, f"there is no menu {path}"
        return found == 2

    def menu(self, path, *dialogs):
        assert self.has_menu(path), f"{path} is disabled"
        pending = self.expect(dialogs)
        self.library.lacuna_menu(path.encode())
        self.finish(pending)

    def entries(self, name):
        """What a list offers."""
        return self.library.lacuna_entries(name.encode()).decode().splitlines()

    def choose(self, name, text):
        assert self.library.lacuna_choose(name.encode(), text.encode()), f"{name} has no {text}, but {self.entries(name)}"
        self.wait(50)

    def select(self, name, text):
        """Selects what is called so in a list or tree, as in the "pipelineBrowser"."""
        assert self.library.lacuna_select(name.encode(), text.encode()), f"{name} has no {text}, but {self.entries(name)}"
        self.wait(50)

    def type(self, name, text):
        """Types a text instead of what is in the field."""
        assert self.library.lacuna_type(name.encode(), str(text).encode()), f"{name} is no field, or not seen"
        self.wait(50)

    def paste(self, name, text):
        """As type(), from the clipboard: letters of any language, and no completions."""
        assert self.library.lacuna_paste(name.encode(), text.encode()), f"{name} is not there, disabled, or no field"

    def key(self, code, repeats=0):
        assert self.library.lacuna_key(code, repeats)
        self.wait(50)

    def apply(self):
        """Presses Apply, and looks whether there is a complaint."""
        self.press(ACCEPT)
        self.check_messages()

    def drag(self, places, name=VIEW):
        """Drags the mouse from the first place to the last; pixels from the widget's upper left corner."""
        library, name = self.library, name.encode()
        places = [(round(x), round(y)) for x, y in places]
        assert library.lacuna_mouse(name, *places[0], 3), name
        self.wait(50)
        library.lacuna_mouse(name, *places[0], 0)
        for (x, y), (u, v) in zip(places, places[1:]):
            for k in range(1, 6):
                library.lacuna_mouse(name, round(x + (u - x) * k / 5), round(y + (v - y) * k / 5), 1)
                self.wait(20)
        library.lacuna_mouse(name, *places[-1], 2)
        self.wait(100)

    def point(self, x, y, name=VIEW):
        """Moves the mouse there; pixels from the widget's upper left corner."""
        assert self.library.lacuna_mouse(name.encode(), round(x), round(y), 3), name
        self.wait(50)

    def open_file(self, path, reader=None):
        """File > Open, by this reader in the list of readers, which comes up when there are several."""
        def choose_reader():
            self.select("listWidget", reader)
            self.press("okButton")
        self.menu("File/Open...", lambda: self.choose_file(path), *[choose_reader] * bool(reader))

    def save_file(self, path, kind, *dialogs):
        """File > Save Data, in the format whose entry begins so; dialogs: of the options, mostly one with OK."""
        self.menu("File/Save Data...", lambda: self.choose_file(path, kind), *dialogs)

    def choose_file(self, path, kind=None):
        """What is done in ParaView's file dialog."""
        if kind:
            formats = self.entries("EntityType")
            found = [entry for entry in formats if entry.startswith(kind)]
            assert len(found) == 1, (kind, formats)
            self.choose("EntityType", found[0])
        self.type("EntityName", path)
        self.press("OK")

    def resize(self, width, height):
        self.library.lacuna_resize(width, height)
        self.wait(500)

    def resize_view(self, width, height):
        """Gives the active view this size, whatever toolbars, fonts and versions of ParaView leave of the window."""
        from paraview.simple import GetActiveView
        view, window = GetActiveView(), [width + 308, height + 235]
        for _ in range(3):
            self.resize(*window)
            if list(view.ViewSize) == [width, height]:
                return
            window = [window[k] + size - view.ViewSize[k] for k, size in enumerate((width, height))]
        raise AssertionError(f"the view has {list(view.ViewSize)} pixels instead of {width} x {height}")

    def look_from_above(self):
        """The active view without letters, seen as ParaView's: a new ray caster takes its direction and what is up."""
        from lacuna import views
        from paraview.simple import GetActiveView
        view = GetActiveView()
        views.hide_orientation(view)
        view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, 0, 500], [0, 0, 0], [0, 1, 0]

    def save(self, path, name=""):
        """A picture of a widget, or of the whole window."""
        assert self.library.lacuna_save(name.encode(), path.encode()), path

    def compare(self, baseline, name=VIEW, difference=4, likeness=0.95):
        """Compares a picture of a widget with Baselines/<baseline>.png, or writes that (environment LACUNA_RENEW_BASELINES)."""
        from window_pictures import compare
        self.wait(300)
        path, expected = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], baseline + ".png"), os.path.join(BASELINES, baseline + ".png")
        self.save(path, name)
        compare(path, expected, difference, likeness, RENEW in os.environ)

    def wait_for(self, what, condition, seconds=60):
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, f"not within {seconds} s: {what}"
            self.wait(20)
        print(f"{time.monotonic() - self.begin:6.1f} s: {what}", flush=True)

    def wait_for_text(self, name, pattern, attribute="text"):
        try:
            self.wait_for(f"{name}: {pattern}", lambda: re.search(pattern, self.get(name, attribute)))
        except AssertionError as error:
            raise AssertionError(f"{error}; it is {self.get(name, attribute)!r}") from None

    def check_messages(self):
        said = self.library.lacuna_messages().decode()
        assert not said, f"the window Output Messages says:\n{said}"

    def take_messages(self):
        """What the window Output Messages says; it is empty then."""
        said = self.library.lacuna_messages().decode()
        self.library.lacuna_press(b"outputWidgetDock/clearButton")
        return said

    def expect(self, dialogs):
        """Handlers of the next dialogs; returns how many were expected before."""
        pending = len(self.handlers)
        self.handlers[:0] = dialogs
        self.library.lacuna_expect(self.call if self.handlers else None)
        return pending

    def handle_dialog(self):
        handler = self.handlers.pop(0)
        if self.handlers:
            self.library.lacuna_expect(self.call)
        try:
            handler()
        except BaseException as error:  # not through Qt
            self.failures.append(error)
            self.handlers.clear()
            self.library.lacuna_expect(None)
            self.library.lacuna_reject()

    def finish(self, pending):
        """The dialogs that were expected have come and gone."""
        end = time.monotonic() + 10
        while len(self.handlers) > pending:
            assert time.monotonic() < end, "an expected dialog did not come up"
            self.wait(50)
        self.wait(50)

    def check_dialogs(self):
        if self.failures:
            raise self.failures.pop()
        words = self.library.lacuna_unexpected().decode()
        assert not words, f"a dialog that was not expected: {words}"
