# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx's settings of the site. build-site.sh gives the version."""
project = "Lacuna"
extensions = ["myst_parser"]
myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 4
highlight_language = "none"
smartquotes = False

html_theme = "furo"
html_title = "Lacuna"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0f6e8c", "color-brand-content": "#0b6480"},
    "dark_css_variables": {"color-brand-primary": "#6cc5df", "color-brand-content": "#6cc5df"},
}
