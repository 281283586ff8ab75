# SPDX-License-Identifier: BSD-3-Clause
"""For the tests of the checkers in Testing/Tools."""
import os
import subprocess
import sys
import tempfile


def complaints(tool, files, *options):
    """What a checker says of a folder with these files (name to content); options may name {folder}."""
    with tempfile.TemporaryDirectory() as folder:
        for name, content in files.items():
            path = os.path.join(folder, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "w", encoding="utf-8") as file:
                file.write(content)
        checker = os.path.join(os.path.dirname(os.path.abspath(__file__)), "Tools", tool)
        done = subprocess.run([sys.executable, checker, folder, *(option.format(folder=folder) for option in options)], check=False, text=True, stderr=subprocess.PIPE)
        assert (done.returncode == 0) == (done.stderr == ""), done.stderr
        return done.stderr
