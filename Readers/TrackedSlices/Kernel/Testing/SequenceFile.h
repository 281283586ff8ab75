// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Small sequence files for tests, and ways to spoil them.
#ifndef SequenceFile_h
#define SequenceFile_h

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

/// A file that is removed at the end of the test.
class TemporaryFile
{
public:
  explicit TemporaryFile(const std::string& name, const std::string& content = {})
    : Folder(std::filesystem::temp_directory_path() / MakeFolderName())
    , Path((Folder / name).string())
  {
    std::filesystem::create_directories(this->Folder);
    this->Write(content);
  }
  ~TemporaryFile()
  {
    std::error_code error;
    std::filesystem::remove_all(this->Folder, error);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void Write(const std::string& content) const { this->WriteBeside(this->Path, content); }
  /// Writes another file, or this one, in the same folder.
  void WriteBeside(const std::string& name, const std::string& content) const
  {
    // A new file: some file systems wait for the disk when an old one is written over.
    std::error_code error;
    std::filesystem::remove(this->Folder / name, error);
    std::ofstream stream(this->Folder / name, std::ios::binary);
    stream << content;
  }
  const std::string& GetPath() const { return this->Path; }

private:
  static std::string MakeFolderName()
  {
    static int count = 0;
    static const auto start = std::filesystem::file_time_type::clock::now();
    return "lacuna-sequence-" + std::to_string(start.time_since_epoch().count()) + "-" +
      std::to_string(++count);
  }
  std::filesystem::path Folder;
  std::string Path;
};

inline std::string ReadAll(const std::string& fileName)
{
  std::ifstream stream(fileName, std::ios::binary);
  return { std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>() };
}

/// Header fields in order, and pixels.
class SequenceFile
{
public:
  std::string LineEnd = "\n";
  std::string DataFile = "LOCAL";
  std::string Pixels;

  /// Replaces a field, or adds it at the end.
  void Set(const std::string& name, const std::string& value)
  {
    const auto found = this->Find(name);
    if (found != this->Fields.end())
    {
      found->second = value;
      return;
    }
    this->Fields.emplace_back(name, value);
  }
  /// Adds a field that the file does not have yet.
  void Append(int frame, const std::string& name, const std::string& value)
  {
    this->Fields.emplace_back(FrameFieldName(frame, name), value);
  }
  void SetFrame(int frame, const std::string& name, const std::string& value)
  {
    this->Set(FrameFieldName(frame, name), value);
  }
  void Remove(const std::string& name)
  {
    const auto found = this->Find(name);
    if (found != this->Fields.end())
    {
      this->Fields.erase(found);
    }
  }
  void RemoveFrame(int frame, const std::string& name)
  {
    this->Remove(FrameFieldName(frame, name));
  }
  /// Adds a line as it is.
  void AddLine(const std::string& line) { this->Fields.emplace_back(line, std::string()); }

  std::string GetHeader() const
  {
    std::string text;
    for (const auto& field : this->Fields)
    {
      text += field.second.empty() ? field.first : field.first + " = " + field.second;
      text += this->LineEnd;
    }
    return text + "ElementDataFile = " + this->DataFile + this->LineEnd;
  }
  std::string GetContent() const
  {
    return this->GetHeader() + (this->DataFile == "LOCAL" ? this->Pixels : std::string());
  }

private:
  using FieldList = std::vector<std::pair<std::string, std::string>>;
  static std::string FrameFieldName(int frame, const std::string& name)
  {
    const std::string digits = std::to_string(frame);
    return "Seq_Frame" + std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits +
      "_" + name;
  }
  FieldList::iterator Find(const std::string& name)
  {
    return std::find_if(this->Fields.begin(), this->Fields.end(),
      [&](const auto& field) { return field.first == name; });
  }
  FieldList Fields;
};

/// The grey level of a pixel of MakeSequence: no symmetry of the image leaves it as it is.
inline std::uint8_t GetGrey(int column, int row, int frame)
{
  return static_cast<std::uint8_t>((7 * column + 31 * row * row + 101 * frame + 3) & 255);
}

/// A sweep of 5 x 4 pixels: the probe moves along x of the tracker, a millimetre per frame; the
/// reference lies 100 mm from the tracker along y, turned by 90 degrees about z.
inline SequenceFile MakeSequence(int frames = 3, int columns = 5, int rows = 4)
{
  SequenceFile file;
  file.Set("ObjectType", "Image");
  file.Set("NDims", "3");
  file.Set("BinaryData", "True");
  file.Set("BinaryDataByteOrderMSB", "False");
  file.Set("CompressedData", "False");
  file.Set(
    "DimSize", std::to_string(columns) + " " + std::to_string(rows) + " " + std::to_string(frames));
  file.Set("Kinds", "domain domain list");
  file.Set("ElementType", "MET_UCHAR");
  file.Set("UltrasoundImageOrientation", "MFA");
  file.Set("UltrasoundImageType", "BRIGHTNESS");
  for (int i = 0; i < frames; ++i)
  {
    file.Append(
      i, "ProbeToTrackerTransform", "1 0 0 " + std::to_string(i) + " 0 1 0 20 0 0 1 30 0 0 0 1");
    file.Append(i, "ProbeToTrackerTransformStatus", "OK");
    file.Append(i, "ReferenceToTrackerTransform", "0 -1 0 0 1 0 0 100 0 0 1 0 0 0 0 1");
    file.Append(i, "ReferenceToTrackerTransformStatus", "OK");
    file.Append(i, "Timestamp", std::to_string(10 + i) + ".25");
    file.Append(i, "ImageStatus", "OK");
    for (int row = 0; row < rows; ++row)
    {
      for (int column = 0; column < columns; ++column)
      {
        file.Pixels.push_back(static_cast<char>(GetGrey(column, row, i)));
      }
    }
  }
  return file;
}

/// Pixels of 0.1 x 0.2 mm, the image's origin 5 mm off the probe's along z.
inline std::string MakeCalibration(
  const std::string& matrix = "0.1 0 0 0 0 0.2 0 0 0 0 0.15 5 0 0 0 1")
{
  return "<PlusConfiguration version=\"2.1\">\n  <CoordinateDefinitions>\n"
         "    <Transform From=\"Image\" To=\"Probe\" Matrix=\"" +
    matrix + "\"/>\n  </CoordinateDefinitions>\n</PlusConfiguration>\n";
}

/// The message of the exception that body throws, or an empty string.
template <class Body>
std::string GetError(const Body& body)
{
  try
  {
    body();
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
  return {};
}
#endif
