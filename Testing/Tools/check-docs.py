#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Links of the documentation: every relative link and picture in a page leads to a file, every #anchor to a heading, and every picture under Documentation is shown by a page.

check-docs.py [folder]    the project's folder; default: this one
"""
import os
import re
import sys

ROOT = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
LINK = re.compile(r"""!?\[[^\]]*\]\(\s*<?([^)\s>]+)[^)]*\)|^\s*\[[^\]]+\]:\s*<?([^\s>]+)|(?:src|href)=["']([^"']+)["']""", re.MULTILINE)
PICTURES = (".png", ".jpg", ".jpeg", ".gif", ".svg")


def files():
    for folder, folders, names in os.walk(ROOT):
        folders[:] = [name for name in folders if not name.startswith(".") and not (folder == ROOT and name == "build")]
        for name in names:
            yield os.path.relpath(os.path.join(folder, name), ROOT)


def without_code(text):
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^(```|~~~).*?^\1", "", text, flags=re.MULTILINE | re.DOTALL))


def anchors(text):
    """As GitHub makes them of headings; the second of the same name ends in -1."""
    found = set()
    for heading in re.findall(r"^#{1,6}\s+(.*?)\s*#*$", re.sub(r"^(```|~~~).*?^\1", "", text, flags=re.MULTILINE | re.DOTALL), re.MULTILINE):
        name = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        name = re.sub(r"[^\w\- ]", "", name.lower()).replace(" ", "-")
        number, own = 0, name
        while own in found:
            number += 1
            own = f"{name}-{number}"
        found.add(own)
    return found


everything = sorted(files())
texts = {}
for page in everything:
    if page.endswith(".md"):
        with open(os.path.join(ROOT, page), encoding="utf-8") as file:
            texts[page] = file.read()
problems = []
led_to = set()
for page, text in texts.items():
    for match in LINK.finditer(without_code(text)):
        link = next(group for group in match.groups() if group)
        if re.match(r"[A-Za-z][A-Za-z0-9+.-]*:|//", link):
            continue  # another machine's
        path, _, anchor = link.partition("#")
        target = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
        led_to.add(target)
        if not os.path.exists(os.path.join(ROOT, target)):
            problems.append(f"{page}: '{link}' leads to no file")
        elif anchor and target in texts and anchor not in anchors(texts[target]):
            problems.append(f"{page}: '{link}': {target} has no such heading")
for name in everything:
    if name.startswith("Documentation" + os.sep) and name.lower().endswith(PICTURES) and name not in led_to:
        problems.append(f"{name}: no page shows this picture")
if not texts:
    problems.append(f"{ROOT} has no pages")
for problem in problems:
    print(problem, file=sys.stderr)
sys.exit(1 if problems else 0)
