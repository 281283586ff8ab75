// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What SliceStatus says against a slice.
#ifndef lacunaSliceFlags_h
#define lacunaSliceFlags_h

#include <array>
#include <cstddef>
#include <string>

namespace lacuna
{
/// To derive from, for those who keep slices with a status.
struct SliceFlags
{
  enum Flags : unsigned char
  {
    Valid = 0,
    PoseInvalid = 1,
    ImageInvalid = 2,
    TooFast = 4,
    GatedOut = 8
  };
  /// Of the flags from 1 on.
  static constexpr std::array<const char*, 4> FlagNames{ "pose invalid", "image invalid",
    "too fast", "gated out" };
};

/// How many slices have which flag.
class SliceFlagCounts
{
public:
  void Add(unsigned char status)
  {
    for (std::size_t i = 0; i < this->Counts.size(); ++i)
    {
      this->Counts[i] += (status >> i) & 1;
    }
    this->Slices += status != SliceFlags::Valid;
    this->All |= status;
  }

  /// Slices that have any, also one without a name.
  int GetNumberOfSlices() const { return this->Slices; }

  /// Whether any has this one.
  bool Has(SliceFlags::Flags flag) const { return (this->All & flag) != 0; }

  /// "2 pose invalid (1), 1 gated out (8)"; empty when there are none.
  std::string Describe() const
  {
    std::string text;
    for (std::size_t i = 0; i < this->Counts.size(); ++i)
    {
      if (this->Counts[i] > 0)
      {
        text += (text.empty() ? "" : ", ") + std::to_string(this->Counts[i]) + " " +
          SliceFlags::FlagNames[i] + " (" + std::to_string(1 << i) + ")";
      }
    }
    return text;
  }

private:
  std::array<int, SliceFlags::FlagNames.size()> Counts{};
  int Slices = 0;
  unsigned char All = 0;
};
}
#endif
