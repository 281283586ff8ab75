# SPDX-License-Identifier: BSD-3-Clause
"""Tests in the ParaView application: starts it with a script, and lets that press, look and wait.

    if lacuna_window.IS_INSIDE: test(lacuna_window.Window())
    else: lacuna_window.run(__file__)
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
F9 = 0x01000038  # of Qt::Key


def run(script, seconds=600, **environment):
    """Runs paraview with the script; returns what it has printed. Without a display the test is skipped."""
    if not os.environ.get("DISPLAY"):
        print("skipped: the application needs a display")
        sys.exit(77)
    command = [os.environ["LACUNA_PARAVIEW"], "--dr", "--script=" + os.path.abspath(script)]
    environment = {**os.environ, **environment, INSIDE: "1", "QT_LOGGING_RULES": "*.debug=false"}
    with tempfile.TemporaryFile("w+") as file:
        try:
            status = subprocess.run(command, stdout=file, stderr=subprocess.STDOUT, timeout=seconds, env=environment,
                                    check=False).returncode
        finally:
            file.seek(0)
            said = file.read()
            print(said, flush=True)
    assert status == 0 and "ERR|" not in said, status
    return said


def inside(test):
    """Runs test(window) in paraview and ends it."""
    status = 1
    sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__  # not to ParaView's messages
    try:
        test(Window())
        status = 0
    except BaseException:
        traceback.print_exc()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


class Window:
    """The main window; names are those of Qt's objects, "panel/Accept" is an Accept within a panel."""

    def __init__(self):
        self.library = ctypes.PyDLL(os.environ["LACUNA_WINDOW"])
        self.library.lacuna_get.restype = ctypes.c_char_p
        self.begin = time.monotonic()
        self.wait(500)

    def wait(self, milliseconds):
        self.library.lacuna_wait(milliseconds)

    def get(self, name, attribute="text"):
        value = self.library.lacuna_get(name.encode(), attribute.encode())
        assert value is not None, f"nothing is called {name}, or has no {attribute}"
        return value.decode()

    def press(self, name):
        assert self.library.lacuna_press(name.encode()), f"{name} is not there or disabled"
        self.wait(50)

    def choose(self, name, text):
        assert self.library.lacuna_choose(name.encode(), text.encode()), f"{name} has no {text}"
        self.wait(50)

    def key(self, code, repeats=0):
        assert self.library.lacuna_key(code, repeats)
        self.wait(50)

    def resize(self, width, height):
        self.library.lacuna_resize(width, height)
        self.wait(500)

    def save(self, path):
        assert self.library.lacuna_save(path.encode()), path

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
