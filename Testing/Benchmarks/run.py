#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs all benchmarks beside their peers and writes a page with tables and plots.

    Testing/Benchmarks/run.py                       all, about an hour, into Documentation/Benchmarks
    Testing/Benchmarks/run.py --quick               a few minutes, into build/benchmarks
    Testing/Benchmarks/run.py --only speckle        one suite (several times for several)

Testing/Tools/benchmarks.sh runs it after installing the packages and building all; by itself it takes what is built
in build/release, with the packages of Testing/Tools/packages-benchmarks.txt. Peers that are not installed are left
out, and so is what needs data of LACUNA_TEST_DATA where there is none. A benchmark that fails is noted on the page,
the others go on. Leave the machine alone meanwhile: the page says how much others had of it.
"""
import argparse
import importlib.util
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

PYTHON = "/usr/bin/python3"  # for which Debian's packages are
if __name__ == "__main__" and os.path.exists(PYTHON) and os.path.realpath(sys.executable) != os.path.realpath(PYTHON) \
        and None in map(importlib.util.find_spec, ("matplotlib", "numpy", "scipy")):
    os.execv(PYTHON, [PYTHON, *sys.orig_argv[1:]])

from harness import cases, machine, report, rows  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
MINUTES = 55


class Runner:
    def __init__(self, options):
        self.build = os.path.abspath(options.build)
        self.quick = options.quick
        self.rounds = options.rounds
        self.seconds = 0.02 if options.quick else 0.15
        self.timeout = 300 if options.quick else 600
        self.end = time.monotonic() + 60 * options.minutes
        self.environment = self.read_environment()

    def read_environment(self):
        """With the plugins of the build, where it has them, and its data."""
        script = os.path.join(self.build, "lacuna-env.sh")
        environment = dict(os.environ)
        if os.path.exists(script):
            printed = subprocess.run(["bash", "-c", f". {shlex.quote(script)} && env -0"], check=True, stdout=subprocess.PIPE).stdout
            environment = dict(each.split("=", 1) for each in printed.decode(errors="replace").split("\0") if "=" in each)
        data = re.search(r"^LACUNA_TEST_DATA:\w+=(.*)$", machine.read(os.path.join(self.build, "CMakeCache.txt")), re.MULTILINE)
        if data:
            environment.setdefault("LACUNA_TEST_DATA", data.group(1))
        return environment

    def command(self, program):
        """None where the program is not there."""
        if program.endswith(".py"):
            display = [] if os.environ.get("DISPLAY") or "startup" not in program else ["xvfb-run", "-a", "-s", "-screen 0 1600x1200x24 -noreset"]
            return [*display, sys.executable, os.path.join(HERE, program)] if not display or shutil.which("xvfb-run") else None
        path = os.path.join(self.build, "bin", "Benchmark" + program)
        return [path] if os.path.exists(path) else None

    def measure(self, suite):
        """All rounds of a suite."""
        programs = suite.rows(self.quick)
        rounds = suite.rounds or self.rounds
        found = {cases.Row(program, name).key: [] for program, names in programs.items() for name in names}
        errors, done, start, load = {}, 0, time.monotonic(), machine.Load()
        for turn in range(rounds):
            if turn and time.monotonic() > self.end:
                break
            for program, names in programs.items():
                measured = {}
                if program not in errors:
                    try:
                        measured = self.run(program, names)
                    except rows.Failure as failure:
                        errors[program] = str(failure)
                for name in names:
                    row, key = measured.get(name), cases.Row(program, name).key
                    if row is None or row.error:
                        found[key].append(None)
                        if program not in errors:
                            errors[key] = row.error if row else "there is no such row: what it needs was not installed when it was built"
                    else:
                        found[key].append({"wall": row.wall, "cpu": row.cpu, "counters": row.counters, "label": row.label})
            done += 1
            print(f"  {suite.name}: round {done} of {rounds}, {time.monotonic() - start:.0f} s", flush=True)
        return {"rows": found, "errors": errors, "rounds": done, "others": load.others(), "seconds": time.monotonic() - start}

    def run(self, program, names):
        command = self.command(program)
        if command is None:
            raise rows.Failure("not there: what it needs was not installed when Lacuna was built, or nothing was built")
        left = max(30.0, self.end - time.monotonic() + 60)
        return rows.run(command, names, self.seconds, min(self.timeout, left), self.environment)

    def ranks(self):
        """ranks.py scales over MPI's ranks; its rows are CASE/strong/ranks:N and CASE/weak/ranks:N, of the processor time of the busiest rank, and parts:N."""
        script = os.path.join(HERE, "ranks.py")
        print("  ranks", flush=True)
        try:
            with tempfile.TemporaryDirectory() as folder:
                out = os.path.join(folder, "ranks.json")
                said = rows.call([sys.executable, script, *(["--quick"] if self.quick else []), "--benchmark_out", out], 6 * self.timeout,
                                 self.environment)
                with open(out, encoding="utf-8") as file:
                    return {"rows": {name: row.cpu for name, row in rows.parse(file.read()).items() if not row.error}, "text": said.strip()}
        except (OSError, ValueError, KeyError, rows.Failure) as problem:
            return {"text": f"ranks.py failed: {problem}"}


