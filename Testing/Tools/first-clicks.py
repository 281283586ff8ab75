#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Renews the pictures of Documentation/UserGuide/first-clicks.md: does both jobs in ParaView's window by mouse.

    . build/release/lacuna-env.sh; Testing/Tools/first-clicks.py [folder for the pictures, default: the guide's]

Needs xdotool, imagemagick and xvfb. The places of the clicks are those of Debian 12's ParaView in a window of
1300 x 870 pixels. Fails when a job needs more clicks than the page says, or says anything in Output Messages.
"""
import contextlib
import os
import re
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
PICTURES = os.path.join(HERE, "..", "..", "Documentation", "UserGuide", "pictures")
SIZE = 1300, 870
MAKE = """
import lacuna.plugin
lacuna.plugin.load()
from paraview.simple import *
SaveData("skull.vti", proxy=SkullPhantom(), DataMode="Binary")
SaveData("sweep.igs.mha", proxy=PhantomSweep(SpeckleLevel=0.2))
"""
OPEN, APPLY, MENU = (28, 42), (49, 462), (506, 12)
IMPLANT, SURFACE, SAVE_SOLID = (560, 36), (560, 112), (560, 188)  # entries of the menu
FIRST_FILE, SECOND_FILE, DIALOG_OK = (515, 267), (520, 286), (930, 541)
WINDOW, DIALOG = (0, 0, 1300, 870), (0, 0, 990, 600)


def run(*command, **options):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, **options).stdout


class Job:
    """ParaView, clicked at."""

    def __init__(self, name, folder, data):
        self.name, self.folder, self.clicks, self.marks = name, folder, 0, []
        self.log = tempfile.TemporaryFile("w+", encoding="utf-8")
        self.paraview = subprocess.Popen(["paraview", "--disable-registry"], cwd=data, stdout=self.log, stderr=subprocess.STDOUT,
                                         env={**os.environ, "HOME": data, "QT_LOGGING_RULES": "*.debug=false"})
        for _ in range(120):
            time.sleep(1)
            found = subprocess.run(["xdotool", "search", "--onlyvisible", "--name", "^ParaView 5"], stdout=subprocess.PIPE, text=True, check=False)
            if found.stdout:
                break
        time.sleep(8)
        for window in found.stdout.split() * 2:
            run("xdotool", "windowsize", "--sync", window, *map(str, SIZE))
            run("xdotool", "windowmove", window, "0", "0")
        self.settle()

    def settle(self):
        """Until nothing is computed and nothing moves for 6 seconds."""
        before, still = None, 0
        for _ in range(120):
            ticks = self.ticks()
            time.sleep(1)
            busy = self.ticks() - ticks > 5
            now = subprocess.run("import -window root -depth 8 rgb:- | md5sum", shell=True, stdout=subprocess.PIPE, check=True).stdout
            still = still + 1 if now == before and not busy else 0
            if still == 6:
                return
            before = now

    def ticks(self):
        """Hundredths of a second of the processor's time."""
        with open(f"/proc/{self.paraview.pid}/stat", encoding="ascii") as file:
            return sum(map(int, file.read().split()[13:15]))

    def click(self, place):
        self.clicks += 1
        self.marks.append((*place, self.clicks))
        run("xdotool", "mousemove", *map(str, place))
        time.sleep(0.3)
        run("xdotool", "click", "1")
        run("xdotool", "mousemove", str(SIZE[0] + 40), "800")  # no tool tip in the pictures
        self.settle()

    def drag(self, start, end):
        run("xdotool", "mousemove", *map(str, start), "mousedown", "1")
        for i in range(1, 9):
            run("xdotool", "mousemove", *(str(a + (b - a) * i // 8) for a, b in zip(start, end)))
            time.sleep(0.1)
        run("xdotool", "mouseup", "1")
        self.settle()

    def type(self, text):
        run("xdotool", "type", "--delay", "40", text)
        time.sleep(2)  # it never settles: the cursor blinks

    def picture(self, name, area, *coming, percent=60):
        """What is seen now, with the numbers of the clicks since the last picture and of those to come."""
        marks = self.marks + [(*place, self.clicks + 1 + i) for i, place in enumerate(coming)]
        self.marks = []
        left, top, width, height = area
        draw = []
        for x, y, number in marks:
            x, y = x - left + 20, y - top + 12
            if not (0 <= x < width and 0 <= y < height):
                continue
            draw += ["-fill", "#d8321f", "-stroke", "white", "-strokewidth", "2", "-draw", f"circle {x},{y} {x + 13},{y}", "-stroke", "none",
                     "-fill", "white", "-pointsize", "16", "-draw", f"text {x - (9 if number > 9 else 5)},{y + 6} '{number}'"]
        path = os.path.join(self.folder, f"first-clicks-{self.name}-{name}.png")
        run("import", "-window", "root", "-crop", f"{width}x{height}+{left}+{top}", "+repage", path)
        run("convert", path, *draw, "-resize", f"{percent}%", "-colors", "96", "-strip", f"PNG8:{path}")
        assert os.path.getsize(path) < 60000, (path, os.path.getsize(path))

    def end(self, clicks):
        self.paraview.terminate()
        self.paraview.wait()
        self.log.seek(0)
        said = re.findall(r".*(?:WARN|ERR)\|.*", self.log.read())
        assert not said, said
        assert self.clicks == clicks, f"{self.name}: {self.clicks} clicks"
        print(f"{self.name}: {self.clicks} clicks")


def ct_to_implant(folder, data):
    job = Job("ct", folder, data)
    job.click(OPEN)
    job.picture("1-open", DIALOG, FIRST_FILE, DIALOG_OK, percent=50)
    job.click(FIRST_FILE)
    job.click(DIALOG_OK)
    job.click(APPLY)
    job.marks = []
    job.click(MENU)
    job.picture("2-menu", WINDOW, IMPLANT, percent=45)
    job.click(IMPLANT)
    job.marks = []
    job.picture("3-implant", WINDOW, percent=45)
    job.click(MENU)
    job.click(SAVE_SOLID)
    job.marks = []
    job.type("implant.stl")
    job.picture("4-save", DIALOG, DIALOG_OK, percent=50)
    job.click(DIALOG_OK)
    job.end(9)
    assert os.path.getsize(os.path.join(data, "implant.stl")) > 10000


def sweep_to_surface(folder, data):
    job = Job("sweep", folder, data)
    job.click(OPEN)
    job.click(SECOND_FILE)
    job.click(DIALOG_OK)
    job.click(APPLY)
    job.marks = []
    job.click(MENU)
    job.picture("1-menu", WINDOW, SURFACE, percent=45)
    job.click(SURFACE)
    job.marks = []
    job.picture("2-surface", WINDOW, percent=45)
    job.end(6)


def main(folder=PICTURES):
    folder = os.path.abspath(folder)
    os.makedirs(folder, exist_ok=True)
    with tempfile.TemporaryDirectory() as data, contextlib.ExitStack() as stack:
        subprocess.run(["pvpython", "-c", MAKE], cwd=data, check=True, stdout=subprocess.DEVNULL)
        display = f":{next(n for n in range(150, 600) if not os.path.exists(f'/tmp/.X{n}-lock'))}"
        server = subprocess.Popen(["Xvfb", display, "-screen", "0", "1400x900x24", "-noreset"], stderr=subprocess.DEVNULL)
        stack.callback(server.terminate)
        os.environ["DISPLAY"] = display
        time.sleep(2)
        ct_to_implant(folder, data)
        for name in "implant.stl", "implant.stl.json":
            os.remove(os.path.join(data, name))
        sweep_to_surface(folder, data)


if __name__ == "__main__":
    main(*sys.argv[1:])
