# SPDX-License-Identifier: BSD-3-Clause
"""Charts of lacuna.pictures: no piece of a label's last letter stands before it, as VTK's own labels have it."""
import numpy as np
from lacuna import pictures

WHITE, INK = 250, 160
size, count = (760, 460), 0
picture = pictures.chart_pixels([("line", [0, 60], [0, 4], (40, 90, 190), "line")], ("", ""), size, ((0, 60), (0, 4)), legend=False)
dark = picture.min(axis=2)
axis = int(np.argmax((dark < 60).sum(axis=1)))  # the row of the lower axis
strip = dark[axis + 8:].min(axis=0)  # the labels below its ticks, as columns
drawn = np.flatnonzero(strip < WHITE)
for letters in np.split(drawn, np.flatnonzero(np.diff(drawn) > 1) + 1):
    count += 1
    assert strip[letters].min() < INK, (letters, strip[letters])
assert count >= 13, count  # 0 5 10 ... 60