def rank_rows(results):
    """{case: {kind: {ranks: ms}}}; kind is strong or weak, measured, or with "by parts" behind it."""
    found = {}
    for name, time_taken in (results.get("ranks") or {}).get("rows", {}).items():
        row = re.fullmatch(r"(.*)/(strong|weak)/(ranks|parts):(\d+)", name)
        if row:
            kind = row[2] + (" by parts" if row[3] == "parts" else "")
            found.setdefault(row[1], {}).setdefault(kind, {})[int(row[4])] = time_taken
    return found


def has_plots():
    """Whether plots can be drawn; complains if not."""
    try:
        from harness import plots  # noqa: F401
        return True
    except ImportError as missing:
        print(f"no plots: {missing} (Debian: python3-matplotlib, for /usr/bin/python3); --redraw makes them later", file=sys.stderr)
        return False


def require_writable(folder):
    """Now rather than after an hour of measuring. A folder of other things, with a README.md and pictures of its own, is left alone."""
    try:
        os.makedirs(folder, exist_ok=True)
        if os.listdir(folder) and not os.path.exists(os.path.join(folder, "results.json")):
            raise SystemExit(f"{folder} has files, and no results.json of an earlier run; give a folder that is new or empty as --output")
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as problem:
        raise SystemExit(f"cannot write into {folder}: {problem.strerror}; give another --output") from None


def write(results, folder, suites):
    """The page, its plots, and the figures themselves."""
    with open(os.path.join(folder, "results.json"), "w", encoding="utf-8") as file:  # first: all else can be made of it
        json.dump(results, file, indent=1, ensure_ascii=False)
        file.write("\n")
    drawn = []
    if has_plots():
        from harness import plots
        drawn = plots.draw(results, suites, folder, rank_rows(results))
        for name in os.listdir(folder):
            if name.endswith(".svg") and name[:-4] not in drawn:
                os.remove(os.path.join(folder, name))  # of an earlier run
    with open(os.path.join(folder, "README.md"), "w", encoding="utf-8") as file:
        file.write(report.Page(results, suites).text(drawn))


def join(files):
    """Results of several runs as those of one; all of one build, machine and kind."""
    whole = None
    for name in files:
        try:
            with open(name, encoding="utf-8") as file:
                part = json.load(file)
        except (OSError, ValueError) as problem:
            raise SystemExit(f"{name}: {problem}") from None
        if whole is None:
            whole = part
            continue
        own = {"Date", "Versions"} if part["suites"] else {"Date", "Versions", "Lacuna"}  # ranks stand alone, with their own build
        for fact in set(whole["machine"]) - own:
            if part["machine"].get(fact) != whole["machine"][fact]:
                raise SystemExit(f"{name}: {fact} is another: {part['machine'].get(fact)}, not {whole['machine'][fact]}")
        if any(part[kind] != whole[kind] for kind in ("quick", "rounds")):
            raise SystemExit(f"{name}: it was measured with other rounds")
        if part["suites"]:
            whole["machine"] = part["machine"]  # peers that were installed since
        whole["suites"].update(part["suites"])
        whole["ranks"] = part.get("ranks") or whole.get("ranks")
        whole["runs"] = whole.get("runs", 1) + (part.get("runs", 1) if part["suites"] else 0)
        whole["minutes"] += part["minutes"]
        whole["load"] = {"mean": max(whole["load"]["mean"], part["load"]["mean"]), "largest": max(each["others"] for each in whole["suites"].values())}
    return whole


