# SPDX-License-Identifier: BSD-3-Clause
"""A Skull Implant becomes implant.stl and a report as HTML and PDF: select it, then run this macro.

Macros > Import new macro adds it to ParaView; Documentation/UserGuide/macros.md says more.
"""
import paraview

try:
    import lacuna.plugin
    lacuna.plugin.load()
    from lacuna import macros
except (ImportError, FileNotFoundError) as error:
    paraview.print_error(f"Lacuna's Python package or plugin is not found ({error}): start ParaView after '. lacuna-env.sh'")
else:
    macros.run(macros.report_implant)
