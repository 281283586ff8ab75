// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Frames without files.
#ifndef CTTestFrames_h
#define CTTestFrames_h

#include "lacunaCTFrame.h"

#include <string>
#include <vector>

/// Images of 7 x 5 pixels of 0.5 mm (rows) and 0.8 mm (columns) at positions, axial.
inline std::vector<lacuna::CTFrame> MakeFrames(const std::vector<lacuna::Vec3>& positions)
{
  std::vector<lacuna::CTFrame> frames;
  for (std::size_t i = 0; i < positions.size(); ++i)
  {
    auto header = std::make_shared<lacuna::CTFileHeader>();
    header->File = "/scan/IM" + std::to_string(i);
    header->Columns = 7;
    header->Rows = 5;
    header->Format = { 16, 16, 15, true };
    lacuna::CTFrame frame;
    frame.Header = header;
    frame.Position = positions[i];
    frame.Axes = { 1, 0, 0, 0, 1, 0 };
    frame.Spacing = { 0.5, 0.8 };
    frame.RescaleSlope = 1;
    frame.RescaleIntercept = 0;
    frames.push_back(frame);
  }
  return frames;
}
#endif