def parse_arguments(arguments):
    names = [suite.name for suite in cases.SUITES]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small cases, two rounds")
    parser.add_argument("--only", action="append", choices=[*names, "ranks"], metavar="NAME", help="one of " + ", ".join([*names, "ranks"]))
    parser.add_argument("--output", metavar="FOLDER", help="default: Documentation/Benchmarks; build/benchmarks with --quick, --only or --rounds")
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"), metavar="FOLDER", help="default: build/release")
    parser.add_argument("--rounds", type=int, metavar="N", help="default: 5; 2 with --quick")
    parser.add_argument("--minutes", type=float, default=MINUTES, help=f"no new suite or round after so many; default: {MINUTES}")
    parser.add_argument("--redraw", nargs="+", metavar="FILE", help="measure nothing, write page and plots of a results.json; the suites of "
                        "further ones, of the same build on the same machine, take the place of the first one's")
    options = parser.parse_args(arguments)
    if options.rounds is not None and options.rounds < 1:
        parser.error("--rounds must be 1 or more")
    partial = options.quick or options.only or options.rounds
    options.output = options.output or (os.path.join(ROOT, "build", "benchmarks") if partial else os.path.join(ROOT, "Documentation", "Benchmarks"))
    options.rounds = options.rounds or (2 if options.quick else 5)
    return options


def main(arguments=None):
    options = parse_arguments(arguments)
    require_writable(options.output)
    if options.redraw:
        write(join(options.redraw), options.output, cases.SUITES)
        return 0
    has_plots()
    runner = Runner(options)
    suites = [suite for suite in cases.SUITES if not options.only or suite.name in options.only]
    given = " ".join(["Testing/Benchmarks/run.py", *(["--quick"] if options.quick else []), *(f"--only {name}" for name in options.only or [])])
    results = {"command": given, "machine": machine.describe(ROOT, runner.build), "cores": os.cpu_count(), "quick": options.quick, "rounds": options.rounds,
               "suites": {}, "left_out": {}}
    start, load = time.monotonic(), machine.Load()
    for suite in suites:
        if time.monotonic() > runner.end:
            results["left_out"][suite.title] = f"not begun within {options.minutes:g} minutes"
            continue
        print(suite.title, flush=True)
        results["suites"][suite.name] = runner.measure(suite)
    if not options.only or "ranks" in options.only:
        if time.monotonic() < runner.end:
            results["ranks"] = {**runner.ranks(), **{fact: results["machine"][fact] for fact in ("Lacuna", "Date")}}
        else:
            results["left_out"]["Ranks"] = f"not begun within {options.minutes:g} minutes"
    results["load"] = {"mean": load.others(), "largest": max((each["others"] for each in results["suites"].values()), default=0.0)}
    results["minutes"] = (time.monotonic() - start) / 60
    for name, each in results["suites"].items():
        for what, why in each["errors"].items():
            print(f"not measured: {name}: {what}: {why}")
    if results.get("ranks") and not rank_rows(results):
        print(f"not measured: ranks: {results['ranks']['text']}")
    if not rank_rows(results) and not any(any(values) for each in results["suites"].values() for values in each["rows"].values()):
        print("nothing was measured, and nothing written; is Lacuna built?", file=sys.stderr)
        return 1
    write(results, options.output, suites)
    print(os.path.join(options.output, "README.md"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
