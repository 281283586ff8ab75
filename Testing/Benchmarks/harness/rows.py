# SPDX-License-Identifier: BSD-3-Clause
"""Rows of benchmarks: how a program in Python makes them, and how run.py has any program make them.

A row is one of Google Benchmark's JSON (lacunaBenchmark.h says what its times are). Every program, of C++ or Python,
takes --benchmark_filter, --benchmark_min_time and --benchmark_out.
"""
import argparse
import json
import os
import re
import resource
import signal
import subprocess
import tempfile
import time
from dataclasses import dataclass, field

UNITS = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}
SUFFIXES = re.compile(r"(/iterations:\d+|/process_time|/real_time|/manual_time|/min_time:[\d.]+)+$")
KNOWN = {"name", "family_index", "per_family_instance_index", "run_name", "run_type", "repetitions", "repetition_index", "threads",
         "iterations", "real_time", "cpu_time", "time_unit", "label", "error_occurred", "error_message"}


def processor_seconds():
    """Of this process, all of its threads, and the processes that it waited for."""
    return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))


@dataclass
class Row:
    """One measurement; times in ms."""
    wall: float = 0.0
    cpu: float = 0.0
    counters: dict = field(default_factory=dict)
    label: str = ""
    error: str = ""

    def get(self, what):
        """A time or a counter; None where it has none."""
        return {"wall": self.wall, "cpu": self.cpu}.get(what, self.counters.get(what))


class Failure(Exception):
    """A program that gave no rows; says why."""


def parse(text):
    """Rows by name of what a program wrote."""
    found = {}
    for each in json.loads(text)["benchmarks"]:
        if each.get("run_type") == "aggregate":
            continue
        if each.get("error_occurred"):
            row = Row(error=each.get("error_message") or "an error without a message")
        else:
            scale = UNITS[each["time_unit"]]
            if each.keys() & {"wall", "cpu"}:
                raise Failure(f"{each['name']} has a counter by the name of a time: {sorted(each.keys() & {'wall', 'cpu'})}")
            counters = {key: value for key, value in each.items() if key not in KNOWN and isinstance(value, (int, float))}
            row = Row(scale * each["real_time"], scale * each["cpu_time"], counters, each.get("label", ""))
        found[SUFFIXES.sub("", each["name"])] = row
    return found


def pattern(names):
    """A filter for these rows, for any dialect of regular expressions."""
    escaped = [re.sub(r"([][.^$*+?(){}|\\])", r"\\\1", name) for name in names]
    return "^(" + "|".join(escaped) + ")(/iterations:[0-9]+|/process_time|/real_time|/manual_time)*$"


def call(command, timeout, environment=None):
    """What a program prints. It is of a group of its own, so that what it starts ends with it."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment, start_new_session=True) as process:
        try:
            printed, said = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired as late:
            os.killpg(process.pid, signal.SIGTERM)  # mpirun's ranks are of other groups, and end with it if it is asked
            try:
                process.communicate(timeout=5)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.communicate()
            raise Failure(f"not done in {timeout:.0f} s") from late
    if process.returncode != 0:
        last = said.strip().splitlines()[-1] if said.strip() else ""
        how = f"ended by signal {-process.returncode}" if process.returncode < 0 else f"ended with code {process.returncode}"
        raise Failure(f"{how}{': ' + last if last else ''}")
    return printed


def run(command, names, seconds, timeout, environment=None):
    """Has a program measure the rows of these names, each for at least so many seconds; rows by name."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "rows.json")
        call([*command, f"--benchmark_filter={pattern(names)}", f"--benchmark_min_time={seconds}", f"--benchmark_out={out}", "--benchmark_out_format=json"],
             timeout, environment)
        try:
            with open(out, encoding="utf-8") as file:
                return parse(file.read())
        except (OSError, ValueError, KeyError) as problem:
            raise Failure(f"wrote no rows that can be read ({problem})") from problem


class Program:
    """A program of benchmarks in Python: rows are added, then main() measures those that the filter picks."""

    def __init__(self, description):
        self.description = description
        self.rows = []

    def add(self, name, prepare):
        """prepare() returns what is to be measured, a function that may return a dict of counters; None without its data.

        Among them may be real_time and cpu_time in ms, where only a part of the function counts: of its last run.
        """
        self.rows.append((name, prepare))

    def main(self, arguments=None):
        parser = argparse.ArgumentParser(description=self.description, formatter_class=argparse.RawDescriptionHelpFormatter)
        parser.add_argument("--benchmark_filter", default=".*", metavar="REGEX", help="rows to measure")
        parser.add_argument("--benchmark_min_time", type=float, default=0.5, metavar="S", help="each for so many seconds")
        parser.add_argument("--benchmark_out", metavar="FILE", help="write the rows as JSON")
        parser.add_argument("--benchmark_out_format", choices=["json"], default="json")
        parser.add_argument("--benchmark_list_tests", nargs="?", const="true", default="false", help="only the names of the rows")
        options = parser.parse_args(arguments)
        chosen = [(name, prepare) for name, prepare in self.rows if re.search(options.benchmark_filter, name)]
        if options.benchmark_list_tests == "true":
            print("\n".join(name for name, _ in chosen))
            return
        results = []
        for name, prepare in chosen:
            results.append(self.measure(name, prepare, options.benchmark_min_time))
            if "real_time" not in results[-1]:
                print(f"{name:50} {results[-1]['error_message']}", flush=True)
                continue
            shown = {key: f"{value:.4g}" for key, value in results[-1].items() if isinstance(value, float) and key not in ("real_time", "cpu_time")}
            print(f"{name:50} {results[-1]['real_time']:12.3f} ms {results[-1]['cpu_time']:12.3f} ms  "
                  + "  ".join(f"{key}={value}" for key, value in shown.items()), flush=True)
        if options.benchmark_out:
            with open(options.benchmark_out, "w", encoding="utf-8") as file:
                json.dump({"context": {}, "benchmarks": results}, file, indent=1)

    @staticmethod
    def measure(name, prepare, least):
        function = prepare()
        if function is None:
            return {"name": name, "run_type": "iteration", "error_occurred": True, "error_message": "what it reads is not in LACUNA_TEST_DATA"}
        iterations, counters = 0, None
        start, busy = time.perf_counter(), processor_seconds()
        while True:
            counters = function()
            iterations += 1
            wall = time.perf_counter() - start
            if wall >= least:
                break
        cpu = processor_seconds() - busy
        return {"name": name, "run_type": "iteration", "iterations": iterations, "real_time": 1e3 * wall / iterations,
                "cpu_time": 1e3 * cpu / iterations, "time_unit": "ms", **(counters if isinstance(counters, dict) else {})}
