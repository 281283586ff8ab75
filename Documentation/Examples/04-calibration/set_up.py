# SPDX-License-Identifier: BSD-3-Clause
"""Draws set-up.svg: where transmitter, receiver, probe and metal belong, to scale (Carr 1996, figures 2.3, 2.4 and A.1).

    python3 set_up.py [folder for the drawing, default: .]
"""
import math
import os
import sys

SCALE = 0.52  # pixels of a mm
RANGE, RECEIVER, DEPTH = 760, 180, 120  # mm: specified range; receiver to transducer face (A.1: 180, at least 150); image
INK, FAINT, BLUE, RED, GREEN = "#20303c", "#7b8a94", "#2b5fb4", "#c0392b", "#2c8a3e"
ORIGIN = (470, 120)  # pixel of the transmitter


def at(x, down):
    """Pixel of a place so many mm to the right of and below the transmitter."""
    return ORIGIN[0] + SCALE * x, ORIGIN[1] + SCALE * down


class Drawing:
    def __init__(self):
        self.parts = []

    def put(self, text):
        self.parts.append(text)

    def text(self, place, words, size=16, color=INK, anchor="start", style=""):
        self.put(f'<text x="{place[0]:.1f}" y="{place[1]:.1f}" font-size="{size}" fill="{color}" text-anchor="{anchor}" {style}>{words}</text>')

    def shape(self, places, fill, stroke=INK, width=1.3, close=True, dash=""):
        points = " L".join(f"{x:.1f},{y:.1f}" for x, y in places)
        self.put(f'<path d="M{points}{" Z" if close else ""}" fill="{fill}" stroke="{stroke}" stroke-width="{width}" '
                 f'stroke-linejoin="round" stroke-dasharray="{dash}"/>')

    def box(self, x, down, width, height, fill, stroke=INK):
        """Middle and size in mm."""
        self.shape([at(x + i * width / 2, down + j * height / 2) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))], fill, stroke)

    def measure(self, start, end, words, offset, anchor="start"):
        """A line with two arrows between pixels, and its length in words beside its middle."""
        self.put(f'<line x1="{start[0]:.1f}" y1="{start[1]:.1f}" x2="{end[0]:.1f}" y2="{end[1]:.1f}" stroke="{BLUE}" stroke-width="1.8" '
                 'marker-start="url(#arrow)" marker-end="url(#arrow)"/>')
        self.text(((start[0] + end[0]) / 2 + offset[0], (start[1] + end[1]) / 2 + offset[1]), words, 15, BLUE, anchor)

    def write(self, name, width, height, title):
        with open(name, "w", encoding="utf-8") as file:
            file.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
                       "font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n"
                       "<!-- SPDX-License-Identifier: BSD-3-Clause; drawn by Documentation/Examples/04-calibration/set_up.py -->\n"
                       f'<title>{title}</title>\n<defs><marker id="arrow" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="9" '
                       f'markerHeight="9" orient="auto-start-reverse"><path d="M0,1.5 L9,5 L0,8.5 Z" fill="{BLUE}"/></marker></defs>\n'
                       f'<rect width="{width}" height="{height}" fill="#ffffff"/>\n' + "\n".join(self.parts) + "\n</svg>\n")


def main(folder):
    drawing = Drawing()
    # the hemisphere below the transmitter
    arc = [at(RANGE * math.cos(t), RANGE * math.sin(t)) for t in (math.pi * i / 90 for i in range(91))]
    drawing.shape(arc, "#eef4fb", BLUE, 1.5, dash="7 5")
    # wooden arm, transmitter, couch, patient
    drawing.box(-330, -50, 700, 22, "#e3cfa9")
    drawing.box(-680, 290, 24, 700, "#e3cfa9")
    drawing.text((at(-668, 60)[0] + 14, at(0, 75)[1]), "wood or plastic", 14, FAINT)
    drawing.box(0, -9, 53, 58, "#4a5866")
    drawing.text(at(45, -50), "transmitter, above: field downwards", 17, INK, style='font-weight="bold"')
    drawing.text(at(45, -14), "hemisphere (H command): towards the patient", 14, FAINT)
    drawing.box(0, 690, 1240, 60, "#d9dfe3")
    drawing.text(at(-600, 702), "couch without metal", 14, FAINT)
    body = [at(420 * math.cos(t), 625 + 105 * math.sin(t)) for t in (2 * math.pi * i / 80 for i in range(80))]
    drawing.shape([p for p in body if p[1] <= at(0, 660)[1]], "#f2d9c9")
    # probe with receiver, and its image
    face = 525
    drawing.shape([at(-50, face), at(50, face), at(72, face + DEPTH), at(-72, face + DEPTH)], "#3a4247", INK)
    drawing.text(at(0, face + 75), "image", 14, "#ffffff", "middle")
    drawing.shape([at(-45, face), at(45, face), at(34, face - 60), at(24, face - 120), at(-24, face - 120), at(-34, face - 60)], "#e8edf0")
    drawing.box(0, face - 148, 12, 56, "#e3cfa9")
    drawing.box(0, face - RECEIVER, 28, 20, "#f0c48a")
    drawing.text(at(28, face - RECEIVER - 18), "receiver, on a plastic mount", 17, INK, style='font-weight="bold"')
    drawing.text(at(48, face - 50), "probe", 16, INK)
    drawing.measure(at(160, face - RECEIVER), at(160, face), "150 mm and more", (10, -4))
    drawing.measure(at(-130, face - RECEIVER), at(-130, face + DEPTH), "to the deepest echo", (-10, -24), "end")
    drawing.text((at(-130, 0)[0] - 10, at(0, face - RECEIVER / 2 + DEPTH / 2)[1] - 5), "300 mm at most", 15, BLUE, "end")
    drawing.text((at(-130, 0)[0] - 10, at(0, face - RECEIVER / 2 + DEPTH / 2)[1] + 14), "(0.1° is 0.5 mm there)", 15, BLUE, "end")
    edge = at(-RANGE * math.cos(0.5), RANGE * math.sin(0.5))
    drawing.measure(at(-30, 18), edge, "0.76 m", (-8, -14), "end")
    # what does not belong here
    for x, down, width, height, words in ((960, 560, 90, 300, "trolley, scanner"), (960, 210, 120, 90, "screen")):
        drawing.box(x, down, width, height, "#f6dbd7", RED)
        for slope in (-1, 1):
            drawing.shape([at(x - width / 2, down - slope * height / 2), at(x + width / 2, down + slope * height / 2)], "none", RED, 1.6, close=False)
        drawing.text(at(x, down + height / 2 + 32), words, 15, RED, "middle")
    drawing.text(at(960, 60), "metal, power cables:", 16, RED, "middle", 'font-weight="bold"')
    drawing.text(at(960, 95), "out of the range", 16, RED, "middle")
    os.makedirs(folder, exist_ok=True)
    drawing.write(os.path.join(folder, "set-up.svg"), 1080, 560, "Transmitter, receiver, probe and metal")
    # drawn to scale
    assert abs(math.dist(at(0, 0), arc[30]) / SCALE - RANGE) < 1e-9
    assert RECEIVER + DEPTH == 300


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else ".")
