# SPDX-License-Identifier: BSD-3-Clause
"""Every source, reader, filter and writer of the plugin has its peak memory in the guide's table, which Testing/Benchmarks/memory.py measures."""
import os
import re
import sys

import lacuna.plugin

lacuna.plugin.load()
from every_proxy import every_kind
from lacuna_test import ROOT
from paraview import servermanager

sys.path.append(os.path.join(ROOT, "Testing", "Benchmarks"))
import memory

# label: why there is no row; a new one is listed here after a thought
WITHOUT_ROW = {"Polhemus Video Source": "its slices come from devices, and how full the memory is it says itself"}
NEEDS_REASON = 2  # times input and output


def label(name):
    manager = servermanager.ProxyManager().SMProxyManager
    return next(manager.GetPrototypeProxy(group, name).GetXMLLabel() for group in ("sources", "filters", "writers")
                if manager.HasDefinition(group, name))


def rows(page):
    """First cell -> the largest number of times that all is input and output."""
    found = {}
    for line in page.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) == 9 and re.fullmatch(r"[\d.]+", cells[4]):
            assert cells[0] not in found, f"{cells[0]} is there twice"
            found[cells[0]] = max(float(cells[4]), float(cells[8]))
    return found


labels = {label(name) for name in every_kind()}
measured = {case.split(",")[0] for case in memory.CASES}
missing = labels - measured - set(WITHOUT_ROW)
assert not missing, f"memory.py has no case of {sorted(missing)}"
assert measured <= labels, f"memory.py measures what is not there: {sorted(measured - labels)}"
assert list(memory.CASES) == list(memory.SIZES), "cases without a size, or sizes without a case"
assert set(WITHOUT_ROW) <= labels - measured, "listed as without a row, and has one or is not there"

with open(os.path.join(ROOT, "Documentation", "UserGuide", "memory.md"), encoding="utf-8") as file:
    guide = file.read()
shown = rows(guide)
assert list(shown) == list(memory.CASES), f"the guide's rows are not those of memory.py: {sorted(set(shown) ^ set(memory.CASES)) or 'another order'}"
reasons = set(re.findall(r"^- \*\*(.+?)\*\*", guide, re.MULTILINE))
unexplained = {name for name, times in shown.items() if times >= NEEDS_REASON and name.split(",")[0] not in reasons}
assert not unexplained, f"the guide does not say why {sorted(unexplained)} take so much"
idle = reasons - {name.split(",")[0] for name, times in shown.items() if times >= NEEDS_REASON}
assert not idle, f"the guide gives reasons for {sorted(idle)}, which take less"
print(f"{len(shown)} rows of {len(measured)} kinds")
