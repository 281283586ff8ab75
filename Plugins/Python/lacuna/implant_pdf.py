# SPDX-License-Identifier: BSD-3-Clause
"""The report of lacuna.implant_report as a PDF of A4 pages, by matplotlib."""
import textwrap

WIDTH, HEIGHT = 210 / 25.4, 297 / 25.4  # inches, A4
MARGIN = 18 / 25.4
POINT = 1 / 72  # inch
LETTER = 0.53  # mean width of a letter, of its size
COLORS = {"notice": ("#f3f4f6", "#7a8594"), "warning": ("#fff3e0", "#d97706"), "fine": ("#edf7ee", "#3c8c4a")}


def write(path, content, folder):
    """Writes a PDF.

    path: of the file. content: of implant_report.content. folder: that of the pictures. Raises ImportError without matplotlib (Debian:
    python3-matplotlib).
    """
    import matplotlib
    from matplotlib.backends.backend_pdf import PdfPages
    with matplotlib.rc_context({"pdf.fonttype": 42}), PdfPages(path, metadata={"Title": content.title, "Creator": "Lacuna", "CreationDate": None}) as pages:
        sheet = _Sheet(pages, content.foot)
        sheet.text(content.title, size=18, bold=True)
        sheet.text(content.subject)
        sheet.box(content.notice, "notice")
        for warning in content.warnings or ["No warnings."]:
            sheet.box(warning, "warning" if content.warnings else "fine")
        sheet.pictures(folder, content.pictures, 2)
        sheet.text(content.letters, size=8)
        sheet.heading("Numbers")
        for name, value in content.rows:
            sheet.row(name, value)
        for paragraph in content.explanations:
            sheet.text(paragraph, size=8)
        sheet.heading("From six sides")
        sheet.pictures(folder, content.sides, 3)
        sheet.heading("Before anything is made")
        for check in content.checks:
            sheet.text("•  " + check)
        sheet.heading("Where this comes from")
        sheet.text(content.origin, size=8)
        for number, step in enumerate(content.steps, 1):
            sheet.text(f"{number}.  {step}", size=6.5, family="monospace")
        sheet.close()


class _Sheet:
    """Fills pages from above."""

    def __init__(self, pages, foot):
        self.pages, self.foot = pages, foot
        self.figure = None
        self.number = 0
        self._turn()

    def _turn(self):
        from matplotlib.figure import Figure
        self.close()
        self.number += 1
        self.figure = Figure(figsize=(WIDTH, HEIGHT))
        self.left = HEIGHT - MARGIN  # inches above the lower edge
        self._put(MARGIN, MARGIN / 2, f"{self.foot} · page {self.number}", 7, color="#666666")

    def close(self):
        if self.figure is not None:
            self.pages.savefig(self.figure)
            self.figure = None

    def _put(self, x, y, text, size, **how):
        self.figure.text(x / WIDTH, y / HEIGHT, text, fontsize=size, parse_math=False, **how)

    def _need(self, height):
        if self.left - height < MARGIN:
            self._turn()

    def text(self, paragraph, size=9.5, bold=False, family="sans-serif", indent=0.0, width=WIDTH - 2 * MARGIN):
        """Lines of a paragraph, over pages as they come."""
        letter = 0.61 if family == "monospace" else LETTER
        for line in textwrap.wrap(paragraph, int((width - indent) / (letter * size * POINT))) or [""]:
            self._need(1.4 * size * POINT)
            self.left -= 1.4 * size * POINT
            self._put(MARGIN + indent, self.left, line, size, weight="bold" if bold else "normal", family=family)
        self.left -= 0.4 * size * POINT

    def heading(self, text):
        self._need(1.2)
        self.left -= 0.15
        self.text(text, size=13, bold=True)

    def box(self, paragraph, kind, size=9):
        from matplotlib.patches import Rectangle
        lines = textwrap.wrap(paragraph, int((WIDTH - 2 * MARGIN - 0.3) / (LETTER * size * POINT)))
        height = (1.4 * len(lines) + 0.8) * size * POINT
        self._need(height)
        self.left -= height
        fill, edge = COLORS[kind]
        for x, width, color in ((0, WIDTH - 2 * MARGIN, fill), (0, 0.06, edge)):
            self.figure.add_artist(Rectangle(((MARGIN + x) / WIDTH, self.left / HEIGHT), width / WIDTH, height / HEIGHT, color=color,
                                             transform=self.figure.transFigure))
        for k, line in enumerate(lines):
            self._put(MARGIN + 0.18, self.left + height - (1.4 * (k + 1) + 0.2) * size * POINT, line, size)
        self.left -= 0.08

    def row(self, name, value, size=8.5):
        """A row of a table: its value may have several lines."""
        column = 2.9
        names = textwrap.wrap(name, int((column - 0.1) / (LETTER * size * POINT)))
        values = textwrap.wrap(value, int((WIDTH - 2 * MARGIN - column) / (LETTER * size * POINT)))
        height = 1.4 * max(len(names), len(values)) * size * POINT + 0.05
        self._need(height)
        for k in range(max(len(names), len(values))):
            y = self.left - 1.4 * (k + 1) * size * POINT
            for x, texts in ((0, names), (column, values)):
                if k < len(texts):
                    self._put(MARGIN + x, y, texts[k], size)
        self.left -= height
        from matplotlib.lines import Line2D
        self.figure.add_artist(Line2D([MARGIN / WIDTH, 1 - MARGIN / WIDTH], [self.left / HEIGHT] * 2, color="#d8dce2", linewidth=0.5,
                                      transform=self.figure.transFigure))

    def pictures(self, folder, files, columns):
        """Pictures (file, title) side by side."""
        import os

        from matplotlib.image import imread
        gap = 0.12
        width = (WIDTH - 2 * MARGIN - (columns - 1) * gap) / columns
        for first in range(0, len(files), columns):
            images = [(imread(os.path.join(folder, name)), title) for name, title in files[first:first + columns]]
            height = max(width * image.shape[0] / image.shape[1] for image, _ in images)
            self._need(height + 0.3)
            self.left -= height
            for k, (image, title) in enumerate(images):
                x = MARGIN + k * (width + gap)
                axes = self.figure.add_axes([x / WIDTH, self.left / HEIGHT, width / WIDTH, width * image.shape[0] / image.shape[1] / HEIGHT])
                axes.imshow(image, aspect="auto", interpolation="none")
                axes.set_xticks([])
                axes.set_yticks([])
                for spine in axes.spines.values():
                    spine.set_color("#d8dce2")
                self._put(x, self.left - 0.16, title, 8, color="#444444")
            self.left -= 0.3
