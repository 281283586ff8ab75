// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaAnnouncement.h"

#include "vtkAlgorithm.h"
#include "vtkInformation.h"
#include "vtkInformationIntegerVectorKey.h"
#include "vtkInformationVector.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

using SDDP = vtkStreamingDemandDrivenPipeline;

namespace
{
using Extent = std::array<int, 6>;

// What those downstream know of; what it is at the time that was asked for.
vtkInformationIntegerVectorKey* KnownExtent()
{
  static vtkInformationIntegerVectorKey* const key =
    vtkInformationIntegerVectorKey::MakeKey("KNOWN_EXTENT", "vtkLacunaAnnouncement");
  return key;
}

vtkInformationIntegerVectorKey* TrueExtent()
{
  static vtkInformationIntegerVectorKey* const key =
    vtkInformationIntegerVectorKey::MakeKey("TRUE_EXTENT", "vtkLacunaAnnouncement");
  return key;
}

Extent Get(vtkInformation* info, vtkInformationIntegerVectorKey* key)
{
  Extent extent{ 0, -1, 0, -1, 0, -1 };
  if (info->Has(key))
  {
    info->Get(key, extent.data());
  }
  return extent;
}

bool IsEmpty(const Extent& extent)
{
  return extent[0] > extent[1] || extent[2] > extent[3] || extent[4] > extent[5];
}

std::string Describe(const Extent& extent)
{
  std::string text;
  for (std::size_t a = 0; a < 3; ++a)
  {
    text +=
      (a > 0 ? " x " : "") + std::to_string(std::max(0, extent[2 * a + 1] - extent[2 * a] + 1));
  }
  return text;
}
}

//------------------------------------------------------------------------------
int vtkLacunaAnnouncement::Renew(
  vtkAlgorithm* filter, vtkInformationVector* outputs, const std::function<int()>& inform)
{
  std::vector<Extent> known;
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    known.push_back(Get(outputs->GetInformationObject(i), KnownExtent()));
  }
  const int result = inform();
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    vtkInformation* info = outputs->GetInformationObject(i);
    if (info->Has(SDDP::WHOLE_EXTENT()))
    {
      // VTK compares requests, which are those of the extent that is known, with what is announced
      info->Set(TrueExtent(), Get(info, SDDP::WHOLE_EXTENT()).data(), 6);
      info->Set(KnownExtent(), known[i].data(), 6);
      info->Set(SDDP::WHOLE_EXTENT(), known[i].data(), 6);
      if (IsEmpty(known[i]) && !GetNews(outputs).empty())
      {
        vtkErrorWithObjectMacro(filter, << GetNews(outputs)); // it will be asked for nothing
      }
    }
  }
  return result;
}

//------------------------------------------------------------------------------
void vtkLacunaAnnouncement::Publish(vtkAlgorithm* filter, vtkInformationVector* outputs)
{
  if (!GetNews(outputs).empty())
  {
    filter->Modified();
  }
}

//------------------------------------------------------------------------------
std::string vtkLacunaAnnouncement::GetNews(vtkInformationVector* outputs)
{
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    vtkInformation* info = outputs->GetInformationObject(i);
    const Extent now = Get(info, TrueExtent());
    const Extent known = Get(info, KnownExtent());
    if (!IsEmpty(now) && now != known)
    {
      return "with time, the grid of output " + std::to_string(i) + " has become one of " +
        Describe(now) + " points, and those downstream still know of " + Describe(known) +
        "; update again, or give the filter a grid that does not depend on its input";
    }
  }
  return {};
}

//------------------------------------------------------------------------------
void vtkLacunaAnnouncement::Remember(vtkInformationVector* outputs)
{
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    vtkInformation* info = outputs->GetInformationObject(i);
    for (vtkInformationIntegerVectorKey* key : { KnownExtent(), TrueExtent() })
    {
      info->Set(key, Get(info, SDDP::WHOLE_EXTENT()).data(), 6);
    }
  }
}
