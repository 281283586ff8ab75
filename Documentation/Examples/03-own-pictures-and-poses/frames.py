# SPDX-License-Identifier: BSD-3-Clause
"""Draws frames.svg: the coordinate frames of a tracked slice, and what each matrix maps.

    python3 frames.py [file to write, default: frames.svg]

The drawing is a parallel projection of a true scene: all axes are right-handed.
"""
import math
import sys

WIDTH, HEIGHT = 980, 600
INK, FAINT = "#20303c", "#7b8a94"
X, Y, Z = "#c8373c", "#2c8a3e", "#2b66c4"
WAYS = {"ImageToProbe": "#b0520f", "ProbeToReference": "#6b3fa0", "ImageToReference": "#5b6b75"}


def add(*vectors):
    return tuple(sum(parts) for parts in zip(*vectors))


def scale(factor, vector):
    return tuple(factor * part for part in vector)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(vector):
    return scale(1 / math.sqrt(sum(part * part for part in vector)), vector)


def project(point):
    """The reference frame's x to the right, y away from the viewer, z up, seen from above."""
    x, y, z = point
    return 120 + x + 0.42 * y, 470 + 0.10 * x - 0.30 * y - z


def path(points, close=False):
    return "M" + " L".join("%.1f,%.1f" % project(p) for p in points) + (" Z" if close else "")


