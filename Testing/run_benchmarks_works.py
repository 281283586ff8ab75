# SPDX-License-Identifier: BSD-3-Clause
"""run.py of Testing/Benchmarks: reads what programs write, alternates, survives failures, and its page says what was measured.

    run_benchmarks_works.py [folder of the benchmarks' programs]    whose rows must be there
"""
import json
import os
import stat
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "Benchmarks"))
# pylint: disable=wrong-import-position
from harness import cases, report, rows, statistics  # noqa: E402

# As Google Benchmark writes it
RECORDED = """{"context": {"num_cpus": 2}, "benchmarks": [
 {"name": "Fit/kernel:0/nodes:700/process_time/real_time", "run_name": "x", "run_type": "iteration", "repetitions": 0, "threads": 1, "iterations": 3,
  "real_time": 5.5e+00, "cpu_time": 9.5e+00, "time_unit": "ms", "condition": 1.5e+03, "label": "thin plate"},
 {"name": "Grow/slices:20/iterations:1/process_time/real_time", "run_type": "iteration", "iterations": 1, "real_time": 2e6, "cpu_time": 4e6, "time_unit": "ns"},
 {"name": "Cast/1/manual_time", "run_type": "iteration", "iterations": 1, "real_time": 0.5, "cpu_time": 0.25, "time_unit": "s"},
 {"name": "Cast/1_median", "run_type": "aggregate", "real_time": 0.5, "cpu_time": 0.25, "time_unit": "s"},
 {"name": "Head", "run_type": "iteration", "error_occurred": true, "error_message": "no head", "iterations": 0, "real_time": 0, "cpu_time": 0, "time_unit": "ns"}]}"""
found = rows.parse(RECORDED)
assert sorted(found) == ["Cast/1", "Fit/kernel:0/nodes:700", "Grow/slices:20", "Head"], found
fit = found["Fit/kernel:0/nodes:700"]
assert (fit.wall, fit.cpu, fit.counters, fit.label) == (5.5, 9.5, {"condition": 1500.0}, "thin plate")
assert (found["Grow/slices:20"].wall, found["Grow/slices:20"].cpu, found["Cast/1"].wall) == (2, 4, 500)
assert found["Head"].error == "no head"

# Medians, ratios within a round, exponents
measured = statistics.Measured({"rows": {"p:a": [{"wall": w, "cpu": 2 * w, "counters": {}} for w in (1, 2, 10)],
                                         "p:b": [{"wall": w, "cpu": w, "counters": {}} for w in (3, 8, 20)],
                                         **{f"p:{n}": [{"wall": 7 * n**1.5, "cpu": n, "counters": {}}, None] for n in (10, 100, 1000)}}})
a, b = cases.Row("p", "a"), cases.Row("p", "b")
assert measured.spread(a) == statistics.Spread(2, 1, 10)
assert measured.ratio(b, a) == statistics.Spread(3, 2, 4)
assert measured.ratio(b, a, "cpu") == statistics.Spread(1.5, 1, 2)
exponent = measured.exponent([(n, cases.Row("p", str(n))) for n in (10, 100, 1000)])
assert abs(exponent.median - 1.5) < 1e-12 and abs(exponent.least - 1.5) < 1e-12
assert measured.spread(cases.Row("p", "none")) is None

# Figures
assert [report.number(value) for value in (0.00123, 0.5, -12.34, 123.4, 999.9, 1234, 97336, 1e6)] == ["0.00123", "0.5", "−12.3", "123", "1\u202f000", "1\u202f230", "97\u202f300", "1\u202f000\u202f000"]

# Suites: rows of a quick run are fewer, names of files are not used twice
files = [each.file for suite in cases.SUITES for each in (*suite.scalings, *suite.threads)]
assert len(files) == len(set(files)), files
for suite in cases.SUITES:
    quick, full = suite.rows(True), suite.rows(False)
    assert quick and all(set(names) <= set(full[program]) for program, names in quick.items()), suite.name

# Ranks
import run  # noqa: E402
assert run.rank_rows({"ranks": {"rows": {"Swept Volume/strong/ranks:1": 8.0, "Swept Volume/strong/ranks:2": 5.0, "Swept Volume/weak/ranks:2": 9.0,
                                         "Swept Volume/strong/parts:100": 0.5, "Setup": 1.0}}}) == {
    "Swept Volume": {"strong": {1: 8.0, 2: 5.0}, "weak": {2: 9.0}, "strong by parts": {100: 0.5}}}
assert run.rank_rows({"ranks": None}) == run.rank_rows({}) == run.rank_rows({"ranks": {"text": "no mpirun"}}) == {}

