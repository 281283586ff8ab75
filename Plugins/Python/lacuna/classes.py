# SPDX-License-Identifier: BSD-3-Clause
"""What the classes vtkLacuna* say of their properties, for scripts with VTK alone (ParaView's proxies take names)."""
import re

_PROPERTY = re.compile(r"^  (\w+): (.*?)(?: \((.*)\))?$", re.MULTILINE)
_CHOICE = re.compile(r"(\d+) \(([^()]*)\)(?:, | or |$)")


def properties(algorithm):
    """Name -> (value, what it may be) of each property, as texts; what it may be is empty where it may be anything.

    algorithm: a filter, reader, source or writer of Lacuna."""
    return {name: (value, allowed) for name, value, allowed in _PROPERTY.findall(str(algorithm))}


def choices(algorithm, name):
    """Name -> number of each value that a property may be chosen from.

        filler.SetKernel(lacuna.choices(filler, "Kernel")["Cubic"])

    Raises KeyError for a property that there is none of, ValueError for one that is no choice."""
    known = properties(algorithm)
    if name not in known:
        raise KeyError(f"{algorithm.GetClassName()} has no property {name}; it has {', '.join(sorted(known))}")
    allowed = known[name][1]
    found = {text: int(number) for number, text in _CHOICE.findall(allowed)}
    if not found or _CHOICE.sub("", allowed):  # "0 (automatic) or above 0 mm" is a range
        raise ValueError(f"{name} of {algorithm.GetClassName()} is no choice: it may be {allowed or 'anything'}")
    return found