class Drawing:
    def __init__(self):
        self.parts = []

    def put(self, text):
        self.parts.append(text)

    def text(self, x, y, words, size=17, color=INK, anchor="start", style=""):
        self.put(f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{color}" text-anchor="{anchor}" {style}>{words}</text>')

    def face(self, points, fill, stroke=INK):
        self.put(f'<path d="{path(points, True)}" fill="{fill}" stroke="{stroke}" stroke-width="1.2" stroke-linejoin="round"/>')

    def box(self, center, axes, sizes, fills):
        """A box whose faces towards the viewer are drawn: those along -y, +x and +z."""
        a, b, c = (scale(s / 2, v) for s, v in zip(sizes, axes))
        corner = lambda i, j, k: add(center, scale(i, a), scale(j, b), scale(k, c))
        self.face([corner(-1, -1, -1), corner(1, -1, -1), corner(1, -1, 1), corner(-1, -1, 1)], fills[0])
        self.face([corner(-1, -1, 1), corner(1, -1, 1), corner(1, 1, 1), corner(-1, 1, 1)], fills[1])
        self.face([corner(1, -1, -1), corner(1, 1, -1), corner(1, 1, 1), corner(1, -1, 1)], fills[2])

    def arrow(self, start, end, color, width=2.6):
        (x0, y0), (x1, y1) = project(start), project(end)
        self.put(f'<line x1="{x0:.1f}" y1="{y0:.1f}" x2="{x1:.1f}" y2="{y1:.1f}" stroke="{color}" stroke-width="{width}" marker-end="url(#head{color[1:]})"/>')
        return x1, y1

    def axes(self, origin, directions, length, names):
        for direction, color, (name, dx, dy) in zip(directions, (X, Y, Z), names):
            x, y = self.arrow(origin, add(origin, scale(length, direction)), color)
            self.text(x + dx, y + dy, name, 15, color, "middle", 'font-style="italic"')
        x, y = project(origin)
        self.put(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{INK}"/>')

    def way(self, name, start, bend, end, label, anchor="middle", dashed=False):
        """A bowed arrow from one frame to another."""
        color = WAYS[name]
        dash = 'stroke-dasharray="7 5"' if dashed else ""
        self.put(f'<path d="M{start[0]},{start[1]} Q{bend[0]},{bend[1]} {end[0]},{end[1]}" fill="none" stroke="{color}" stroke-width="3" {dash} marker-end="url(#head{color[1:]})"/>')
        self.text(*label, name, 18, color, anchor, 'font-weight="bold"')

    def write(self, name):
        heads = "".join(
            f'<marker id="head{c[1:]}" viewBox="0 0 10 10" refX="8" refY="5" markerWidth="{w}" markerHeight="{w}" orient="auto-start-reverse" markerUnits="userSpaceOnUse"><path d="M0,1 L9,5 L0,9 Z" fill="{c}"/></marker>'
            for c, w in ((X, 12), (Y, 12), (Z, 12), (INK, 12), *((c, 16) for c in WAYS.values())))
        with open(name, "w", encoding="utf-8") as file:
            file.write(
                f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" font-family="Helvetica, Arial, \'DejaVu Sans\', sans-serif">\n'
                "<!-- SPDX-License-Identifier: BSD-3-Clause; drawn by Documentation/Examples/03-own-pictures-and-poses/frames.py -->\n"
                "<title>Coordinate frames of a tracked slice</title>\n"
                f'<defs>{heads}<linearGradient id="scan" x1="0" y1="0" x2="0" y2="1"><stop offset="0" stop-color="#8d959b"/><stop offset="1" stop-color="#3a4247"/></linearGradient></defs>\n'
                f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>\n' + "\n".join(self.parts) + "\n</svg>\n")


def main(name):
    drawing = Drawing()
    # the reference: a sensor on the patient, or the tracker itself
    reference = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    drawing.box((22, 22, -20), reference, (70, 70, 34), ("#c9d2d8", "#e6ebee", "#aab5bc"))
    drawing.axes((0, 0, 0), reference, 105, (("x", 13, 6), ("y", 12, -4), ("z", 0, -9)))
    drawing.text(45, 540, "Reference", 20, INK, "start", 'font-weight="bold"')
    drawing.text(45, 560, "sensor on the patient,", 14, FAINT)
    drawing.text(45, 577, "or the tracker; mm", 14, FAINT)

    # the image hangs below the probe: columns to the right, rows into the tissue
    columns, rows = unit((1, 0.22, 0)), (0, 0, -1)
    across = cross(columns, rows)
    corner = (330, 150, 215)
    size = (250, 220)
    at = lambda c, r: add(corner, scale(c, columns), scale(r, rows))
    drawing.face([at(0, 0), at(size[0], 0), at(*size), at(0, size[1])], "url(#scan)")
    ring = [at(130 + 62 * math.cos(t) + 12 * math.sin(t), 125 + 46 * math.sin(t) - 8 * math.cos(t))
            for t in (2 * math.pi * i / 60 for i in range(60))]
    drawing.face(ring, "#b9c0c4", "none")
    dot = [at(160 + 17 * math.cos(t), 108 + 13 * math.sin(t)) for t in (2 * math.pi * i / 40 for i in range(40))]
    drawing.face(dot, "#e9ecee", "none")
    drawing.arrow(at(0, 0), at(size[0] + 42, 0), X)
    drawing.arrow(at(0, 0), at(0, size[1] + 34), Y)
    x, y = project(at(size[0] + 42, 0))
    drawing.text(x + 6, y + 2, "column", 16, X, "start", 'font-style="italic"')
    x, y = project(at(0, size[1] + 34))
    drawing.text(x, y + 20, "row", 16, Y, "middle", 'font-style="italic"')
    x, y = project(at(0, 0))
    drawing.put(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{INK}"/>')
    drawing.text(x - 10, y + 5, "(0, 0)", 15, INK, "end")
    pixel = at(95, 170)
    for a in (at(0, 170), at(95, 0)):
        drawing.put(f'<path d="{path([a, pixel])}" stroke="#ffffff" stroke-width="1.2" stroke-dasharray="3 3" fill="none"/>')
    x, y = project(pixel)
    drawing.put(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="#ffd23f" stroke="{INK}"/>')
    drawing.text(x + 10, y + 18, "pixel (column, row)", 14, "#ffffff")
    x, y = project(at(size[0], size[1]))
    drawing.text(x + 8, y - 30, "Image", 20, INK, "start", 'font-weight="bold"')
    drawing.text(x + 8, y - 10, "pixels of", 14, FAINT)
    drawing.text(x + 8, y + 7, "PixelSpacing mm", 14, FAINT)

    # the probe with its sensor
    up = scale(-1, rows)
    middle = at(size[0] / 2, 0)
    body = (columns, across, up)
    drawing.box(add(middle, scale(26, up)), body, (150, 40, 44), ("#dfe4e7", "#f3f5f6", "#c3ccd1"))
    drawing.box(add(middle, scale(83, up)), body, (80, 34, 70), ("#d3dade", "#eef1f3", "#b8c2c8"))
    sensor = add(middle, scale(132, up))
    tilt = math.radians(20)
    sx = unit(add(scale(math.cos(tilt), columns), scale(math.sin(tilt), across)))
    sy = unit(cross(up, sx))
    drawing.box(add(sensor, scale(2, up)), (sx, sy, up), (40, 34, 26), ("#f0c48a", "#f8dcb4", "#d9a662"))
    drawing.axes(add(sensor, scale(2, up)), (sx, sy, up), 78, (("x", 13, 6), ("y", -9, -4), ("z", 0, -8)))
    x, y = project(sensor)
    drawing.text(x + 112, y - 44, "Probe", 20, INK, "start", 'font-weight="bold"')
    drawing.text(x + 112, y - 25, "the tracker's sensor", 14, FAINT)
    drawing.text(x + 112, y - 8, "on the probe; mm", 14, FAINT)

    drawing.way("ImageToProbe", (784, 390), (880, 240), (680, 121), (834, 186), "start")
    drawing.text(834, 205, "calibration, constant", 14, FAINT)
    drawing.way("ProbeToReference", (622, 108), (300, 52), (140, 338), (262, 150), "end")
    drawing.text(262, 169, "measured for each slice", 14, FAINT, "end")
    drawing.way("ImageToReference", (500, 400), (380, 500), (262, 478), (372, 515), "middle", True)
    drawing.text(372, 533, "the result", 14, FAINT, "middle")
    drawing.text(560, 584, "x<tspan dy='4' font-size='12'>Reference</tspan><tspan dy='-4' dx='4'> = ProbeToReference · ImageToProbe · (column, row, 0, 1)</tspan>", 18, INK, "middle")
    drawing.write(name)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "frames.svg")
