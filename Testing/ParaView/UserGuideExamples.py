# SPDX-License-Identifier: BSD-3-Clause
"""Runs every Python example of README.md and the user guide as printed: each in a process and an empty folder of its own.

UserGuideExamples.py NUMBER OF PROCESSES AT A TIME

The processes are forks of this one, which has ParaView loaded, without Lacuna: half the time of the examples is ParaView's start. An
example that only the user's data can run says so in its first line; it is compiled and not run.
"""
import glob
import os
import re
import shutil
import signal
import sys
import time
import traceback

import paraview.simple  # noqa: F401
from lacuna_test import ROOT, check_warnings, output

OWN_FILES = "# needs your own files"
SECONDS = 120  # for one example


def examples():
    """(page:line, source) of every Python block."""
    guide = os.path.join(ROOT, "Documentation", "UserGuide", "*.md")
    for page in [os.path.join(ROOT, "README.md"), *sorted(glob.glob(guide))]:
        with open(page, encoding="utf-8") as file:
            text = file.read()
        for block in re.finditer(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
            line = text.count("\n", 0, block.start(1)) + 1
            yield f"{os.path.relpath(page, ROOT)}:{line}", block[1]


def run_here(folder, name, code):
    """Runs an example in this process, which ends with it."""
    printed = os.open(folder + ".txt", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(printed, 1)
    os.dup2(printed, 2)
    os.chdir(folder)
    sys.path[0] = os.path.dirname(folder)
    sys.argv = [name]
    signal.alarm(SECONDS)
    status = 0
    try:
        exec(code, {"__name__": "__main__", "__file__": folder + ".py"})
    except BaseException:
        traceback.print_exc()
        status = 1
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


def start(name, source):
    """The process that runs an example, and its folder."""
    code = compile(source, name, "exec")
    folder = os.path.abspath(output(os.path.join("UserGuideExamples", re.sub(r"\W+", "-", name))))
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    process = os.fork()
    if not process:
        run_here(folder, name, code)
    return process, folder


def check(name, source, folder, status):
    """What is wrong with an example that has ended; empty when it ran without an error."""
    with open(folder + ".txt", encoding="utf-8") as file:
        printed = file.read()
    # VTK reports an error and goes on; an example of exceptions makes one on purpose
    reported = re.search(r"ERR\||ERROR: In ", printed) and "PipelineError" not in source
    try:
        check_warnings(re.findall(r"WARN\| (.*)", printed), os.path.join(ROOT, name.split(":")[0]))
    except AssertionError as error:
        return str(error)
    return printed + f"status {status}" if status or reported else ""


def main():
    os.environ.pop("LACUNA_PLUGIN", None)  # as where Lacuna is installed: lacuna.plugin knows where it is
    waiting = list(examples())
    assert len(waiting) >= 10, waiting
    running, failures = {}, {}
    while waiting or running:
        if waiting and len(running) < int(sys.argv[1]):
            name, source = waiting.pop(0)
            if source.startswith(OWN_FILES):
                compile(source, name, "exec")
                print(f"{name}: compiled only", flush=True)
            else:
                process, folder = start(name, source)
                running[process] = name, source, folder, time.monotonic()
            continue
        process, status = os.wait()
        name, source, folder, since = running.pop(process)
        print(f"{name}: status {status}, {time.monotonic() - since:.1f} s", flush=True)
        failures[name] = check(name, source, folder, status)
    failures = {name: text for name, text in failures.items() if text}
    for name, text in failures.items():
        print(f"--- {name} ---\n{text}")
    sys.exit(1 if failures else 0)


main()
