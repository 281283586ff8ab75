# SPDX-License-Identifier: BSD-3-Clause
"""The lag of a simulated video is found from a probe that is moved to and fro above the floor of a bath.

    pvpython temporal_calibration.py [folder for the picture, default: .]

temporal.png: on the left the floor's row in the images and the height that the tracker gives, as recorded; on the right how
well they fit at each lag.
"""
import os
import sys

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
import scans
from lacuna import pictures
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

LATE = 0.120  # s
BLUE, RED, GREY = (40, 90, 190), (200, 70, 40), (110, 120, 130)


def height(time):
    """To and fro, about once in a second and never quite the same, mm."""
    return 9 * np.sin(6.3 * time) + 4 * np.sin(4.1 * time + 1) + 1.5 * np.sin(9.7 * time + 2)


def scan(time):
    """Image in mm to phantom, the floor in its middle."""
    turn = scans.rotation([0, 1, 0], 6) @ np.column_stack([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    return scans.pose(turn, [0, 0, 40 + height(time)])


def main(folder):
    os.makedirs(folder, exist_ok=True)
    random = np.random.default_rng(1)
    times = 2 + np.arange(200) / 25
    poses = [scans.probe_to_tracker(scan(time)) for time in times]
    images = [scans.floor_picture(scan(time - LATE), random) for time in times]
    lag = TemporalCalibration(Input=scans.slices(images, poses, times))
    lag.UpdatePipeline()
    table = scans.fetch(lag)
    found, spread = -scans.figure(table, "TimeOffset"), scans.figure(table, "LagSpread")
    print(f"lag {1000 * found:.1f} ms (truth {1000 * LATE:.0f}), standard deviation {1000 * spread:.2f} ms", flush=True)
    assert abs(found - LATE) < 0.002

    # where the floor is in the middle column: the brightest row, for the picture
    rows = np.array([image[:, scans.WIDTH // 2 - 3:scans.WIDTH // 2 + 4].mean(axis=1).argmax() for image in images])
    seen = rows * scans.SPACING
    tracked = np.array([height(time) for time in times])
    part = slice(0, 88)
    level = np.median(seen) - np.median(tracked)
    left = pictures.chart_pixels(
        [("floor in the image (depth, mm)", times[part] - 2, seen[part], BLUE, "line"),
         ("receiver (height, mm)", times[part] - 2, tracked[part] + level, RED, "line")],
        ("time (s)", "mm"), (620, 400), ((0, 3.5), (20, 75)))
    lags, fits = (vtk_to_numpy(table.GetColumnByName(name)) for name in ("Lag", "Correlation"))
    right = pictures.chart_pixels(
        [("correlation", 1000 * lags, fits, GREY, "line"),
         ("best", [1000 * found], [scans.figure(table, "Correlation")], RED, "points")],
        ("lag (ms)", "correlation"), (500, 400), ((-500, 500), (0, 1.05)), legend=False)
    titled = [("as recorded", left), (f"how well they fit at each lag; best at {1000 * found:.1f} ms", right)]
    pictures.write_pixels(os.path.join(folder, "temporal.png"), pictures.side_by_side(titled, gap=14))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else ".")
