// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Small NRRD sequences for tests.
#ifndef NrrdFile_h
#define NrrdFile_h

#include "SequenceFile.h"

#include <zlib.h>

#include <cstdio>

/// Fields, keys and pixels.
struct NrrdFile
{
  using List = std::vector<std::pair<std::string, std::string>>;
  std::string Magic = "NRRD0004";
  std::string LineEnd = "\n";
  List Fields;
  List Pairs;
  std::string Pixels; ///< as they are encoded
  bool Detached = false;

  void Set(const std::string& name, const std::string& value) { Set(this->Fields, name, value); }
  void SetPair(const std::string& key, const std::string& value) { Set(this->Pairs, key, value); }
  void SetFrame(int frame, const std::string& name, const std::string& value)
  {
    char number[16];
    std::snprintf(number, sizeof(number), "%04d", frame);
    Set(this->Pairs, "Seq_Frame" + std::string(number) + "_" + name, value);
  }
  void Remove(const std::string& name)
  {
    for (List* list : { &this->Fields, &this->Pairs })
    {
      list->erase(std::remove_if(list->begin(), list->end(),
                    [&](const auto& field) { return field.first == name; }),
        list->end());
    }
  }
  std::string GetHeader() const
  {
    std::string text = this->Magic + this->LineEnd + "# a comment: with a colon" + this->LineEnd;
    for (const auto& field : this->Fields)
    {
      text += field.first + ": " + field.second + this->LineEnd;
    }
    for (const auto& pair : this->Pairs)
    {
      text += pair.first + ":=" + pair.second + this->LineEnd;
    }
    return this->Detached ? text : text + this->LineEnd;
  }
  std::string GetContent() const
  {
    return this->GetHeader() + (this->Detached ? std::string() : this->Pixels);
  }

private:
  static void Set(List& list, const std::string& name, const std::string& value)
  {
    const auto found = std::find_if(
      list.begin(), list.end(), [&](const auto& field) { return field.first == name; });
    if (found != list.end())
    {
      found->second = value;
      return;
    }
    list.emplace_back(name, value);
  }
};

/// The sweep of MakeSequence in the other format.
inline NrrdFile MakeNrrd(int frames = 3, int columns = 5, int rows = 4)
{
  NrrdFile file;
  file.Set("type", "uint8");
  file.Set("dimension", "3");
  file.Set(
    "sizes", std::to_string(columns) + " " + std::to_string(rows) + " " + std::to_string(frames));
  file.Set("kinds", "domain domain list");
  file.Set("space dimension", "2");
  file.Set("space directions", "(1,0) (0,1) none");
  file.Set("encoding", "raw");
  file.Set("endian", "little");
  file.SetPair("ultrasound image orientation", "MFA");
  file.SetPair("ultrasound image type", "BRIGHTNESS");
  for (int i = 0; i < frames; ++i)
  {
    file.SetFrame(
      i, "ProbeToTrackerTransform", "1 0 0 " + std::to_string(i) + " 0 1 0 20 0 0 1 30 0 0 0 1");
    file.SetFrame(i, "ProbeToTrackerTransformStatus", "OK");
    file.SetFrame(i, "ReferenceToTrackerTransform", "0 -1 0 0 1 0 0 100 0 0 1 0 0 0 0 1");
    file.SetFrame(i, "ReferenceToTrackerTransformStatus", "OK");
    file.SetFrame(i, "Timestamp", std::to_string(10 + i) + ".25");
    file.SetFrame(i, "Status", "OK");
  }
  file.Pixels = MakeSequence(frames, columns, rows).Pixels;
  return file;
}

/// A gzip member with bytes.
inline std::string Gzip(const std::string& bytes)
{
  std::string packed(bytes.size() + bytes.size() / 1000 + 100, '\0');
  z_stream zlib{};
  deflateInit2(&zlib, 6, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY);
  zlib.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  zlib.avail_in = static_cast<uInt>(bytes.size());
  zlib.next_out = reinterpret_cast<Bytef*>(packed.data());
  zlib.avail_out = static_cast<uInt>(packed.size());
  deflate(&zlib, Z_FINISH);
  packed.resize(zlib.total_out);
  deflateEnd(&zlib);
  return packed;
}

/// Each byte as two digits, some lines long.
inline std::string ToHex(const std::string& bytes)
{
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); ++i)
  {
    char digits[8];
    std::snprintf(digits, sizeof(digits), i % 2 ? "%02X" : "%02x",
      static_cast<unsigned>(static_cast<unsigned char>(bytes[i])));
    text += digits;
    text += i % 35 == 34 ? "\n" : "";
  }
  return text;
}

/// Each byte as a number.
inline std::string ToText(const std::string& bytes)
{
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); ++i)
  {
    text += std::to_string(static_cast<unsigned char>(bytes[i]));
    text += i % 5 == 4 ? "\n" : " ";
  }
  return text;
}
#endif
