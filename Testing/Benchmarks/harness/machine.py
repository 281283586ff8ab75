# SPDX-License-Identifier: BSD-3-Clause
"""On what, and beside what, is measured: machine, versions, and how busy others kept the processors."""
import datetime
import os
import platform
import re
import resource
import subprocess
import time

TICKS = os.sysconf("SC_CLK_TCK")


def read(path):
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            return file.read()
    except OSError:
        return ""


def output(*command):
    """What a command prints; nothing where it fails."""
    try:
        return subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return ""


def package_versions():
    """Of the Debian packages of the peers that are installed."""
    found = []
    for label, package in (("ParaView", "paraview"), ("scipy", "python3-scipy"), ("numpy", "python3-numpy"), ("ALGLIB", "libalglib-dev"), ("CGAL", "libcgal-dev"),
                           ("OpenCASCADE", "libocct-data-exchange-dev"), ("GDCM", "libgdcm-dev"), ("Open MPI", "libopenmpi-dev"), ("Google Benchmark", "libbenchmark-dev")):
        version = output("dpkg-query", "-W", "-f=${Version}", package)
        if version:
            found.append(f"{label} {re.sub(r'^[0-9]+:|[-+~].*$', '', version)}")
    return ", ".join(found)


def is_stale(build):
    """Whether there is something to build, so that what is measured is not the sources' state."""
    return "no work to do" not in (output("ninja", "-C", build, "-n") or "no work to do")


def describe(root, build):
    """Facts by heading; the version is that of the sources of the build, where one is there, else of root."""
    cpu = re.search(r"model name\s*: (.*)", read("/proc/cpuinfo"))
    flags = re.search(r"flags\s*: (.*)", read("/proc/cpuinfo"))
    sets = [name for name, flag in (("SSE2", "sse2"), ("AVX2", "avx2"), ("AVX-512", "avx512f")) if flags and flag in flags.group(1).split()]
    memory = re.search(r"MemTotal:\s*(\d+)", read("/proc/meminfo"))
    system = re.search(r'PRETTY_NAME="?([^"\n]*)', read("/etc/os-release"))
    cache = read(os.path.join(build, "CMakeCache.txt"))
    source = re.search(r"CMAKE_HOME_DIRECTORY:\w+=(.*)", cache)
    root = source.group(1) if source else root
    compiler = re.search(r"CMAKE_CXX_COMPILER:\w+=(.*)", cache)
    kind = re.search(r"CMAKE_BUILD_TYPE:\w+=(.*)", cache)
    changed = output("git", "-C", root, "status", "--porcelain", "--untracked-files=no", "--", ".", ":!Documentation/Benchmarks")
    version = output("git", "-C", root, "log", "-1", "--format=%h of %cs") or "unknown"
    return {
        "Processor": f"{cpu.group(1).strip() if cpu else platform.machine()}, {os.cpu_count()} cores{', ' + ', '.join(sets) if sets else ''}"
                     + (", virtual" if flags and " hypervisor" in flags.group(1) else ""),
        "Memory": f"{int(memory.group(1)) / 2**20:.0f} GiB" if memory else "unknown",
        "System": f"{system.group(1) if system else platform.system()}, Linux {platform.release()}",
        "Compiler": f"{(output(compiler.group(1), '--version').splitlines() or ['unknown'])[0] if compiler else 'unknown'}, {kind.group(1) if kind else 'unknown build type'}",
        "Versions": package_versions() or "unknown",
        "Lacuna": version + (", with changes" if changed else "") + (", not all of it built" if is_stale(build) else ""),
        "Date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
    }


class Load:
    """How much of all cores' time others had since this was made: 0 to 1, what the host took included."""

    def __init__(self):
        self.start = self.now()

    @staticmethod
    def now():
        """s: of the clock, of all cores' work and of the part that is ours."""
        fields = re.match(r"cpu +(.*)", read("/proc/stat"))
        # user, nice, system, irq, softirq, steal; not idle and waiting for the disk, and guests are in user
        ticks = [int(value) for value in fields.group(1).split()] if fields else [0] * 8
        busy = (ticks[0] + ticks[1] + ticks[2] + ticks[5] + ticks[6] + ticks[7]) / TICKS
        own = sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
        return time.monotonic(), busy, own

    def others(self):
        wall, busy, own = (b - a for a, b in zip(self.start, self.now()))
        return max(0.0, min(1.0, (busy - own) / max(1e-9, wall * os.cpu_count())))
