# SPDX-License-Identifier: BSD-3-Clause
"""coverage.py counts a line of a template once, leaves out what is no code, and fails below the least percentage."""
import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), ".."))


def run(least, files):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "coverage.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump({"files": [{"file": os.path.join(ROOT, name), "lines": lines} for name, lines in files]}, file)
        done = subprocess.run([sys.executable, os.path.join(ROOT, "Testing/Tools/coverage.py"), path, str(least)],
                              check=False, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        return done.returncode, done.stdout, done.stderr


def lines(*counts, **more):
    return [{"line_number": 10 + k, "count": count, **more} for k, count in enumerate(counts)]


A, B = "Filters/A/Kernel/a.cxx", "Readers/B/Kernel/b.h"
FILES = [(A, lines(5, 0, 0, 0, 1) + [{"line_number": 20, "count": 0}] + lines(1, 0)), (B, lines(1, 1, 1, 1)),
         (B, lines(0, 0, 0, 0)), (B, [{"line_number": 90, "count": 0, "gcovr/noncode": True}])]
code, table, error = run(60, FILES)
assert code == 0 and error == "", (code, error)
rows = {row.split()[0]: row.split()[1:] for row in table.splitlines()[1:4]}
assert rows == {"Filters/A/Kernel": ["6", "2", "33.3"], "Readers/B/Kernel": ["4", "4", "100.0"], "all": ["10", "6", "60.0"]}, table
assert f"33.3 %  {A}: 11-13, 20\n" in table and f"%  {B}" not in table, table
code, table, error = run(61, FILES)
assert code != 0 and "60.0 % of the kernels' lines ran, 61 % are wanted" in error, error
code, table, error = run(0, [])
assert code != 0 and "--coverage" in error, error
print("ok")
