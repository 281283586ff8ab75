// SPDX-License-Identifier: BSD-3-Clause
#include "CTTestSeries.h"

#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmItem.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmTrace.h>
#include <gdcmWriter.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace
{
// Bars of the letter: low and high corner, mm. The stem runs along z, the arms point to the
// patient's left, the lower one is shorter and nearer to the front.
constexpr std::array<std::array<double, 6>, 3> Bars = { {
  { -12.55, -12.45, -12.35, -4.55, -3.45, 12.65 },
  { -12.55, -12.45, 5.35, 11.45, -3.45, 12.65 },
  { -12.55, -18.45, -3.85, 6.45, -8.45, 3.65 },
} };

std::string Decimal(double x)
{
  char text[32];
  for (int digits = 15; digits > 0; --digits) // DS has 16 characters at most
  {
    std::snprintf(text, sizeof(text), "%.*g", digits, x);
    if (std::strlen(text) <= 16)
    {
      break;
    }
  }
  return text;
}

std::string Decimals(const std::vector<double>& numbers)
{
  std::string text;
  for (std::size_t i = 0; i < numbers.size(); ++i)
  {
    text += (i == 0 ? "" : "\\") + Decimal(numbers[i]);
  }
  return text;
}

void Put(gdcm::DataSet& data, std::uint16_t group, std::uint16_t element, const std::string& vr,
  std::string value)
{
  gdcm::DataElement item(gdcm::Tag(group, element));
  item.SetVR(gdcm::VR::GetVRType(vr.c_str()));
  if (vr == "US" || vr == "SS")
  {
    const long number = std::stol(value);
    value.assign({ static_cast<char>(number & 0xFF), static_cast<char>(number >> 8 & 0xFF) });
  }
  else if (value.size() % 2 == 1)
  {
    value += vr == "UI" ? '\0' : ' ';
  }
  item.SetByteValue(value.data(), static_cast<std::uint32_t>(value.size()));
  data.Replace(item);
}

void PutGroup(gdcm::DataSet& data, std::uint16_t group, std::uint16_t element,
  const std::vector<gdcm::DataSet>& items)
{
  gdcm::SmartPointer<gdcm::SequenceOfItems> sequence = new gdcm::SequenceOfItems;
  sequence->SetLengthToUndefined();
  for (const gdcm::DataSet& content : items)
  {
    gdcm::Item item;
    item.SetVLToUndefined();
    item.SetNestedDataSet(content);
    sequence->AddItem(item);
  }
  gdcm::DataElement container(gdcm::Tag(group, element));
  container.SetVR(gdcm::VR::SQ);
  container.SetValue(*sequence);
  container.SetVLToUndefined();
  data.Replace(container);
}

std::vector<char> MakePixels(const CTTestSeries& series, int slice)
{
  const int bytes = series.BitsAllocated / 8;
  std::vector<char> pixels;
  for (int j = 0; j < series.Rows; ++j)
  {
    for (int i = 0; i < series.Columns; ++i)
    {
      const lacuna::Vec3 point = series.GetPosition(slice) + i * series.ColumnSpacing * series.Row +
        j * series.RowSpacing * series.Column;
      const std::int64_t stored = series.Stored
        ? series.Stored(i, j, slice)
        : std::llround((series.Truth(point) - series.Intercept) / series.Slope);
      for (int b = 0; b < bytes; ++b)
      {
        pixels.push_back(static_cast<char>(stored >> 8 * b & 0xFF));
      }
    }
  }
  return pixels;
}

void PutImage(const CTTestSeries& series, gdcm::DataSet& data)
{
  const bool multi = series.MultiFrame;
  Put(data, 0x0008, 0x0016, "UI",
    multi ? "1.2.840.10008.5.1.4.1.1.2.1" : "1.2.840.10008.5.1.4.1.1.2");
  Put(data, 0x0008, 0x0005, "CS", "ISO_IR 100");
  Put(data, 0x0008, 0x0020, "DA", "20260102");
  Put(data, 0x0008, 0x0060, "CS", "CT");
  Put(data, 0x0008, 0x103E, "LO", series.Description);
  Put(data, 0x0010, 0x0010, "PN", "Secret^Name");
  Put(data, 0x0010, 0x0020, "LO", "SECRET-ID");
  Put(data, 0x0010, 0x0030, "DA", "19010203");
  Put(data, 0x0010, 0x0040, "CS", "F");
  Put(data, 0x0018, 0x1210, "SH", "H30s");
  Put(data, 0x0018, 0x5100, "CS", series.PatientPosition);
  Put(data, 0x0020, 0x000D, "UI", "1.2.826.0.1.3680043.2.1125.9");
  Put(data, 0x0020, 0x000E, "UI", series.SeriesUid);
  Put(data, 0x0020, 0x0011, "IS", "4");
  Put(data, 0x0020, 0x0052, "UI", "1.2.826.0.1.3680043.2.1125.8");
  Put(data, 0x0028, 0x0002, "US", "1");
  Put(data, 0x0028, 0x0004, "CS", series.Photometric);
  Put(data, 0x0028, 0x0010, "US", std::to_string(series.Rows));
  Put(data, 0x0028, 0x0011, "US", std::to_string(series.Columns));
  Put(data, 0x0028, 0x0100, "US", std::to_string(series.BitsAllocated));
  Put(data, 0x0028, 0x0101, "US", std::to_string(series.BitsStored));
  Put(data, 0x0028, 0x0102, "US", std::to_string(series.BitsStored - 1));
  Put(data, 0x0028, 0x0103, "US", series.Signed ? "1" : "0");
}

std::string GetOrientation(const CTTestSeries& series)
{
  const lacuna::Vec3& r = series.Row;
  const lacuna::Vec3& c = series.Column;
  return Decimals({ r[0], r[1], r[2], c[0], c[1], c[2] });
}

std::string GetPositionText(const CTTestSeries& series, int slice)
{
  const lacuna::Vec3 p = series.GetPosition(slice);
  return Decimals({ p[0], p[1], p[2] });
}

std::string GetSpacing(const CTTestSeries& series)
{
  return Decimals({ series.RowSpacing, series.ColumnSpacing });
}

// What an ordinary file says of its slice.
void PutSlice(const CTTestSeries& series, int slice, int instance, gdcm::DataSet& data)
{
  Put(data, 0x0008, 0x0008, "CS", "ORIGINAL\\PRIMARY\\AXIAL");
  Put(data, 0x0008, 0x0018, "UI", series.SeriesUid + "." + std::to_string(instance));
  Put(data, 0x0018, 0x0050, "DS", Decimal(lacuna::Norm(series.Step)));
  Put(data, 0x0020, 0x0013, "IS", std::to_string(instance));
  Put(data, 0x0020, 0x0032, "DS", GetPositionText(series, slice));
  Put(data, 0x0020, 0x0037, "DS", GetOrientation(series));
  Put(data, 0x0028, 0x0030, "DS", GetSpacing(series));
  Put(data, 0x0028, 0x1052, "DS", Decimal(series.Intercept));
  Put(data, 0x0028, 0x1053, "DS", Decimal(series.Slope));
  Put(data, 0x0028, 0x1054, "LO", "HU");
}

// The same in functional groups, frames in the order given.
void PutFrames(const CTTestSeries& series, const std::vector<int>& order, gdcm::DataSet& data)
{
  Put(data, 0x0008, 0x0018, "UI", series.SeriesUid + ".1");
  Put(data, 0x0008, 0x0008, "CS", "ORIGINAL\\PRIMARY\\VOLUME\\NONE");
  Put(data, 0x0028, 0x0008, "IS", std::to_string(order.size()));
  gdcm::DataSet orientation;
  Put(orientation, 0x0020, 0x0037, "DS", GetOrientation(series));
  gdcm::DataSet measures;
  Put(measures, 0x0018, 0x0050, "DS", Decimal(lacuna::Norm(series.Step)));
  Put(measures, 0x0028, 0x0030, "DS", GetSpacing(series));
  gdcm::DataSet rescale;
  Put(rescale, 0x0028, 0x1052, "DS", Decimal(series.Intercept));
  Put(rescale, 0x0028, 0x1053, "DS", Decimal(series.Slope));
  Put(rescale, 0x0028, 0x1054, "LO", "HU");
  gdcm::DataSet shared;
  PutGroup(shared, 0x0020, 0x9116, { orientation });
  PutGroup(shared, 0x0028, 0x9110, { measures });
  PutGroup(shared, 0x0028, 0x9145, { rescale });
  PutGroup(data, 0x5200, 0x9229, { shared });
  std::vector<gdcm::DataSet> frames;
  for (const int slice : order)
  {
    gdcm::DataSet position;
    Put(position, 0x0020, 0x0032, "DS", GetPositionText(series, slice));
    gdcm::DataSet frame;
    PutGroup(frame, 0x0020, 0x9113, { position });
    frames.push_back(frame);
  }
  PutGroup(data, 0x5200, 0x9230, frames);
}

void PutPixels(gdcm::DataSet& data, const std::vector<char>& pixels)
{
  gdcm::DataElement element(gdcm::Tag(0x7FE0, 0x0010));
  element.SetVR(gdcm::VR::OW);
  element.SetByteValue(pixels.data(), static_cast<std::uint32_t>(pixels.size()));
  data.Replace(element);
}

void Save(const CTTestSeries& series, gdcm::File& content, const std::string& name)
{
  const auto fail = [&](const char* what) { throw std::runtime_error(name + ": " + what); };
  const gdcm::TransferSyntax syntax =
    gdcm::TransferSyntax::GetTSType(series.TransferSyntax.c_str());
  const auto write = [&](gdcm::TransferSyntax::TSType type)
  {
    content.GetHeader().Clear();
    content.GetHeader().SetDataSetTransferSyntax(type);
    gdcm::Writer writer;
    writer.SetFile(content);
    writer.SetFileName(name.c_str());
    if (!writer.Write())
    {
      fail("cannot be written");
    }
  };
  write(syntax.IsEncapsulated() ? gdcm::TransferSyntax::ExplicitVRLittleEndian
                                : static_cast<gdcm::TransferSyntax::TSType>(syntax));
  if (syntax.IsEncapsulated())
  {
    gdcm::ImageReader reader;
    reader.SetFileName(name.c_str());
    gdcm::ImageChangeTransferSyntax change;
    change.SetTransferSyntax(syntax);
    if (!reader.Read())
    {
      fail("cannot be read again");
    }
    change.SetInput(reader.GetImage());
    if (!change.Change())
    {
      fail("cannot be compressed");
    }
    // not by gdcm::ImageWriter, which does away with functional groups
    content.GetDataSet().Replace(change.GetOutput().GetDataElement());
    write(syntax);
  }
}

void Apply(const CTTestSeries& series, int slice, gdcm::DataSet& data)
{
  for (const CTTestSeries::Edit& edit : series.Edits)
  {
    if (!edit.Only.empty() &&
      std::find(edit.Only.begin(), edit.Only.end(), slice) == edit.Only.end())
    {
      continue;
    }
    if (edit.Value.empty())
    {
      data.Remove(gdcm::Tag(edit.Group, edit.Element));
    }
    else
    {
      Put(data, edit.Group, edit.Element, edit.Vr, edit.Value);
    }
  }
}
}

