#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Links of the built site: each leads to a file, each #anchor to a place in it, and nothing is loaded from another machine.

Anchors from one page of Doxygen to another are not looked at: it makes some to sections that it leaves out.

check-site.py [folder of html]    default: build/site/html; leaves with 77 when it is not built
"""
import html.parser
import os
import re
import sys
import urllib.parse

BUILT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "build", "site", "html"))
if len(sys.argv) < 2 and not os.path.isdir(BUILT):
    print("the site is not built: Documentation/build-site.sh")
    sys.exit(77)
ROOT = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else BUILT
CPP = os.path.join(ROOT, "cpp")


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.links, self.loads, self.places = set(), set(), {"", "top"}
        with open(path, encoding="utf-8") as file:
            self.feed(file.read())

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.places.update(filter(None, (values.get("id"), values.get("name"))))
        loads = tag in ("img", "script", "iframe", "source") or tag == "link" and values.get("rel") != "canonical"
        for link in filter(None, (values.get("href"), values.get("src"))):
            (self.loads if loads else self.links).add(link)


def target_of(path, link):
    return os.path.normpath(os.path.join(os.path.dirname(path), urllib.parse.unquote(link)))


pages = {os.path.join(folder, name): Page(os.path.join(folder, name))
         for folder, _, found in os.walk(ROOT) for name in found if name.endswith(".html")}
problems = [] if pages else [f"{ROOT} has no pages"]
for path, page in sorted(pages.items()):
    for link in sorted(page.links | page.loads):
        parts = urllib.parse.urlsplit(link)
        if parts.scheme or parts.netloc:
            if link in page.loads and parts.scheme not in ("data", "javascript"):
                problems.append(f"{os.path.relpath(path, ROOT)}: loads {link}")
            continue
        target = target_of(path, parts.path) if parts.path else path
        if not os.path.isfile(target):
            problems.append(f"{os.path.relpath(path, ROOT)}: '{link}' leads to no file")
        elif target in pages and os.path.dirname(path) != CPP and urllib.parse.unquote(parts.fragment) not in pages[target].places:
            problems.append(f"{os.path.relpath(path, ROOT)}: '{link}' leads to no such place")
for folder, _, found in os.walk(ROOT):
    for path in (os.path.join(folder, name) for name in found if name.endswith(".css")):
        with open(path, encoding="utf-8") as file:
            for link in re.findall(r"url\(\s*[\"']?((?!data:|#)[^)\"'?]+)", re.sub(r"url\([\"']?data:.*?\)|/\*.*?\*/", "", file.read(), flags=re.DOTALL)):
                if link.startswith("/") or not os.path.isfile(target_of(path, link)):
                    problems.append(f"{os.path.relpath(path, ROOT)}: loads {link}")
for problem in problems:
    print(problem, file=sys.stderr)
sys.exit(1 if problems else 0)
