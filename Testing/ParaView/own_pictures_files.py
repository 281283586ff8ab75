# SPDX-License-Identifier: BSD-3-Clause
"""Pictures and tables as other programs write them, byte by byte: row 0 of an array is the top of a picture."""
import struct
import zlib

import numpy as np


def write_png(name, picture):
    """A grey (height, width) or colour (height, width, 3) picture of 8 bits."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    colour = 2 if picture.ndim == 3 else 0
    rows = b"".join(b"\0" + row.tobytes() for row in picture)
    with open(name, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n"
                   + chunk(b"IHDR", struct.pack(">IIBBBBB", picture.shape[1], picture.shape[0], 8, colour, 0, 0, 0))
                   + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def write_tiff(name, picture):
    """Grey, 8 bits, uncompressed, the usual orientation (top left)."""
    height, width = picture.shape
    tags = [(256, width), (257, height), (258, 8), (259, 1), (262, 1), (273, 8 + 2 + 12 * 9 + 4), (277, 1),
            (278, height), (279, picture.size)]
    with open(name, "wb") as file:
        file.write(b"II*\0" + struct.pack("<IH", 8, len(tags)))
        for tag, value in tags:
            file.write(struct.pack("<HHII", tag, 4, 1, value))
        file.write(struct.pack("<I", 0) + picture.tobytes())


def write_mha(name, stack):
    """A (slices, rows, columns) or (rows, columns) stack of 8 bits."""
    header = ["ObjectType = Image", f"NDims = {stack.ndim}", "BinaryData = True", "CompressedData = False",
              "ElementSpacing = " + " ".join(["0.3"] * stack.ndim),
              "DimSize = " + " ".join(map(str, stack.shape[::-1])), "ElementType = MET_UCHAR", "ElementDataFile = LOCAL"]
    with open(name, "wb") as file:
        file.write(("\n".join(header) + "\n").encode() + np.ascontiguousarray(stack).tobytes())


def write_dicom(name, picture, number):
    """A secondary capture of one grey frame without a position, as ultrasound is; explicit little endian."""
    def element(group, tag, kind, value):
        value += (b"\0" if kind == "UI" else b" ") * (len(value) % 2)
        if kind == "OB":
            return struct.pack("<HH2sHI", group, tag, kind.encode(), 0, len(value)) + value
        return struct.pack("<HH2sH", group, tag, kind.encode(), len(value)) + value

    def short(value):
        return struct.pack("<H", value)
    storage, instance = b"1.2.840.10008.5.1.4.1.1.7", b"1.2.3.4.%d" % number
    meta = (element(2, 2, "UI", storage) + element(2, 3, "UI", instance)
            + element(2, 0x10, "UI", b"1.2.840.10008.1.2.1"))
    data = (element(8, 0x16, "UI", storage) + element(8, 0x18, "UI", instance) + element(8, 0x60, "CS", b"US")
            + element(0x20, 0xd, "UI", b"1.2.3") + element(0x20, 0xe, "UI", b"1.2.3.5")
            + element(0x20, 0x13, "IS", str(number).encode())
            + element(0x28, 2, "US", short(1)) + element(0x28, 4, "CS", b"MONOCHROME2")
            + element(0x28, 0x10, "US", short(picture.shape[0])) + element(0x28, 0x11, "US", short(picture.shape[1]))
            + element(0x28, 0x100, "US", short(8)) + element(0x28, 0x101, "US", short(8))
            + element(0x28, 0x102, "US", short(7)) + element(0x28, 0x103, "US", short(0))
            + element(0x7fe0, 0x10, "OB", picture.tobytes()))
    with open(name, "wb") as file:
        file.write(b"\0" * 128 + b"DICM" + element(2, 0, "UL", struct.pack("<I", len(meta))) + meta + data)


def quaternion(rotation):
    """x y z w of a rotation matrix: the eigenvector of the largest eigenvalue of a symmetric matrix made of it."""
    r = rotation
    _, vectors = np.linalg.eigh(np.array([
        [r[0, 0] - r[1, 1] - r[2, 2], 0, 0, 0],
        [r[0, 1] + r[1, 0], r[1, 1] - r[0, 0] - r[2, 2], 0, 0],
        [r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], r[2, 2] - r[0, 0] - r[1, 1], 0],
        [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], np.trace(r)]]))
    return vectors[:, -1]


def euler(rotation):
    """Azimuth, elevation, roll in degrees of Rz(azimuth) Ry(elevation) Rx(roll)."""
    r = rotation
    return np.degrees([np.arctan2(r[1, 0], r[0, 0]), np.arcsin(-r[2, 0]), np.arctan2(r[2, 1], r[2, 2])])


def write_poses(name, pose_format, poses, unit=1.0, extra=None):
    """CSV of 4x4 poses in mm; unit: mm in one of the file's; extra: further columns {name: values}."""
    extra = extra or {}
    if pose_format == "Matrix":
        names = [f"m{r}{c}" for r in range(4) for c in range(4)]
    elif pose_format == "Quaternion":
        names = ["tx", "ty", "tz", "qx", "qy", "qz", "qw"]
    else:
        names = ["x", "y", "z", "azimuth", "elevation", "roll"]
    with open(name, "w", encoding="ascii") as file:
        file.write(",".join([*extra, *names]) + "\n")
        for number, pose in enumerate(poses):
            position = pose[:3, 3] / unit
            if pose_format == "Matrix":
                values = pose.copy()
                values[:3, 3] = position
            elif pose_format == "Quaternion":
                values = np.concatenate([position, quaternion(pose[:3, :3])])
            else:
                values = np.concatenate([position, euler(pose[:3, :3])])
            row = [str(column[number]) for column in extra.values()] + [repr(float(v)) for v in values.ravel()]
            file.write(",".join(row) + "\n")