# A run with programs that stand in for ours: they write the time that their rows' names say
FAKE = """#!{python}
import json, os, re, sys
sys.path.insert(0, {folder!r})
from harness import cases
options = dict(each[2:].split("=", 1) for each in sys.argv[1:])
program = os.path.basename(__file__)[len("Benchmark"):]
with open({log!r}, "a") as log: log.write(program + "\\n")
if program == "ToolPath": os.abort()
if program == "IGESWriter": sys.exit("no room on the disk")
names = [name for suite in cases.SUITES for name in suite.rows(False).get(program, [])]
assert float(options["benchmark_min_time"]) > 0
out = []
for name in dict.fromkeys(names):
    if not re.search(options["benchmark_filter"], name + "/process_time/real_time") or name == "Plate/2/1": continue
    edge = re.fullmatch(r"Shell/(\\d+)/512/2", name)
    time = int(edge.group(1))**3 / 1e3 if edge else 30 if "Reference" in name else 10
    out.append(dict(name=name + "/process_time/real_time", run_type="iteration", iterations=1, real_time=time, cpu_time=2 * time, time_unit="ms", triangles=12.0))
json.dump(dict(benchmarks=out), open(options["benchmark_out"], "w"))
"""
RUN = os.path.join(HERE, "Benchmarks", "run.py")
with tempfile.TemporaryDirectory() as folder:
    log = os.path.join(folder, "log")
    os.makedirs(os.path.join(folder, "bin"))
    for program in ("IsoRayCaster", "ToolPath", "IGESWriter", "ImplantPlate"):
        path = os.path.join(folder, "bin", "Benchmark" + program)
        with open(path, "w", encoding="utf-8") as file:
            file.write(FAKE.format(python=sys.executable, folder=os.path.join(HERE, "Benchmarks"), log=log))
        os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
    output = os.path.join(folder, "page")
    only = [f"--only={name}" for name in ("iso-ray-caster", "tool-path", "iges", "implant-plate", "occluded-angle")]
    done = subprocess.run([sys.executable, RUN, "--quick", "--rounds=3", *only, f"--build={folder}", f"--output={output}"], check=False, text=True, stdout=subprocess.PIPE)
    assert done.returncode == 0, done
    with open(os.path.join(output, "README.md"), encoding="utf-8") as file:
        page = file.read()
    plain = page.replace("\u202f", " ").replace("\u00a0", " ")
    with open(log, encoding="utf-8") as file:
        assert file.read().split().count("IsoRayCaster") == 3
    row = next(line for line in plain.splitlines() if line.startswith("| CT head, B-spline, along an axis"))
    assert row.split(" | ")[1:] == ["10 / 20", "30 / 60", "the thesis's algorithm", "**3** (3 – 3)", "**3** (3 – 3) |"], row
    row = next(line for line in plain.splitlines() if line.startswith("| [Depth map of 512 × 512, B-spline](#b-spline-iso-ray-caster) | Lacuna"))
    assert "97 300 – 1 000 000 voxels | **1** (1 – 1)" in row, row
    for words in ("ended by signal 6", "ended with code 1: no room on the disk", "`ImplantPlate:Plate/2/1` | there is no such row", "`OccludedAngle` | not there",
                  "A quick run", "Other programs had", "| in the defect | 10 | 20 | 12 |"):
        assert words in page, words
    subprocess.run([sys.executable, RUN, f"--redraw={output}/results.json", f"--output={folder}/again"], check=True)
    with open(os.path.join(folder, "again", "README.md"), encoding="utf-8") as file:
        assert file.read() == page
    # a suite that was measured again takes the place of the first one, if all else is the same
    with open(os.path.join(output, "results.json"), encoding="utf-8") as file:
        again = json.load(file)
    again["suites"] = {"tool-path": again["suites"]["iso-ray-caster"]}
    parts = [os.path.join(output, "results.json"), os.path.join(folder, "part.json")]
    for changed, refused in ((again, False), ({**again, "rounds": 9}, True), ({**again, "machine": {**again["machine"], "Lacuna": "other"}}, True)):
        with open(parts[1], "w", encoding="utf-8") as file:
            json.dump(changed, file)
        done = subprocess.run([sys.executable, RUN, "--redraw", *parts, f"--output={folder}/joined"], check=False, stderr=subprocess.PIPE)
        assert (done.returncode != 0) == refused, done
    with open(os.path.join(folder, "joined", "results.json"), encoding="utf-8") as file:
        joined = json.load(file)
    assert joined["suites"]["tool-path"] == joined["suites"]["iso-ray-caster"] and "iges" in joined["suites"]
    with open(os.path.join(folder, "joined", "README.md"), encoding="utf-8") as file:
        assert "All figures are of 2 runs of" in file.read()
    # ranks stand alone: they may be of another build, and say of which
    ranks = {"rows": {"x/strong/parts:1": 9.0, "x/strong/parts:1000": 0.1}, "text": "the table of ranks", "Lacuna": "abc", "Date": "today"}
    with open(parts[1], "w", encoding="utf-8") as file:
        json.dump({**again, "suites": {}, "ranks": ranks, "machine": {**again["machine"], "Lacuna": "abc"}}, file)
    subprocess.run([sys.executable, RUN, "--redraw", *parts, f"--output={folder}/ranks"], check=True, stderr=subprocess.DEVNULL)
    with open(os.path.join(folder, "ranks", "README.md"), encoding="utf-8") as file:
        text = file.read()
    assert "the table of ranks" in text and "Lacuna abc, measured at today." in text and again["machine"]["Lacuna"] in text
    pictures = sorted(name for name in os.listdir(output) if name.endswith(".svg"))
    if any(subprocess.run([python, "-c", "import matplotlib"], check=False, stderr=subprocess.DEVNULL).returncode == 0
           for python in (sys.executable, run.PYTHON) if os.path.exists(python)):
        assert pictures == ["iso-ray-caster-rays.svg", "iso-ray-caster-voxels.svg", "peers.svg", "threads.svg"], pictures
        for name in pictures:
            assert f"({name})" in page
            with open(os.path.join(output, name), encoding="utf-8") as file, open(os.path.join(folder, "again", name), encoding="utf-8") as again:
                text = file.read()
                assert text == again.read() and "prefers-color-scheme" in text and "SPDX" in text
    else:
        assert not pictures
    # with no program at all there is nothing to write about
    nothing = subprocess.run([sys.executable, RUN, "--only=occluded-angle", f"--build={folder}/none", f"--output={output}", "--rounds=1", "--minutes=0"],
                             check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    assert nothing.returncode == 1
    with open(os.path.join(output, "README.md"), encoding="utf-8") as file:
        assert file.read() == page
    # where nothing can be written nothing is measured
    calls = os.path.getsize(log)
    nowhere = subprocess.run([sys.executable, RUN, "--only=iso-ray-caster", f"--build={folder}", f"--output={log}/page"], check=False, text=True, stderr=subprocess.PIPE)
    assert nowhere.returncode == 1 and "cannot write into" in nowhere.stderr and os.path.getsize(log) == calls, nowhere
    # nor beside things of another kind
    strange = os.path.join(folder, "strange")
    os.makedirs(strange)
    for name in ("README.md", "drawing.svg"):
        with open(os.path.join(strange, name), "w", encoding="utf-8") as file:
            file.write("mine")
    for how in (f"--only=iso-ray-caster --build={folder}", f"--redraw={output}/results.json"):
        refused = subprocess.run([sys.executable, RUN, *how.split(), f"--output={strange}"], check=False, text=True, stderr=subprocess.PIPE)
        assert refused.returncode == 1 and "new or empty" in refused.stderr and os.path.getsize(log) == calls, refused
    assert sorted(os.listdir(strange)) == ["README.md", "drawing.svg"]

# The rows are rows of the programs; peers may be absent
if len(sys.argv) > 1:
    missing = []
    for suite in cases.SUITES:
        own = {row.key for each in suite.comparisons for row in [each.ours]} | {row.key for each in (*suite.scalings, *suite.threads) for _, row in each.series[0][1]}
        for program, names in suite.rows(False).items():
            path = os.path.join(sys.argv[1], "Benchmark" + program) if not program.endswith(".py") else os.path.join(HERE, "Benchmarks", program)
            if not os.path.exists(path):
                continue
            command = [sys.executable, path] if path.endswith(".py") else [path]
            listed = subprocess.run([*command, "--benchmark_list_tests=true"], check=False, text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
            if listed.returncode != 0 and path.endswith(".py"):
                continue  # scipy is not installed
            there = {rows.SUFFIXES.sub("", line.strip()) for line in listed.stdout.splitlines()}
            functions = {name.split("/")[0] for name in there}
            for name in names:
                # VTK and OpenCASCADE may not be installed: then none of their rows is there
                absent = program in ("IGESWriter", "RadialBasis") and cases.Row(program, name).key not in own and name.split("/")[0] not in functions
                if name not in there and not absent:
                    missing.append(f"{program}: {name}")
    assert not missing, missing
print("ok")
