# SPDX-License-Identifier: BSD-3-Clause
"""What Lacuna's plugins add to the start of ParaView: until it runs a script, with the plugins and without.

    . build/release/lacuna-env.sh
    xvfb-run -a python3 Testing/Benchmarks/plugin_startup.py [--benchmark_filter=pvpython]

run.py --only plugin-startup does so in turns, and with a display of its own.
"""
import os
import subprocess
import tempfile

from harness.rows import Program

PROGRAMS = {"paraview": ["--dr", "--script="], "pvpython": [""]}


def start(name, has_plugins):
    def prepare():
        plugins = os.environ.get("PV_PLUGIN_CONFIG_FILE")
        if not plugins:
            raise SystemExit("PV_PLUGIN_CONFIG_FILE is not set: source lacuna-env.sh first")
        environment = dict(os.environ)
        if not has_plugins:
            del environment["PV_PLUGIN_CONFIG_FILE"]

        def measured():
            with tempfile.TemporaryDirectory() as folder:
                script = os.path.join(folder, "leave.py")
                with open(script, "w", encoding="utf-8") as file:
                    file.write("import os\nfrom paraview import simple\n"
                               f"os._exit(0 if hasattr(simple, 'SkullPhantom') == {has_plugins} else 1)\n")
                *options, last = PROGRAMS[name]
                subprocess.run([name, *options, last + script], env=environment, check=True, stdout=subprocess.DEVNULL)

        measured()  # reads the disk
        return measured
    return prepare


program = Program(__doc__)
for which in PROGRAMS:
    program.add(f"{which}/with", start(which, True))
    program.add(f"{which}/without", start(which, False))

if __name__ == "__main__":
    program.main()
