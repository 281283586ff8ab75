# SPDX-License-Identifier: BSD-3-Clause
"""DICOM series that tests write, without a library: uncompressed CT slices."""
import os
import struct

import numpy as np


def _element(group, number, kind, value):
    if isinstance(value, str):
        value = value.encode("ascii")
        value += (b"\0" if kind == "UI" else b" ") * (len(value) % 2)
    if kind in ("OB", "OW"):
        return struct.pack("<HH2sHI", group, number, kind.encode("ascii"), 0, len(value)) + value
    return struct.pack("<HH2sH", group, number, kind.encode("ascii"), len(value)) + value


def write_series(folder, values, matrix=np.eye(4)):
    """Writes values (int16, by k, j, i), a file a slice, into a folder that exists. matrix: index i, j, k -> patient mm (LPS)."""
    def number(value):
        return struct.pack("<H", value)

    def numbers(*values):
        return "\\".join(f"{value:.10g}" for value in values)
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    axes = matrix[:3, :3] / spacing
    for n, pixels in enumerate(values):
        own = f"1.2.3.4.{n + 1}"
        meta = b"".join([_element(2, 1, "OB", b"\0\1"), _element(2, 2, "UI", "1.2.840.10008.5.1.4.1.1.2"), _element(2, 3, "UI", own),
                         _element(2, 0x10, "UI", "1.2.840.10008.1.2.1"), _element(2, 0x12, "UI", "1.2.3")])
        data = b"".join([
            _element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2"), _element(8, 0x18, "UI", own), _element(8, 0x60, "CS", "CT"),
            _element(0x18, 0x50, "DS", numbers(spacing[2])), _element(0x18, 0x5100, "CS", "HFS"), _element(0x20, 0xD, "UI", "1.2.3.5"),
            _element(0x20, 0xE, "UI", "1.2.3.6"), _element(0x20, 0x13, "IS", str(n + 1)),
            _element(0x20, 0x32, "DS", numbers(*(matrix @ [0, 0, n, 1])[:3])),
            _element(0x20, 0x37, "DS", numbers(*axes[:, 0], *axes[:, 1])), _element(0x20, 0x52, "UI", "1.2.3.7"),
            _element(0x28, 2, "US", number(1)), _element(0x28, 4, "CS", "MONOCHROME2"), _element(0x28, 0x10, "US", number(pixels.shape[0])),
            _element(0x28, 0x11, "US", number(pixels.shape[1])), _element(0x28, 0x30, "DS", numbers(spacing[1], spacing[0])),
            _element(0x28, 0x100, "US", number(16)), _element(0x28, 0x101, "US", number(16)), _element(0x28, 0x102, "US", number(15)),
            _element(0x28, 0x103, "US", number(1)), _element(0x28, 0x1052, "DS", "0"), _element(0x28, 0x1053, "DS", "1"),
            _element(0x28, 0x1054, "LO", "HU"), _element(0x7FE0, 0x10, "OW", np.asarray(pixels, "<i2").tobytes())])
        with open(os.path.join(folder, f"{n:03}.dcm"), "wb") as file:
            file.write(bytes(128) + b"DICM" + _element(2, 0, "UL", struct.pack("<I", len(meta))) + meta + data)