//------------------------------------------------------------------------------
bool IsInLetter(const lacuna::Vec3& point, double margin)
{
  return std::any_of(Bars.begin(), Bars.end(),
    [&](const std::array<double, 6>& bar)
    {
      for (int i = 0; i < 3; ++i)
      {
        if (point[i] < bar[i] - margin || point[i] > bar[i + 3] + margin)
        {
          return false;
        }
      }
      return true;
    });
}

//------------------------------------------------------------------------------
double DistanceToLetter(const lacuna::Vec3& point)
{
  double nearest = HUGE_VAL;
  for (const std::array<double, 6>& bar : Bars)
  {
    lacuna::Vec3 outside{};
    double inside = -HUGE_VAL;
    for (int i = 0; i < 3; ++i)
    {
      const double beyond = std::max(bar[i] - point[i], point[i] - bar[i + 3]);
      outside[i] = std::max(0.0, beyond);
      inside = std::max(inside, beyond);
    }
    nearest = std::min(nearest, lacuna::Norm(outside) + std::min(0.0, inside));
  }
  return nearest;
}

//------------------------------------------------------------------------------
double CTTruth(const lacuna::Vec3& point)
{
  return 3 * point[0] - 5 * point[1] + 7 * point[2] + 100 + (IsInLetter(point) ? 1500 : 0);
}

