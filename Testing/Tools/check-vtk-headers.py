#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whether the modules compile with the headers of Debian's own VTK, which cannot be installed beside ParaView.

check-vtk-headers.py [--guarded] [--suite SUITE] BUILD     a build of the preset vtk
check-vtk-headers.py --paraview --suite SUITE BUILD        a build of the preset release: the plugins' sources, with the headers of
                                                           that Debian's ParaView and Qt 6

Takes the package's headers from apt and nothing else of it, and has the compiler read each source of the modules with them in the place of
ParaView's, without making anything of it. --guarded: only those that know how versions differ (lacunaVersionCompat.h). --suite: those
of another Debian, bookworm (9.1), trixie (9.3) or sid, instead of this one's (DEBIAN_MIRROR). They stay in BUILD: delete headers-sid for newer ones.
(Testing/Tools/chroot.sh builds and tests with that VTK.)
"""
import argparse
import concurrent.futures
import glob
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile

VTK = "libvtk9-dev", "libtbb-dev", "libjsoncpp-dev"  # whose headers VTK's include
PARAVIEW = *VTK, "paraview-dev", "qt6-base-dev", "libvtk9-qt-dev"  # from 6.1 on it has no VTK of its own
GUARDS = "lacunaVersionCompat.h"


def apt(folder, suite):
    """The command apt-get; with a suite that is not this system's it has lists of its own in folder."""
    if not suite:
        return ["apt-get", "-qq"]
    sources = os.path.join(folder, "sources.list")
    for part in "lists/partial", "cache/archives/partial":
        os.makedirs(os.path.join(folder, part), exist_ok=True)
    with open(sources, "w", encoding="ascii") as file:
        file.write(f"deb {os.environ.get('DEBIAN_MIRROR', 'http://deb.debian.org/debian')} {suite} main\n")
    own = {"Dir::Etc::SourceList": sources, "Dir::Etc::SourceParts": "-", "Dir::State::Lists": f"{folder}/lists", "Dir::State::Status": "/dev/null",
           "Dir::Cache": f"{folder}/cache", "APT::Sandbox::User": "root", "Acquire::Check-Valid-Until": "false"}
    return ["apt-get", "-qq", *(f"-o{name}={value}" for name, value in own.items())]


def headers(folder, suite, packages):
    """Folders of headers of the packages, unpacked."""
    if not os.path.isdir(folder):
        with tempfile.TemporaryDirectory(dir=os.path.dirname(folder)) as work:  # folder is there when all is in it
            command = apt(work, suite)
            download = [*command, "download", *packages]
            if subprocess.run(download, cwd=work, check=False, stderr=subprocess.DEVNULL).returncode != 0:  # without lists of packages?
                subprocess.run([*command, "update"], check=False)
                if subprocess.run(download, cwd=work, check=False).returncode != 0:
                    sys.exit(f"{' and '.join(packages)} of {suite or 'this Debian'} cannot be had; apt says why above")
            unpacked = os.path.join(work, "unpacked")
            for package in glob.glob(os.path.join(work, "*.deb")):
                subprocess.run(["dpkg-deb", "-x", package, unpacked], check=True)
            os.rename(unpacked, folder)
    own = os.path.join(folder, "usr", "include")
    return [*glob.glob(os.path.join(own, "paraview-*")), *glob.glob(os.path.join(own, "vtk-*")), *glob.glob(os.path.join(own, "jsoncpp")), own]


def stand_in(folder):
    """What export headers, which ParaView's VTK has generated, include, where VTK has none yet."""
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "vtkABINamespace.h"), "w", encoding="ascii") as file:
        file.write("#define VTK_ABI_NAMESPACE_BEGIN\n#define VTK_ABI_NAMESPACE_END\n")
    return folder


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def commands(build, folders, plugins):
    """(source, command, folder) of what uses VTK, is no test and was not generated for ParaView's VTK; of the plugins or of all else."""
    instead = " ".join(f"-isystem {shlex.quote(folder)}" for folder in folders)
    for entry in json.loads(read(os.path.join(build, "compile_commands.json"))):
        source = entry["file"]
        command, replaced = re.subn(r"-isystem \S*/paraview-[\d.]+(?=\s)", lambda _: instead, entry["command"])
        if plugins:  # folders within ParaView's and Qt's
            command = re.sub(r"-isystem \S*/paraview-[\d.]+/", lambda _: f"-isystem {folders[0]}/", command)
            command = re.sub(r"-isystem \S*/include/([^/\s]+)/qt5(?=[/\s])", lambda found: f"-isystem {folders[-1]}/{found[1]}/qt6", command)
        command = re.sub(r"(-Winvalid-pch|-include \S*/cmake_pch\.hxx)(?=\s)", "", command)  # those are ParaView's headers, compiled
        if replaced and "/Testing/" not in source and not source.startswith(build + os.sep) and ("/Plugins/" in source) == plugins:
            words = shlex.split(command)
            at = words.index("-o")
            yield source, [*words[:at], "-fsyntax-only", *words[at + 2:]], entry["directory"]


def guarded(jobs):
    """Those whose source includes GUARDS, also by other headers of the modules."""
    texts = {header: read(header) for folder in {os.path.dirname(source) for source, _, _ in jobs} for header in glob.glob(os.path.join(folder, "*.h"))}
    includes, grown = set(), {GUARDS}
    while grown > includes:
        includes = grown
        grown = includes | {os.path.basename(header) for header, text in texts.items() if any(f'"{name}"' in text for name in includes)}
    return [job for job in jobs if any(f'"{name}"' in read(job[0]) for name in includes)]


def complaint(job):
    source, command, folder = job
    done = subprocess.run(command, cwd=folder, check=False, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return f"{source}:\n{done.stdout}" if done.returncode != 0 else ""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--guarded", action="store_true", help=f"only what includes {GUARDS}")
    parser.add_argument("--paraview", action="store_true", help="the plugins, with ParaView's headers")
    parser.add_argument("--suite", default="", help="of Debian")
    parser.add_argument("build", help="of the preset vtk")
    options = parser.parse_args()
    build = os.path.abspath(options.build)
    unpacked = os.path.join(build, "-".join(filter(None, ("headers", options.suite))))
    folders = headers(unpacked, options.suite, PARAVIEW if options.paraview else VTK)
    stand_ins = [] if options.paraview else [stand_in(os.path.join(unpacked, "stand-in"))]
    jobs = list(commands(build, [*folders, *stand_ins], options.paraview))
    jobs = guarded(jobs) if options.guarded else jobs
    if not jobs:
        sys.exit(f"{build} has no such sources that use VTK")
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        complaints = list(filter(None, pool.map(complaint, jobs)))
    print("\n".join(complaints))
    print(f"{len(jobs) - len(complaints)} of {len(jobs)} sources compile with {os.path.basename(folders[0])}")
    sys.exit(1 if complaints else 0)


main()
