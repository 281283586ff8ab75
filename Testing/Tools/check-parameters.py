#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The user guide's tables of properties agree with the plugin's XML: every proxy has its page; every name in a table is a property with that default; every property and every choice is named on the page; the tables of the guide's README list every page once.

check-parameters.py [folder]    the project's folder; default: this one
"""
import os
import re
import sys

ROOT = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
sys.path.append(os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Plugins", "Python", "lacuna")))
from proxies import NOT_GIVEN, read_proxies  # noqa: E402

GUIDE = os.path.join("Documentation", "UserGuide")


def rows(text):
    """Number, names and defaults of each row of the tables that begin with name and default. One default is that of all names."""
    within = False
    for number, line in enumerate(text.splitlines(), 1):
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        if [cell.lower() for cell in cells[:2]] == ["name", "default"]:
            within = True
        elif not cells:
            within = False
        elif within and not re.fullmatch(r":?-+:?", cells[0]):
            names = re.findall(r"\w+", re.sub(r"\(.*?\)", "", cells[0]))
            defaults = cells[1].replace("`", "").split(", ")
            yield number, list(zip(names, defaults if len(defaults) == len(names) else [cells[1].replace("`", "")] * len(names)))


def plain(text):
    text = text.replace("−", "-").replace("\u202f", "").replace("\u00a0", "").replace(NOT_GIVEN + " (×3)", "not given")
    text = re.sub(r"(?<=\d) (?=000\b)", "", re.sub(r" \(.*?\)$", "", text))
    return {"": "none", "empty": "none", "–": "none", "identity": "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"}.get(text, text)


def same(written, own):
    """A default as written in a table is that of the XML."""
    written, truth = plain(written), plain(own.default_text())
    if written == truth or written == "none" and (own.information or own.kind == "Proxy" and len(own.choices) == 1):
        return True
    try:
        return list(map(float, written.split())) == list(map(float, truth.split()))
    except ValueError:
        return False


def check(proxy, text):
    own = {each.name: each for each in proxy.properties}
    named = set(re.findall(r"`(\w+)`", text)) | {name for cell in re.findall(r"^\|([^|]*)\|", text, re.MULTILINE) for name in re.findall(r"\w+", cell)}
    for number, pairs in rows(text):
        for name, default in pairs:
            if name not in own:
                yield f"line {number}: {proxy.label} has no property {name}"
            elif not same(default, own[name]):
                yield f"line {number}: the default of {name} is '{own[name].default_text()}', not '{default}'"
    for each in own.values():
        if each.name not in ("Input", "TimestepValues", "PauseLiveSource") and each.name not in named:
            yield f"does not name the property {each.name}"
        for choice in filter(lambda choice: not re.search(rf"\b{re.escape(choice)}\b", text), each.entries.values()):
            yield f"does not name {choice}, a choice of {each.name}"


problems = []
pages = {}
for name in sorted(os.listdir(os.path.join(ROOT, GUIDE))):
    if name.endswith(".md"):
        with open(os.path.join(ROOT, GUIDE, name), encoding="utf-8") as file:
            pages[name] = file.read()
proxies = read_proxies(ROOT)
for proxy in proxies:
    page = proxy.page + ".md"
    if page in pages:
        problems += [f"{GUIDE}/{page}: {problem}" for problem in check(proxy, pages[page])]
    elif proxy.kind in ("source", "reader", "filter", "writer"):
        problems.append(f"{GUIDE}/{page}: missing, the page of {proxy.label}")
    elif not any(proxy.label in text for text in pages.values()):
        problems.append(f"{GUIDE}: no page speaks of {proxy.label}")
for page in pages:
    listed = len(re.findall(rf"^\| *\[[^]]*\]\({page}\)", pages["README.md"], re.MULTILINE))
    if page != "README.md" and listed != 1:
        problems.append(f"{GUIDE}/README.md: {listed} rows of its tables, from which the site's navigation is made, begin with a link to {page}, not one")
if not proxies:
    problems.append(f"{ROOT} has no proxies")
for problem in problems:
    print(problem, file=sys.stderr)
sys.exit(1 if problems else 0)