//------------------------------------------------------------------------------
lacuna::Vec3 CTTestSeries::GetPosition(int slice) const
{
  return this->First + (this->Places.empty() ? slice : this->Places[slice]) * this->Step;
}

//------------------------------------------------------------------------------
std::vector<std::string> CTTestSeries::Write(const std::string& folder) const
{
  gdcm::Trace::SetWarning(false);
  gdcm::Trace::SetError(false);
  std::filesystem::create_directories(folder);
  const int count = this->Places.empty() ? this->Slices : static_cast<int>(this->Places.size());
  // every fifth slice, and so on: neither ascending nor descending
  std::vector<int> order;
  for (int first = 0; first < 5; ++first)
  {
    for (int k = 4 - first; k < count; k += 5)
    {
      order.push_back(k);
    }
  }
  std::vector<std::string> names(static_cast<std::size_t>(count));
  if (this->MultiFrame)
  {
    // counted by reference: never on the stack
    const gdcm::SmartPointer<gdcm::File> content = new gdcm::File;
    PutImage(*this, content->GetDataSet());
    PutFrames(*this, order, content->GetDataSet());
    std::vector<char> pixels;
    for (const int slice : order)
    {
      const std::vector<char> own = MakePixels(*this, slice);
      pixels.insert(pixels.end(), own.begin(), own.end());
    }
    PutPixels(content->GetDataSet(), pixels);
    Apply(*this, 0, content->GetDataSet());
    const std::string name = folder + "/IM0001";
    Save(*this, *content, name);
    std::fill(names.begin(), names.end(), name);
    return names;
  }
  for (int i = 0; i < count; ++i)
  {
    const int slice = order[i];
    const gdcm::SmartPointer<gdcm::File> content = new gdcm::File;
    PutImage(*this, content->GetDataSet());
    PutSlice(*this, slice, i + 1, content->GetDataSet());
    PutPixels(content->GetDataSet(), MakePixels(*this, slice));
    Apply(*this, slice, content->GetDataSet());
    char number[32];
    std::snprintf(number, sizeof(number), "/IM%04d.dcm", i + 1);
    names[slice] = folder + number;
    Save(*this, *content, names[slice]);
  }
  return names;
}
