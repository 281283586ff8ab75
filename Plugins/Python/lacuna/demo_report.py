# SPDX-License-Identifier: BSD-3-Clause
"""The demo's report: numbers, pictures, comparisons with the truth, and a first line that says whether all is well."""
import base64
import contextlib
import html
import os
import time

from lacuna.files import writing

STYLE = """body { font: 16px/1.5 sans-serif; max-width: 1100px; margin: 2em auto; padding: 0 1em; color: #222 }
img { max-width: 100%; border: 1px solid #ddd } table { border-collapse: collapse; margin: 1em 0 }
td, th { border: 1px solid #ccc; padding: .25em .7em; text-align: left } .well { background: #e3f3e3; padding: .7em 1em }
.not-well { background: #fbe3e0; padding: .7em 1em } .unknown { background: #eef; padding: .7em 1em }"""


class Report:
    """Collects numbers, pictures and the seconds of each stage, and says which stage failed."""

    def __init__(self):
        self.sections = []
        self.stages = []
        self.pictures = {}  # title of a section: [(file, caption)]
        self.compared = []  # (what, result, truth, difference, allowed, whether it is well)
        self.faults = []

    @contextlib.contextmanager
    def stage(self, name):
        from lacuna.errors import raising
        print(f"== {name}", flush=True)
        started = time.perf_counter()
        warnings = []
        try:
            with raising(warnings):
                yield
        except Exception as error:
            raise SystemExit(f"demo.sh: stage '{name}' failed: {error}") from error
        for warning in dict.fromkeys(warnings):
            print(f"   note: {warning}", flush=True)
        self.stages.append((name, time.perf_counter() - started))

    def section(self, title):
        self.sections.append((title, []))

    def add(self, what, value):
        self.sections[-1][1].append((what, value))
        print(f"   {what}: {value}", flush=True)

    def get(self, what):
        """The value added last under a name."""
        return [value for _, rows in self.sections for name, value in rows if name == what][-1]

    def picture(self, name, caption):
        """Shows a picture of the output folder in the present section."""
        self.pictures.setdefault(self.sections[-1][0], []).append((name, caption))

    def compare(self, what, result, truth, difference, allowed, well):
        """A result beside the truth, all but the last as texts; well: whether the difference is no more than what is allowed."""
        self.compared.append((what, result, truth, difference, allowed, well))

    def require(self, well, fault):
        """Notes a fault, a sentence's part, unless all is well."""
        if not well:
            self.faults.append(fault)

    def verdict(self):
        """Whether all is well (None where there is no truth to compare with), and a sentence for the first line."""
        bad = self.faults + [f"{what} is off by {difference}, more than {allowed}" for what, _, _, difference, allowed, well in self.compared if not well]
        if bad:
            return False, "Not all is well: " + "; ".join(bad) + "."
        if not self.compared:
            return None, "Done. There is no truth to compare these data with: check the pictures and numbers below."
        return True, "All is well: " + "; ".join(f"{what} differs from the truth by {difference}"
                                                 for what, _, _, difference, _, _ in self.compared) + "."

    def tables(self):
        """Title, head and rows of each table, texts all; sections first."""
        for title, rows in self.sections:
            yield title, ("quantity", "value"), rows
        if self.compared:
            yield "Compared with the truth", ("quantity", "result", "truth", "difference", "allowed", "well?"), [
                (*rest, "yes" if well else "NO") for *rest, well in self.compared]
        yield "Seconds per stage", ("stage", "s"), [(stage, f"{seconds:.2f}") for stage, seconds in self.stages]

    def write(self, folder, version):
        """Writes report.md, and report.html with the pictures in it. Returns the name of the latter."""
        title = f"Lacuna {version}: demo report"
        well, sentence = self.verdict()
        text = f"**{sentence}**\n\n# {title}\n"
        page = (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title><style>{STYLE}</style></head><body>\n'
                f'<p class="{ {True: "well", False: "not-well", None: "unknown"}[well]}"><strong>{html.escape(sentence)}</strong></p>\n'
                f"<h1>{title}</h1>\n")
        for name, head, rows in self.tables():
            text += f"\n## {name}\n"
            page += f"<h2>{name}</h2>\n"
            for file, caption in self.pictures.get(name, []):
                text += f"\n![{caption}]({file})\n\n{caption}\n"
                with open(os.path.join(folder, file), "rb") as picture:
                    pixels = base64.b64encode(picture.read()).decode()
                page += (f'<figure><img alt="{html.escape(caption)}" src="data:image/png;base64,{pixels}">'
                         f"<figcaption>{html.escape(caption)}</figcaption></figure>\n")
            text += "\n| " + " | ".join(head) + " |\n|" + "---|" * len(head) + "\n"
            text += "".join("| " + " | ".join(map(str, row)) + " |\n" for row in rows)
            page += "<table><tr>" + "".join(f"<th>{each}</th>" for each in head) + "</tr>\n" + "".join(
                "<tr>" + "".join(f"<td>{html.escape(str(each))}</td>" for each in row) + "</tr>\n" for row in rows) + "</table>\n"
        page += "<p>Research software, not a medical device.</p>\n</body></html>\n"
        for name, content in (("report.md", text), ("report.html", page)):
            with writing(os.path.join(folder, name)) as aside, open(aside, "w", encoding="utf-8") as file:
                file.write(content)
        return os.path.join(folder, "report.html")
