# SPDX-License-Identifier: BSD-3-Clause
"""Runs every Python example of README.md and the user guide as printed: each in a process and an empty folder of its own.

An example that only the user's data can run says so in its first line; it is compiled and not run.
"""
import concurrent.futures
import glob
import os
import re
import shutil
import subprocess
import sys
import time

from lacuna_test import ROOT, check_warnings, output

PVPYTHON = sys.argv[1]  # sys.executable is not the program that runs in pvpython
OWN_FILES = "# needs your own files"


def examples():
    """(page:line, source) of every Python block."""
    guide = os.path.join(ROOT, "Documentation", "UserGuide", "*.md")
    for page in [os.path.join(ROOT, "README.md"), *sorted(glob.glob(guide))]:
        with open(page, encoding="utf-8") as file:
            text = file.read()
        for block in re.finditer(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
            line = text.count("\n", 0, block.start(1)) + 1
            yield f"{os.path.relpath(page, ROOT)}:{line}", block[1]


def run(name, source):
    """What is wrong with an example; empty when it runs without an error."""
    try:
        compile(source, name, "exec")
    except SyntaxError as error:
        return str(error)
    if source.startswith(OWN_FILES):
        print(f"{name}: compiled only", flush=True)
        return ""
    folder = os.path.abspath(output(os.path.join("UserGuideExamples", re.sub(r"\W+", "-", name))))
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    start = time.monotonic()
    script = folder + ".py"
    with open(script, "w", encoding="utf-8") as file:
        file.write(source)
    done = subprocess.run(
        [PVPYTHON, "--force-offscreen-rendering", script], cwd=folder, text=True, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120)
    print(f"{name}: exit code {done.returncode}, {time.monotonic() - start:.1f} s", flush=True)
    # VTK reports an error and goes on; an example of raising() makes one on purpose
    reported = re.search(r"ERR\||ERROR: In ", done.stdout) and "raising()" not in source
    warnings = re.findall(r"WARN\| (.*)", done.stdout)
    try:
        check_warnings(warnings, os.path.join(ROOT, name.split(":")[0]))
    except AssertionError as error:
        return str(error)
    return done.stdout if done.returncode or reported else ""


blocks = list(examples())
assert len(blocks) >= 10, blocks
with concurrent.futures.ThreadPoolExecutor(min(4, os.cpu_count() or 1)) as pool:
    failures = {name: text for (name, _), text in zip(blocks, pool.map(lambda block: run(*block), blocks)) if text}
for name, text in failures.items():
    print(f"--- {name} ---\n{text}")
sys.exit(1 if failures else 0)
