// SPDX-License-Identifier: BSD-3-Clause
// Outlines: tables, DICOM RT structure sets and, where there is VTK's jsoncpp, markups of 3D Slicer.
#include "lacunaOutlineFile.h"

#include "lacunaFuzzTarget.h"
#include "lacunaOutlineTable.h"
#include "lacunaStructureSet.h"
#ifdef LACUNA_WITH_MARKUPS
#include "lacunaMarkups.h"
#endif

using namespace lacuna;
using namespace lacuna_fuzz;

namespace
{
void Check(const OutlineSet& set)
{
  Require(!set.GetOutlines().empty(), "a file without outlines is an error");
  for (const StructureOutline& outline : set.GetOutlines())
  {
    Require(outline.Structure < set.GetStructures().size(), "an outline has a structure");
    Require(outline.Points.size() >= 3 && outline.Slice >= -1, "an outline has points");
    for (const Vec3& point : outline.Points)
    {
      Require(IsFinite(point), "points are finite");
    }
  }
}
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const MemoryFile file(data, size);
  IsOutlineFile(file.GetPath());
  try
  {
    const OutlineFileKind kind = GetOutlineFileKind(file.GetPath());
    if (kind == OutlineFileKind::Dicom)
    {
      Check(ReadStructureSet(file.GetPath()));
    }
    else if (kind == OutlineFileKind::Table)
    {
      Check(ReadOutlineTable(file.GetPath()));
    }
#ifdef LACUNA_WITH_MARKUPS
    else
    {
      Check(ReadMarkups(file.GetPath()));
    }
#endif
  }
  catch (const std::runtime_error& error)
  {
    RequireSentence(error);
  }
  return 0;
}
