# SPDX-License-Identifier: BSD-3-Clause
"""check-docs.py finds what is wrong with pages, and nothing else."""
from checkers import complaints

GOOD = """# One page
See [the other](Documentation/other.md#a-heading-of-two-words), [here](#one-page), <https://example.org>
and [there](https://example.org/missing.md). ![picture](Documentation/a.png "title")
Code is no link: `[x](missing.md)`.
```python
array[0](missing.md)
```
"""


def check(page, files=()):
    return complaints("check-docs.py", {"page.md": page, "Documentation/other.md": "## A heading, of *two* words\n[back](../page.md)\n",
                                        "Documentation/a.png": "", **dict.fromkeys(files, "")})


assert check(GOOD) == "", check(GOOD)
assert "page.md: 'gone.md' leads to no file" in check(GOOD + "[x](gone.md)")
assert "page.md: 'pictures/gone.png' leads to no file" in check(GOOD + '<img src="pictures/gone.png">')
assert "has no such heading" in check(GOOD + "[x](Documentation/other.md#another)")
assert "has no such heading" in check(GOOD + "[x](#another)")
assert "Documentation/b.png: no page shows this picture" in check(GOOD, ["Documentation/b.png"])
print("ok")
