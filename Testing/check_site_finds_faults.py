# SPDX-License-Identifier: BSD-3-Clause
"""check-site.py finds links of a built site that lead nowhere and files of other machines, and nothing else."""
from checkers import complaints

GOOD = """<a href="sub/other.html#place">x</a> <a href="#here">y</a> <p id="here"></p> <a href="https://example.org/gone">z</a>
<img src="a%20b.png"> <link rel="stylesheet" href="site.css?1"> <script src="javascript:void(0)"></script>"""


def check(page=GOOD, css="p { background: url(data:image/png;base64,x) } i { background: url('a b.png') }"):
    return complaints("check-site.py", {"index.html": page, "sub/other.html": '<h2 id="place">x</h2><a href="../index.html">b</a>',
                                        "a b.png": "", "site.css": css})


assert check() == "", check()
assert "index.html: 'gone.html' leads to no file" in check(GOOD + '<a href="gone.html">x</a>')
assert "index.html: 'gone.png' leads to no file" in check(GOOD + '<img src="gone.png">')
assert "leads to no such place" in check(GOOD + '<a href="sub/other.html#gone">x</a>')
assert "index.html: loads https://example.org/a.js" in check(GOOD + '<script src="https://example.org/a.js"></script>')
assert "site.css: loads gone.png" in check(css="p { background: url(gone.png) }")
assert "site.css: loads /a.css" in check(css="@import url(/a.css);")
print("ok")
