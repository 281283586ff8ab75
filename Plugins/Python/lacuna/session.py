# SPDX-License-Identifier: BSD-3-Clause
"""Lacuna in a script: its constructors, and names that are nearly right.

    import lacuna
    lacuna.load()
    implant = lacuna.SkullImplant(Input=bone, Thickness=4)

After load() wrong names and words raise errors that propose the right ones, and pipeline errors are exceptions (lacuna.errors).
"""
import difflib
import functools
import importlib
import os
import sys

KINDS = ("source", "reader", "filter", "writer")  # that have a constructor
_proposing = []


def load():
    """Loads the plugin, here and on the server that ParaView is connected to. Then every source, filter, reader and writer has a
    constructor: lacuna.SkullImplant, paraview.simple.SkullImplant, and SkullImplant in a script that has said
    `from paraview.simple import *`, before or after.

    From then on errors of pipelines are exceptions (lacuna.errors.raise_errors), except in ParaView's window. Raises ImportError
    where there is no ParaView.
    """
    load_for(sys._getframe(1).f_globals)


def load_for(script):
    """load() for a script whose globals are given."""
    try:
        import paraview
        import paraview.simple as pv
    except ImportError as error:
        raise ImportError("lacuna.load(), lacuna.open() and the filters need ParaView's Python: run the script by pvpython. With VTK alone "
                          "use the classes, such as lacuna.vtkLacunaSkullImplant()") from error
    from lacuna import errors, plugin
    plugin.load()
    _propose_in_errors()
    if not _in_window(paraview):
        errors.raise_errors()
    if script.get("CreateRenderView") is pv.CreateRenderView:  # by `from paraview.simple import *`
        script.update({name: getattr(pv, name) for name in constructors() if hasattr(pv, name)})
        errors.replace_in(script)


def _in_window(paraview):
    """Whether this is ParaView's window. Its scripts and macros see fromGUI too late, or not at all."""
    return paraview.fromGUI or os.path.basename(os.path.realpath("/proc/self/exe")).startswith("paraview")


@functools.lru_cache(maxsize=None)
def proxies():
    """What the plugin's XML says of each source, reader, filter, writer and region (lacuna.proxies.Proxy), by the constructor's name; empty
    in a build without ParaView."""
    from lacuna.proxies import INSTALLED, read_files
    return {proxy.constructor: proxy for proxy in (read_files([INSTALLED]) if os.path.exists(INSTALLED) else [])
            if proxy.kind in (*KINDS, "implicit_function")}


def constructors():
    """Names of all constructors: labels without blanks and hyphens."""
    return [name for name, proxy in proxies().items() if proxy.kind in KINDS]


def find(name):
    """What lacuna.NAME is when the package has no such name: a module, or a constructor of the plugin. Raises AttributeError."""
    if name.startswith("_"):
        raise AttributeError(f"module 'lacuna' has no attribute '{name}'")
    if os.path.exists(os.path.join(os.path.dirname(os.path.abspath(__file__)), name + ".py")):
        return importlib.import_module("lacuna." + name)
    known = constructors()
    if name in known:
        simple = sys.modules.get("paraview.simple")
        if hasattr(simple, name):
            return getattr(simple, name)
        raise AttributeError(f"lacuna.{name} is a filter of ParaView: call lacuna.load() first, in pvpython. With VTK alone use "
                             f"lacuna.{proxies()[name].cls}()")
    import lacuna
    raise AttributeError(f"lacuna has no {name}{proposal(name, known + names(lacuna))}; lacuna.help() lists all filters")


def names(package):
    """What the package has for users: classes, functions and modules."""
    modules = [name[:-3] for name in os.listdir(os.path.dirname(os.path.abspath(__file__))) if name.endswith(".py")]
    return [name for name in [*vars(package), *modules] if not name.startswith("_")]


def near(word, words, count=3):
    """Those of words that someone may have meant by word, the nearest first."""
    def plain(text):
        return "".join(filter(str.isalnum, text.lower()))
    table = {}
    for each in words:
        table.setdefault(plain(each), each)
    found = difflib.get_close_matches(plain(word), table, count, 0.7)
    longer = [each for each in table if len(plain(word)) > 3 and each.startswith(plain(word))]
    return [table[each] for each in dict.fromkeys(found + longer)][:count]


def proposal(word, words, quote=""):
    """'; did you mean …?' with what is near, or nothing."""
    found = [f"{quote}{each}{quote}" for each in near(word, words)]
    return "; did you mean " + ", ".join(found[:-1]) + (" or " if found[1:] else "") + found[-1] + "?" if found else ""


def _label(proxy):
    return proxy.SMProxy.GetXMLLabel() or proxy.SMProxy.GetXMLName()


def _propose_in_errors():
    """ParaView's errors about names of properties and words of enumerations are raised with what may have been meant."""
    from paraview import servermanager
    if _proposing:
        return
    _proposing.append(True)
    proxy_class = servermanager.Proxy
    set_before, get_before = proxy_class.__setattr__, proxy_class.__getattr__

    def set_attribute(self, name, value):
        try:
            set_before(self, name, value)
        except AttributeError as error:
            if hasattr(type(self), name):
                raise
            raise AttributeError(_unknown_property(self, name)) from error
        except ValueError as error:
            raise ValueError(_wrong_value(self, name, value, error)) from error

    def get_attribute(self, name):
        try:
            return get_before(self, name)
        except AttributeError as error:
            if name.startswith("_") or not self.SMProxy:
                raise
            raise AttributeError(_unknown_property(self, name)) from error

    proxy_class.__setattr__, proxy_class.__getattr__ = set_attribute, get_attribute


def _unknown_property(proxy, name):
    known = proxy.ListProperties()
    text = f"{_label(proxy)} has no property {name}{proposal(name, known)}"
    if text.endswith("?") or not 0 < len(known) <= 40:
        return text
    return f"{text}; it has {', '.join(sorted(known))}"


def _wrong_value(proxy, name, value, error):
    prop = proxy.GetProperty(name)
    choices = list(getattr(prop, "Available", None) or [])
    if not isinstance(value, str) or not choices:
        return str(error)
    text = f"{_label(proxy)}: '{value}' is not a value of {name}{proposal(value, choices, chr(39))}"
    return text + ("" if text.endswith("?") else ".") + " It can be " + ", ".join(f"'{choice}'" for choice in choices)
