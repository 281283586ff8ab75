# SPDX-License-Identifier: BSD-3-Clause
"""Poses for lacuna-fastrak-emulator with which its floor can calibrate a probe: 44 places, the probe held still at each for 0.5 s.

    pvpython floor_poses.py [folder for floor-poses.txt, default: .]

To be given as --poses, with --aim 0 --scene Floor --linear 60 --bare (see the guide's page on emulated devices).
"""
import os
import sys

import numpy as np
from scans import pose, rotation

PLACES, HOLD, WAY = 44, 0.5, 0.15  # s at each place, and from one to the next
DEPTH, FLOOR = 60, 40  # mm below the transducer's face: of the image, and of the floor when the probe looks straight at it
FIRST = pose(origin=(300, 20, 60))  # the receiver at that instant

# The emulated probe: transducer face (x along it, y into the image) to receiver.
AXES = np.column_stack([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
FACE_TO_RECEIVER = pose(rotation([0, 0, 1], 5) @ rotation([0, 1, 0], -8) @ rotation([1, 0, 0], 3) @ AXES, (18, -12, 74))


def face_motions(random):
    """Of the face, in its coordinates at first: turned about a point of the floor, moved over it, nearer and further."""
    yield np.eye(4)
    about = pose(origin=(0, FLOOR, 0))
    for _ in range(PLACES - 1):
        turn = rotation([0, 1, 0], random.uniform(0, 360)) @ rotation([1, 0, 0], random.uniform(-35, 35)) @ rotation([0, 0, 1], random.uniform(-35, 35))
        shift = random.uniform([-20, -12, -20], [20, 5, 20])
        yield pose(origin=shift) @ about @ pose(turn) @ np.linalg.inv(about)


def angles(turn):
    """Azimuth, elevation and roll in degrees, as a FASTRAK gives them."""
    return np.degrees([np.arctan2(turn[1, 0], turn[0, 0]), -np.arcsin(np.clip(turn[2, 0], -1, 1)), np.arctan2(turn[2, 1], turn[2, 2])])


def main(folder):
    os.makedirs(folder, exist_ok=True)
    lines, time = ["# time station x y z azimuth elevation roll (s, mm, degrees)"], 0
    for motion in face_motions(np.random.default_rng(5)):
        # the floor crosses the middle of the image
        depth = (FLOOR - motion[1, 3]) / motion[1, 1]
        assert 10 < depth < DEPTH, depth
        receiver = FIRST @ FACE_TO_RECEIVER @ motion @ np.linalg.inv(FACE_TO_RECEIVER)
        numbers = " ".join(f"{x:.6f}" for x in (*receiver[:3, 3], *angles(receiver[:3, :3])))
        lines += [f"{time:.3f} 1 {numbers}", f"{time + HOLD:.3f} 1 {numbers}"]
        time += HOLD + WAY
    with open(os.path.join(folder, "floor-poses.txt"), "w") as file:
        file.write("\n".join(lines) + "\n")
    print(f"{PLACES} places, {time:.1f} s")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else ".")
