// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// DICOM files made byte by byte.
#ifndef DicomTestFile_h
#define DicomTestFile_h

#include "lacunaDicomDataSet.h"
#include "lacunaDicomHeader.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

class Temporary
{
public:
  Temporary()
    : Path(std::filesystem::temp_directory_path() / ("lacuna-dicom-" + std::to_string(getpid())))
  {
    std::filesystem::create_directories(this->Path);
  }
  ~Temporary() { std::filesystem::remove_all(this->Path); }
  std::string Write(const std::string& bytes, const std::string& name = "file") const
  {
    const std::string path = (this->Path / name).string();
    std::filesystem::remove(path); // ext4 writes out at once what is cut and filled again
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

  std::filesystem::path Path;
};

inline std::string Number(std::uint32_t number, int bytes)
{
  std::string text;
  for (int i = 0; i < bytes; ++i)
  {
    text += static_cast<char>(number >> 8 * i & 0xFF);
  }
  return text;
}

inline std::string Tag(lacuna::DicomTag tag)
{
  return Number(tag >> 16, 2) + Number(tag & 0xFFFF, 2);
}

inline std::string Short(lacuna::DicomTag tag, const std::string& vr, std::string value)
{
  value += value.size() % 2 ? " " : "";
  return Tag(tag) + vr + Number(static_cast<std::uint32_t>(value.size()), 2) + value;
}

inline std::string Long(
  lacuna::DicomTag tag, const std::string& vr, const std::string& value, bool open = false)
{
  return Tag(tag) + vr + Number(0, 2) +
    Number(open ? 0xFFFFFFFF : static_cast<std::uint32_t>(value.size()), 4) + value;
}

inline std::string Implicit(lacuna::DicomTag tag, const std::string& value, bool open = false)
{
  return Tag(tag) + Number(open ? 0xFFFFFFFF : static_cast<std::uint32_t>(value.size()), 4) + value;
}

/// Whole numbers of so many bits, without sign.
inline std::string Format(std::uint32_t bits)
{
  return Short(0x00280100, "US", Number(bits, 2)) + Short(0x00280101, "US", Number(bits, 2)) +
    Short(0x00280103, "US", Number(0, 2));
}

inline std::string ImplicitFormat(std::uint32_t bits)
{
  return Implicit(0x00280100, Number(bits, 2)) + Implicit(0x00280101, Number(bits, 2)) +
    Implicit(0x00280103, Number(0, 2));
}

inline const std::string ItemEnd = Tag(0xFFFEE00D) + Number(0, 4);
inline const std::string SequenceEnd = Tag(0xFFFEE0DD) + Number(0, 4);

inline std::string Head(const std::string& syntax)
{
  const std::string meta = Short(0x00020010, "UI", syntax);
  return std::string(128, '\0') + "DICM" + Short(0x00020000, "UL", Number(60, 4)) + meta;
}

// Sequences of all kinds around what matters.
inline std::string MakeFile()
{
  const std::string position = Short(0x00200032, "DS", "1\\2.5\\-3");
  const std::string closed = Implicit(0xFFFEE000, position);
  const std::string open = Implicit(0xFFFEE000, position, true) + ItemEnd;
  const std::string unknown = Implicit(0xFFFEE000, Implicit(0x00080100, "CODE"), true) + ItemEnd;
  const std::string plain = Implicit(0xFFFEE000, Short(0x00080100, "SH", "CODE"), true) + ItemEnd;
  const std::string icon = Implicit(0xFFFEE000,
    Long(0x7FE00010, "OB", Implicit(0xFFFEE000, "") + Implicit(0xFFFEE000, "JPEG") + SequenceEnd,
      true));
  return Head("1.2.840.10008.1.2.1") + Short(0x00080060, "CS", "CT") +
    Long(0x00081140, "SQ", plain + SequenceEnd, true) +
    Long(0x00091010, "UN", unknown + SequenceEnd, true) + Short(0x00280010, "US", Number(2, 2)) +
    Short(0x00280011, "US", Number(3, 2)) + Short(0x00280100, "US", Number(16, 2)) +
    Short(0x00280101, "US", Number(16, 2)) + Short(0x00280103, "US", Number(1, 2)) +
    Short(0x00280120, "SS", Number(0xFF38, 2)) + Long(0x00880200, "SQ", icon + SequenceEnd, true) +
    Long(0x52009229, "SQ", Implicit(0xFFFEE000, Long(0x00209113, "SQ", closed))) +
    Long(0x52009230, "SQ",
      Implicit(0xFFFEE000, Long(0x00209113, "SQ", open + SequenceEnd, true), true) + ItemEnd +
        SequenceEnd,
      true) +
    Long(0x7FE00010, "OW", std::string("abcdefghijkl"));
}

inline std::string Pixels(const lacuna::CTFrame& frame)
{
  std::string bytes(static_cast<std::size_t>(lacuna::GetDicomSize(frame)), '\0');
  lacuna::ReadDicomBytes(frame, reinterpret_cast<unsigned char*>(bytes.data()));
  return bytes;
}
#endif
