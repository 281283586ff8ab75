# SPDX-License-Identifier: BSD-3-Clause
"""What Lacuna's plugins add to the start of ParaView.

    . build/release/lacuna-env.sh
    xvfb-run -a python3 Testing/Benchmarks/plugin_startup.py [--runs 10] [--program paraview|pvpython]

Starts the program with the plugins and without, in turns, until it runs a script, and compares the medians of the
processor's time (which other programs disturb less) and of the time by the clock.
"""
import argparse
import os
import statistics
import tempfile
import time


def start(program, script, environment):
    """Runs it; returns the processor's and the clock's time in s."""
    arguments = {"paraview": ["--dr", "--script=" + script], "pvpython": [script]}[program]
    begin = time.monotonic()
    process = os.posix_spawnp(program, [program, *arguments], environment,
                              file_actions=[(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)])
    _process, status, usage = os.wait4(process, 0)
    if status != 0:
        raise SystemExit(f"{program} failed with {status}")
    return usage.ru_utime + usage.ru_stime, time.monotonic() - begin


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--program", choices=["paraview", "pvpython"], default="paraview")
    options = parser.parse_args()
    plugins = os.environ.get("PV_PLUGIN_CONFIG_FILE")
    if not plugins:
        raise SystemExit("PV_PLUGIN_CONFIG_FILE is not set: source lacuna-env.sh first")
    without = {name: value for name, value in os.environ.items() if name != "PV_PLUGIN_CONFIG_FILE"}
    times = {True: [], False: []}
    with tempfile.TemporaryDirectory() as folder:
        script = os.path.join(folder, "leave.py")
        with open(script, "w", encoding="utf-8") as file:
            # the plugins are there, or not
            file.write("import os\nfrom paraview import servermanager, simple\n"
                       "there = hasattr(simple, 'SkullPhantom')\n"
                       f"os._exit(0 if there == ({plugins!r} == os.environ.get('PV_PLUGIN_CONFIG_FILE')) else 1)\n")
        for run in range(options.runs + 1):
            for has_plugins in (False, True):
                took = start(options.program, script, dict(os.environ) if has_plugins else without)
                if run > 0:  # the first one reads the disk
                    times[has_plugins].append(took)
    for which, name in enumerate(("processor", "clock")):
        medians = {key: statistics.median(took[which] for took in values) for key, values in times.items()}
        print(f"{options.program}, {name}: {medians[False]:.2f} s without, {medians[True]:.2f} s with the plugins: "
              f"{medians[True] - medians[False]:+.2f} s")


main()
