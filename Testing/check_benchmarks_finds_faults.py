# SPDX-License-Identifier: BSD-3-Clause
"""check-benchmarks.py finds figures whose command is not there, and nothing else."""
from checkers import complaints

GOOD = """# Speed
12 ms of processor time on an AMD EPYC (`bin/BenchmarkFilter --benchmark_filter=Goal`), 3 times as fast as before.
## Elsewhere
Nothing of speed; `Testing/Tools/tool.py` and `Testing/Benchmarks/run.py --only filter` are there.
"""


def check(page, *options):
    return complaints("check-benchmarks.py", {
        "README.md": "", "Documentation/page.md": page, "Testing/Tools/tool.py": "", "Testing/Benchmarks/run.py": "",
        "Testing/Benchmarks/CMakeLists.txt": "lacuna_add_benchmark(Filter Goal)\n", "Testing/Benchmarks/harness/cases.py": 'Suite("filter", "Filter")\n',
        "build/CTestTestfile.cmake": 'add_test("Lacuna::One" "true")\nadd_test("Properties.Two" "true")\n'}, *options)


def check_tests(pattern):
    return check(GOOD + f"| `ctest --preset asan -R {pattern} -LE soak` | as `./test.sh -R {pattern}`; |\n", "--build", "{folder}/build")


assert check(GOOD) == "", check(GOOD)
assert "page.md:5: there is no program BenchmarkGone" in check(GOOD + "`BenchmarkGone`")
assert "page.md:5: there is no Testing/Tools/gone.py" in check(GOOD + "`python3 Testing/Tools/gone.py 3`")
assert "page.md:5: run.py has no suite gone" in check(GOOD + "`Testing/Benchmarks/run.py --only gone`")
assert "page.md:6: a figure of speed without the command" in check(GOOD + "# More\nIt takes 3 s of processor time.")
assert "page.md:6: a figure of speed without the command" in check(GOOD + "# More\nIt is 10 times as fast.")
for found in ("Two", "'^(Lacuna::\\|Three)'", '"(Three|Two)"'):
    assert check_tests(found) == "", check_tests(found)
for gone in ("Three", r"'^(Three\|Two)'"):
    assert check_tests(gone).count("page.md:5: no test is found by ctest -R") == 2, check_tests(gone)
print("ok")
