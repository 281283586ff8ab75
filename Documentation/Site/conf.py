# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx's settings of the site. build-site.sh gives the version."""
import os
import re
import shutil

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


def mend_theme(app, exception):
    """Debian's furo takes a file from the root of a web server, and has lost the colours for devices that ask for dark pages."""
    styles = os.path.join(app.outdir, "_static", "styles")
    if exception or not os.path.isdir(styles):
        return
    shutil.copy("/usr/share/javascript/normalize.css/normalize.css", styles)
    with open(os.path.join(styles, "furo.css"), "r+", encoding="utf-8") as file:
        css = file.read().replace("url(/javascript/normalize.css/", "url(")
        if "prefers-color-scheme" not in css:
            dark = re.search(r'body\[data-theme="dark"\] (\{\s*--color-problematic.*?\})', css, re.DOTALL).group(1)
            css += f'@media screen and (prefers-color-scheme: dark) {{ body:not([data-theme="light"]) {dark} }}\n'
        file.seek(0)
        file.write(css)
        file.truncate()


def setup(app):
    app.connect("build-finished", mend_theme)
