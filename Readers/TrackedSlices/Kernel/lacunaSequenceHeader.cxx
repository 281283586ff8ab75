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

bool IsTrackedSequence(const std::string& fileName)
{
  try
  {
    HeaderLines lines(fileName);
    return IsNrrd(lines) ? IsTrackedNrrd(lines) : IsTrackedMetaImage(lines);
  }
  catch (const std::exception&)
  {
    return false; // whatever it is, it is not ours
  }
}
}
