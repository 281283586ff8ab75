// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The images of a DICOM file, single or multi-frame.
#ifndef lacunaDicomHeader_h
#define lacunaDicomHeader_h

#include "lacunaCTFrame.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lacuna
{
/// One frame for each image of a file: of ordinary CT files one, of enhanced CT as many as it says,
/// each with the values of its functional groups. Of a file that holds no image (a report, a folder
/// record) one without pixels. Throws std::runtime_error naming the file and what is wrong when it
/// cannot be understood or says two things; pixels that are missing, cut off, of another amount than
/// its numbers of rows, columns and frames take, or without valid bits are noted in PixelError of a
/// single frame instead.
std::vector<CTFrame> ReadDicomFrames(const std::string& path);

/// How many bytes a frame has in its file.
std::int64_t GetDicomSize(const CTFrame& frame);

/// Those bytes: pixels in the machine's byte order, or a compressed stream. Throws std::runtime_error
/// naming the file when they cannot be read.
void ReadDicomBytes(const CTFrame& frame, unsigned char* bytes);
}
#endif
