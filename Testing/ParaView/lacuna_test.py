# SPDX-License-Identifier: BSD-3-Clause
"""What the scripts in this folder share."""
import os
import re
import runpy
import shutil
import subprocess
import sys

SKIPPED = 77  # ctest counts this exit code as skipped
SANITIZED = "san.so" in os.environ.get("LD_PRELOAD", "")  # takes all addresses and keeps what is freed: no measure of memory
ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))


def data(name):
    """File of the real data, or leaves the test as skipped."""
    file = os.path.join(os.environ.get("LACUNA_TEST_DATA", ""), name)
    if not os.path.exists(file):
        print(f"skipped: {file} is not there (set LACUNA_TEST_DATA)", flush=True)
        sys.exit(SKIPPED)
    return file


def output(name):
    """File name in the folder for what tests write."""
    folder = os.environ.get("LACUNA_TEST_OUTPUT", ".")
    os.makedirs(folder, exist_ok=True)
    return os.path.join(folder, name)


def program(name):
    """The program's path, or leaves the test as skipped."""
    path = shutil.which(name)
    if not path:
        print(f"skipped: no {name}", flush=True)
        sys.exit(SKIPPED)
    return path


def memory_of_process(key):
    """Bytes of this process: VmRSS now, VmHWM at most until now, VmSize of addresses."""
    with open("/proc/self/status", encoding="ascii") as file:
        return next(int(line.split()[1]) * 1024 for line in file if line.startswith(key + ":"))


def mpi_environment():
    """For mpirun: pvpython has started MPI for itself; its traces would confuse it."""
    environment = {key: value for key, value in os.environ.items()
                   if not key.startswith(("OMPI_", "PMIX_", "OPAL_", "ORTE_", "PRTE_"))}
    environment.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_mpi_yield_when_idle="1",
                       PRTE_MCA_rmaps_default_mapping_policy=":oversubscribe")  # the same for Open MPI 5
    return environment


def run_ranks(ranks, script, *arguments, options=(), timeout=300):
    """What a script prints in pvbatch, with pvbatch's options, with so many MPI ranks, or leaves the test as skipped."""
    done = subprocess.run([program("mpirun"), "-n", str(ranks), program("pvbatch"), "--force-offscreen-rendering", *options,
                           os.path.abspath(script), *arguments], env=mpi_environment(), check=False, timeout=timeout, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    printed = done.stdout.replace("\0", "")  # MPI writes some, which pvpython cannot
    print(printed, flush=True)
    done.check_returncode()
    return printed


def on_two_ranks(script, run):
    """A test whose run() is called in pvbatch on each of two ranks for itself, and comes to its end on both."""
    if sys.argv[1:2] == ["in pvbatch"]:
        run()
        print("rank done", flush=True)
    else:
        printed = run_ranks(2, script, "in pvbatch", options=["--symmetric"])
        assert printed.count("rank done") == 2, printed


def check_defaults(proxy, own, names, enumerations=None):
    """The panel's defaults are the class's own, and scripts may set each enumeration by its words.

    own: a new object of the wrapped class. enumerations: for each name the words in the order of
    the class's values.
    """
    for name in names:
        shown, expected = getattr(proxy, name), getattr(own, "Get" + name)()
        if isinstance(expected, tuple):
            shown = tuple(shown)
        assert shown == expected, (name, shown, expected)
    for name, words in (enumerations or {}).items():
        default = words[getattr(own, "Get" + name)()]
        assert getattr(proxy, name) == default, (name, getattr(proxy, name), default)
        for value, word in enumerate(words):
            setattr(proxy, name, word)
            assert getattr(proxy.GetClientSideObject(), "Get" + name)() == value, (name, word)
        setattr(proxy, name, default)


def check_warnings(warnings, page):
    """Whoever follows a page gets no warning but those that it tells of: each has words that the page quotes as `code`."""
    with open(page, encoding="utf-8") as file:
        quoted = [words for words in re.findall("`([^`\n]+)`", file.read()) if words.count(" ") >= 2]
    untold = [warning for warning in warnings if not any(words in warning for words in quoted)]
    assert not untold, f"{page} does not tell of: " + "; ".join(untold)


def run_example(script, *arguments):
    """Runs <folder>/<script> of Documentation/Examples: without an error, and without a warning of which the folder's README.md does not tell.

    Returns the script's globals.
    """
    from lacuna.errors import raising
    script = os.path.join(ROOT, "Documentation", "Examples", script)
    folder = os.path.dirname(script)
    sys.argv = [script, *arguments]
    sys.path.insert(0, folder)
    warnings = []
    with raising(warnings):
        made = runpy.run_path(script, run_name="__main__")
    check_warnings(warnings, os.path.join(folder, "README.md"))
    return made


def compare_with_baseline(picture, name, threshold):
    """Compares a PNG with one of the pictures of the user guide, so that the guide stays true. threshold: of picture_error."""
    baseline = os.path.join(ROOT, "Documentation", "UserGuide", "pictures", name)
    error = picture_error(picture, baseline)
    print(f"{name}: image error {error:.1f} (at most {threshold})", flush=True)
    assert error <= threshold


def picture_error(picture, baseline):
    """How different two PNG files of one size look (vtkImageDifference): 0 is equal, tens are font and driver differences."""
    from vtkmodules.vtkImagingCore import vtkImageDifference
    from vtkmodules.vtkIOImage import vtkPNGReader
    assert os.path.exists(baseline), f"no baseline {baseline}; look at {picture} and copy it there"
    readers = []
    for name in (picture, baseline):
        reader = vtkPNGReader()
        reader.SetFileName(name)
        reader.Update()
        readers.append(reader)
    sizes = [reader.GetOutput().GetDimensions() for reader in readers]
    assert sizes[0] == sizes[1], f"{picture} is {sizes[0]}, its baseline {sizes[1]}"
    difference = vtkImageDifference()
    difference.SetInputConnection(readers[0].GetOutputPort())
    difference.SetImageConnection(readers[1].GetOutputPort())
    difference.Update()
    return difference.GetThresholdedError()
