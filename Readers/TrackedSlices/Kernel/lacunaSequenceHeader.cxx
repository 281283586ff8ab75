// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSequenceHeader.h"

#include "lacunaHeaderReader.h"

#include <exception>

namespace lacuna
{
namespace
{
bool IsNrrd(HeaderLines& lines)
{
  return lines.Peek(4) == "NRRD";
}
}

SequenceHeader ReadSequenceHeader(const std::string& fileName)
{
  HeaderLines lines(fileName);
  return IsNrrd(lines) ? ReadNrrdHeader(fileName) : ReadMetaImageHeader(fileName);
}

VolumeHeader ReadVolumeHeader(const std::string& fileName)
{
  HeaderLines lines(fileName);
  return IsNrrd(lines) ? ReadNrrdVolumeHeader(fileName) : ReadMetaImageVolumeHeader(fileName);
}

ImageFileKind GetImageFileKind(const std::string& fileName)
{
  try
  {
    HeaderLines lines(fileName);
    return IsNrrd(lines) ? GetNrrdKind(lines) : GetMetaImageKind(lines);
  }
  catch (const std::exception&)
  {
    return ImageFileKind::Other; // whatever it is, it is not ours
  }
}

bool IsTrackedSequence(const std::string& fileName)
{
  return GetImageFileKind(fileName) == ImageFileKind::Sequence;
}
}
