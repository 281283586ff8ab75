# SPDX-License-Identifier: BSD-3-Clause
"""What Lacuna's filters do, in plain text.

    import lacuna
    lacuna.help()              # all filters, by job
    lacuna.help("hole")        # those that have to do with holes, with their properties
    lacuna.help("SkullImplant")
"""
import re
import textwrap

from lacuna.session import near, proxies

JOBS = {
    "Acquire and calibrate ultrasound": (
        "Polhemus Video Source", "Phantom Sweep", "Scan Region", "Probe Calibration", "Temporal Calibration", "Tracker Self Test"),
    "From ultrasound slices to surfaces": (
        "Tracked Slice Reader", "Assemble Tracked Slices", "Gate Slices", "Bone Echo", "Speckle Filter", "Contrast To Speckle", "Slice Planes",
        "Slice Outliner", "Outlined Structures", "Slice Ray Caster", "Swept Volume", "Tracked Slice Writer"),
    "See a CT": (
        "CT Series Reader", "Volume Reader", "Skull Phantom", "Skull Bone", "B-Spline Iso Ray Caster", "Depth Map Shader", "Depth Map Surface"),
    "Plan an implant": ("Skull Implant", "Skull Resection", "Mirror", "RBF Hole Filler", "Spline Loop"),
    "Make an implant": (
        "Implant Plate", "Defect Model", "Press Orientation", "Milling Tool Path", "IGES Writer", "STEP Writer", "G-Code Writer"),
    "Surfaces from points, outlines and incomplete data": (
        "Outline Reader", "RBF Surface", "RBF Interpolator", "RBF Image Warp", "Incomplete Shape", "Occluded Angle", "Occlusion Surface")}
WIDTH = 110


def show(words=""):
    """Prints what describe(words) returns: lacuna.help()."""
    print(describe(words))


def describe(words=""):
    """Text on the filters whose name, label or documentation has these words, with their properties, defaults, ranges and units; all filters
    by job where there are no words. words: in any case, such as "hole", "Skull Implant" or "EdgeClearance"; or a filter itself.
    """
    known = proxies()
    if not known:
        return ("This Lacuna was built without ParaView and has no filters to list. Its classes are in the package: "
                "help(lacuna.vtkLacunaSkullImplant) describes one.")
    if not isinstance(words, str):
        words = getattr(words, "GetXMLLabel", None) and words.GetXMLLabel() or getattr(words, "__name__", str(words))
    if not words.strip():
        return _all(known)
    wanted = [re.compile(rf"\b{re.escape(word)}", re.I) for word in words.split()]
    exact = [proxy for proxy in known.values() if _plain(words) in (_plain(proxy.label), _plain(proxy.cls))]
    named = exact or [proxy for proxy in known.values() if _has(f"{proxy.label} {proxy.constructor}", wanted)]
    others = [] if exact else [proxy for proxy in known.values() if proxy not in named and _has(_text(proxy), wanted)]
    if not named and not others:
        return _unknown(words, known)
    others.sort(key=lambda proxy: not _has(proxy.short_help, wanted))
    parts = [_in_full(proxy) for proxy in named] + [_in_short(proxy, wanted) for proxy in others]
    if others:
        parts.append(f"lacuna.help(\"{others[0].constructor}\") lists all properties of a filter.")
    return "\n\n".join(parts)


def _has(text, wanted):
    return all(word.search(text) for word in wanted)


def _plain(text):
    return re.sub(r"[\W_]", "", text).lower().removeprefix("vtklacuna")


def _text(proxy):
    return " ".join([proxy.label, proxy.constructor, proxy.short_help, proxy.help,
                     *(_words_of(each) for each in proxy.properties if each.in_python)])


def _words_of(own):
    """The text of a property, with the words of its name."""
    return " ".join([own.python, re.sub(r"(?<=[a-z])(?=[A-Z])", " ", own.python), own.help, *own.entries.values()])


def _all(known):
    by_label = {proxy.label: proxy for proxy in known.values()}
    lines = []
    for job, labels in JOBS.items():
        there = [by_label[label] for label in labels if label in by_label]
        lines += ["", job] + [f"  {proxy.constructor:24}{proxy.short_help}" for proxy in there] if there else []
    return "\n".join(lines[1:] + ["", "lacuna.help(\"hole\") finds filters by words, and lists their properties."])


def _in_full(proxy):
    """A filter with all its properties."""
    lines = _head(proxy)
    for each in proxy.properties:
        if each.in_python and not each.hidden:
            lines += _wrapped(_property(each, each.help), "    ", "        ")
    return "\n".join(lines)


def _in_short(proxy, wanted):
    """A filter with the properties in which a word is wanted, each in one sentence."""
    lines = _head(proxy)
    for each in proxy.properties:
        if each.in_python and not each.hidden and any(word.search(_words_of(each)) for word in wanted):
            lines += _wrapped(_property(each, re.split(r"(?<=\.) (?=[A-Z0-9])", each.help)[0]), "    ", "        ")
    return "\n".join(lines)


def _head(proxy):
    return [f"{proxy.constructor}  ({proxy.label}, {proxy.kind.replace('_', ' ')})", *_wrapped(proxy.short_help, "  ")]


def _property(own, text):
    default, values = own.default_text(), own.values_text()
    if own.information:
        head = f"{own.python} (read only)"
    else:
        head = own.python + (f" = {default}" if default and own.kind != "Input" else "") + (f" ({values})" if values else "")
        head += " (optional)" if own.kind == "Input" and own.optional else ""
    return f"{head}: {text}"


def _wrapped(text, first, others=None):
    return textwrap.wrap(text, WIDTH, initial_indent=first, subsequent_indent=first if others is None else others) or [first.rstrip()]


def _unknown(words, known):
    """What may have been meant: names first, then words of labels and texts."""
    names = [proxy.constructor for proxy in known.values()]
    properties = {each.python for proxy in known.values() for each in proxy.properties if each.in_python}
    single = {word for proxy in known.values() for word in re.findall(r"[a-z]{4,}", _text(proxy).lower())}
    found = list(dict.fromkeys(near(words, names) + near(words, sorted(properties)) + near(words, sorted(single))))[:3]
    return f"No filter has to do with '{words}'. " + (
        "Did you mean " + " or ".join(f"'{each}'" for each in found) + "? " if found else "") + "lacuna.help() lists all."
