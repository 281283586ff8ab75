#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Both main jobs and the questions of new users, click by click: pictures and tables of Documentation/UserGuide/first-clicks.md and faq.md.

    . build/release/lacuna-env.sh
    Testing/Tools/clicks.py --ct SKULL.nrrd --sweep SWEEP.igs.mha [--rounds 2] [--out FOLDER] [--draw]

Does the sessions of Testing/ParaView/WindowClicks.py, each in a fresh ParaView, and takes the smallest seconds of the rounds: other work on
the machine only adds to them. --draw: makes pages and pictures of what is in FOLDER. --ct-of TOOL Cranium.inv3 CASE SKULL.nrrd makes such
a CT: the patient of Debian's package invesalius-examples, with a hole that the tool (implant_cases.py) cuts. Needs ImageMagick and xvfb.
"""
import argparse
import importlib.util
import json
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "..", "..")
GUIDE = os.path.join(ROOT, "Documentation", "UserGuide")
SESSIONS = "ct", "sweep", "bone", "hole", "calibrate", "live"
SHEETS = {"ct": 3, "sweep": 3, "bone": 3}  # columns
LIMIT = 300_000  # bytes of a picture


def cut(tool, project, case, path):
    """A CT of Cranium.inv3 with a hole, in NRRD that says how the patient lay: InVesalius has y to the front."""
    import numpy as np
    spec = importlib.util.spec_from_file_location("implant_cases", tool)
    cases = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(cases)
    with tempfile.TemporaryDirectory() as folder:
        whole, hole = os.path.join(folder, "whole.mha"), os.path.join(folder, "hole.mha")
        subprocess.run([sys.executable, tool, "skull", project, whole], check=True)
        subprocess.run([sys.executable, tool, "cut", whole, case, hole], check=True)
        grey, spacing, origin = cases.read_mha(hole)
    head = (f"NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: {' '.join(map(str, grey.shape[::-1]))}\n"
            f"space directions: ({spacing[0]:.9g},0,0) (0,{spacing[1]:.9g},0) (0,0,{spacing[2]:.9g})\n"
            f"space origin: ({','.join(f'{x:.9g}' for x in origin)})\nkinds: domain domain domain\nendian: little\nencoding: raw\n\n")
    with open(path, "wb") as file:
        file.write(head.encode() + np.ascontiguousarray(grey[:, ::-1], np.int16).tobytes())


def run(folder, options):
    environment = {**os.environ, "LACUNA_CLICKS": folder, "LACUNA_TEST_OUTPUT": folder, "OPENBLAS_CORETYPE": "Haswell",
                   "PYTHONPATH": os.pathsep.join([os.environ.get("PYTHONPATH", ""), os.path.join(ROOT, "Testing", "ParaView")]),
                   "LACUNA_PARAVIEW": "paraview", "LACUNA_WINDOW": options.window,
                   "LACUNA_CLICKS_CT": os.path.abspath(options.ct), "LACUNA_CLICKS_SWEEP": os.path.abspath(options.sweep)}
    subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 1600x1200x24 -noreset", sys.executable,
                    os.path.join(ROOT, "Testing", "ParaView", "WindowClicks.py")], env=environment, check=True)


def smallest(folders, session):
    """The clicks of a session and its answers with the smallest seconds of the rounds; None without them."""
    def read(name):
        return [json.load(open(os.path.join(folder, session, name), encoding="utf-8")) for folder in folders
                if os.path.exists(os.path.join(folder, session, name))]
    clicks, answers = read("clicks.json"), read("answers.json")
    if not clicks:
        return None, []
    return ([[each[0][0], min(seconds for _, seconds in each)] for each in zip(*clicks)],
            [[*each[0][:3], min(row[3] for row in each)] for each in zip(*answers)])


def sheet(folder, session, clicks, columns, path):
    """All pictures of a session on one, each with its number, words and seconds, and the last one large."""
    tiles = []
    for number, (words, seconds) in enumerate(clicks, 1):
        tiles += ["(", os.path.join(folder, session, f"{number:02}.png"), "-set", "label", f"{number}  {words}   {seconds:.1f} s", ")"]
    tiles += ["(", os.path.join(folder, session, "end.png"), "-set", "label", "what is seen then", ")"]
    whole = path + ".miff"
    subprocess.run(["montage", *tiles, "-tile", f"{columns}x", "-geometry", "440x+6+6", "-pointsize", "15", whole], check=True)
    for colors in (255, 128, 64, 32):
        subprocess.run(["convert", whole, "+dither", "-colors", str(colors), "-strip", f"PNG8:{path}"], check=True)
        if os.path.getsize(path) <= LIMIT:
            break
    os.remove(whole)
    end = path.replace(".png", "-end.png")
    subprocess.run(["convert", os.path.join(folder, session, "end.png"), "-resize", "900x", "-colors", "128", "-strip", f"PNG8:{end}"], check=True)
    for each in (path, end):
        assert os.path.getsize(each) <= LIMIT, (each, os.path.getsize(each))


def insert(page, name, lines):
    """Puts lines behind a mark of a page, up to the next empty one."""
    path = os.path.join(GUIDE, page)
    with open(path, encoding="utf-8") as file:
        text = file.read()
    mark = f"<!-- {name} -->\n"
    assert mark in text, (page, mark)
    text = re.sub(re.escape(mark) + r"(?:.+\n)*", lambda _: mark + "".join(line + "\n" for line in lines), text)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def draw(folders):
    questions = ["| question | clicks, by the words on the screen | number | seconds |", "|---|---|---|---|"]
    for session in SESSIONS:
        clicks, answers = smallest(folders, session)
        if clicks is None:
            continue
        questions += [f"| {question} | {words or 'it is seen then'} | {count} | {seconds:.1f} |" for question, words, count, seconds in answers]
        if session in SHEETS:
            sheet(folders[0], session, clicks, SHEETS[session], os.path.join(GUIDE, "pictures", f"first-clicks-{session}.png"))
            total = sum(seconds for _, seconds in clicks)
            insert("first-clicks.md", f"clicks {session}", ["| click | on | seconds until the view is ready |", "|---|---|---|"] + [
                f"| {number} | {words} | {seconds:.1f} |" for number, (words, seconds) in enumerate(clicks, 1)] + [f"| | together | {total:.0f} |"])
    insert("faq.md", "questions", questions)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ct")
    parser.add_argument("--sweep")
    parser.add_argument("--ct-of", nargs=4, metavar=("TOOL", "PROJECT", "CASE", "FILE"))
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--out", default="clicks")
    parser.add_argument("--window", default=os.path.join(ROOT, "build", "release", "lib", "libLacunaWindow.so"), help="the library of the tests")
    parser.add_argument("--draw", action="store_true")
    options = parser.parse_args()
    if options.ct_of:
        cut(*options.ct_of)
        return
    folders = [os.path.abspath(os.path.join(options.out, f"round-{number}")) for number in range(1, options.rounds + 1)]
    if not options.draw:
        for folder in folders:
            run(folder, options)
    draw(folders)


if __name__ == "__main__":
    main()
