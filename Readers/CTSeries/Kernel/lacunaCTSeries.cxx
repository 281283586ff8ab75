// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCTSeries.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
constexpr const char* SecondaryCapture = "1.2.840.10008.5.1.4.1.1.7"; // and what begins so
constexpr std::size_t MostDirections = 16; // of images in a series with scouts

std::string GetBaseName(const std::string& path)
{
  return path.substr(path.find_last_of('/') + 1);
}

[[noreturn]] void Fail(const CTFrame& frame, const std::string& what)
{
  throw std::runtime_error(frame.GetName() + ": " + what);
}

// " of 2 patients" with the tag that tells them apart; empty when there is one.
std::string DescribePatients(const std::vector<CTSeries>& all)
{
  std::set<std::string> ids;
  std::set<std::pair<std::string, std::string>> patients;
  for (const CTSeries& series : all)
  {
    const CTPatient& patient = series.Frames.front().Header->Patient;
    ids.insert(patient.Id);
    patients.emplace(patient.Id, patient.Name);
  }
  return patients.size() < 2 ? std::string()
                             : " of " + std::to_string(patients.size()) + " patients " +
      (ids.size() > 1 ? "(0010,0020)" : "(0010,0010)");
}

bool IsLocalizer(const CTFrame& frame)
{
  return std::any_of(frame.ImageType.begin(), frame.ImageType.end(),
    [](const std::string& value) { return value == "LOCALIZER" || value == "SCOUT"; });
}

// Of the image; zero where it does not say how it lies.
Vec3 GetNormal(const CTFrame& frame)
{
  const std::array<double, 6> a = frame.Axes.value_or(std::array<double, 6>{});
  return Normalized(Cross(Vec3{ a[0], a[1], a[2] }, Vec3{ a[3], a[4], a[5] }));
}

std::string NameWithKernel(const CTSeries& series)
{
  const std::string& kernel = series.Frames.front().Header->ConvolutionKernel;
  return series.Uid + " kernel " + (kernel.empty() ? "none" : kernel);
}

// One for each kernel where two kernels have an image at one place: no volume holds both.
std::vector<CTSeries> SplitByKernel(CTSeries series)
{
  std::map<std::string, CTSeries> parts;
  std::map<std::array<std::int64_t, 3>, const std::string*> places; // in 10 um
  bool isSplit = false;
  for (const CTFrame& frame : series.Frames)
  {
    const std::string& kernel = frame.Header->ConvolutionKernel;
    CTSeries& part = parts[kernel];
    part.Uid = series.Uid;
    part.Frames.push_back(frame);
    part.IsOneOfKernels = true;
    constexpr double Most = 1e6; // mm: a number beyond is no place
    if (frame.Position && Norm(*frame.Position) < Most)
    {
      std::array<std::int64_t, 3> place{};
      for (int i = 0; i < 3; ++i)
      {
        place[i] = std::llround(100 * (*frame.Position)[i]);
      }
      isSplit = isSplit || *places.emplace(place, &kernel).first->second != kernel;
    }
  }
  std::vector<CTSeries> all;
  if (!isSplit)
  {
    all.push_back(std::move(series));
    return all;
  }
  for (auto& part : parts)
  {
    all.push_back(std::move(part.second));
  }
  return all;
}

// Whether text is name, or begins with it as a line of Describe does.
bool IsNamed(const std::string& text, const std::string& name)
{
  return text == name || text.rfind(name + "  ", 0) == 0;
}

bool IsPositive(double x)
{
  return std::isfinite(x) && x > 0;
}

// The largest difference of elements; infinite unless both are there.
template <std::size_t N>
double Difference(
  const std::optional<std::array<double, N>>& a, const std::optional<std::array<double, N>>& b)
{
  double largest = a && b ? 0 : HUGE_VAL;
  for (std::size_t i = 0; a && b && i < N; ++i)
  {
    largest = std::max(largest, std::abs((*a)[i] - (*b)[i]));
  }
  return largest;
}

// Component and sign of the direction that a letter means, in LPS.
std::optional<std::pair<int, double>> GetDirection(char letter)
{
  static const std::string letters = "RLAPFH";
  const std::size_t place = letters.find(letter);
  return place == std::string::npos
    ? std::nullopt
    : std::make_optional(std::make_pair(static_cast<int>(place / 2), place % 2 ? 1.0 : -1.0));
}

char GetMainLetter(const Vec3& axis)
{
  int largest = 0;
  for (int i : { 1, 2 })
  {
    largest = std::abs(axis[i]) > std::abs(axis[largest]) ? i : largest;
  }
  return "RLAPFH"[2 * largest + (axis[largest] > 0 ? 1 : 0)];
}

// Two tags say how an image lies; where they contradict each other no one knows which is right.
void CheckPatientOrientation(const CTFrame& frame)
{
  constexpr double LeastOfMain = 0.25; // the largest component of a unit vector is at least 0.57
  constexpr double LeastOfOther = -0.1;
  const std::vector<std::string>& stated = frame.Header->PatientOrientation;
  if (stated.size() != 2)
  {
    return;
  }
  const std::array<double, 6>& a = *frame.Axes;
  const std::array<Vec3, 2> axes = { Normalized(Vec3{ a[0], a[1], a[2] }),
    Normalized(Vec3{ a[3], a[4], a[5] }) };
  if (!(Norm(axes[0]) > 0 && Norm(axes[1]) > 0))
  {
    return; // that they are no directions is an error of the geometry
  }
  bool same = true;
  for (std::size_t i = 0; i < axes.size(); ++i)
  {
    for (std::size_t k = 0; k < stated[i].size(); ++k)
    {
      const auto direction = GetDirection(stated[i][k]);
      if (!direction)
      {
        return; // not understood, so there is nothing to compare
      }
      same = same &&
        !(direction->second * axes[i][direction->first] < (k == 0 ? LeastOfMain : LeastOfOther));
    }
  }
  if (!same)
  {
    Fail(frame,
      "Patient Orientation (0020,0020) says that rows and columns lead to " + stated[0] + " and " +
        stated[1] + ", but Image Orientation (Patient) (0020,0037) to " + GetMainLetter(axes[0]) +
        " and " + GetMainLetter(axes[1]) +
        ": one of them is wrong, and left and right may be exchanged. Export original images; or "
        "compare with the hospital's viewer, and if (0020,0037) is right remove (0020,0020)");
  }
}

void CheckImage(const CTFrame& frame)
{
  const CTFileHeader& header = *frame.Header;
  if (!header.PixelError.empty())
  {
    Fail(frame, header.PixelError);
  }
  if (header.Columns < 1 || header.Rows < 1)
  {
    Fail(frame, "has no valid Rows (0028,0010) and Columns (0028,0011)");
  }
  if (!frame.Position)
  {
    Fail(frame, "has no valid Image Position (Patient) (0020,0032), so where it lies is unknown");
  }
  if (!frame.Axes)
  {
    Fail(frame, "has no valid Image Orientation (Patient) (0020,0037), so how it lies is unknown");
  }
  if (!frame.Spacing || !IsPositive((*frame.Spacing)[0]) || !IsPositive((*frame.Spacing)[1]))
  {
    Fail(frame, "has no valid Pixel Spacing (0028,0030)");
  }
  CheckPatientOrientation(frame);
}

// Cone-beam scanners write files whose frames have one position in common.
void CheckFramePositions(const std::vector<CTFrame>& frames)
{
  struct File
  {
    const CTFrame* First;
    int Count;
    bool Differ;
  };
  std::map<const CTFileHeader*, File> files;
  for (const CTFrame& frame : frames)
  {
    const auto entry = files.insert({ frame.Header.get(), { &frame, 0, false } });
    File& file = entry.first->second;
    ++file.Count;
    const auto& position = file.First->Position;
    file.Differ = file.Differ || !frame.Position || !position || !(*frame.Position == *position);
  }
  for (const auto& [header, file] : files)
  {
    if (file.Count > 1 && !file.Differ)
    {
      throw std::runtime_error(GetBaseName(header->File) + ": has " +
        std::to_string(header->Frames) +
        " frames (0028,0008), but one Image Position (Patient) (0020,0032) for all of them, so "
        "where they lie is unknown. Spacing Between Slices (0018,0088) does not say to which side. "
        "Export the scan as enhanced CT, or one file for each image");
    }
  }
}

void CheckSame(const CTFrame& frame, const CTFrame& first)
{
  const CTFileHeader& a = *frame.Header;
  const CTFileHeader& b = *first.Header;
  const auto fail = [&](const std::string& what)
  { throw std::runtime_error(frame.GetNameBeside(first) + ": " + what); };
  if (a.Columns != b.Columns || a.Rows != b.Rows)
  {
    std::ostringstream what;
    what << "has " << a.Columns << " x " << a.Rows
         << " pixels (Columns (0028,0011) x Rows (0028,0010)), but " << first.GetNameBeside(frame)
         << " has " << b.Columns << " x " << b.Rows;
    fail(what.str());
  }
  if (Difference(frame.Spacing, first.Spacing) > 1e-4 * (*first.Spacing)[0])
  {
    std::ostringstream what;
    what << "has Pixel Spacing (0028,0030) " << (*frame.Spacing)[0] << " x " << (*frame.Spacing)[1]
         << " mm, but " << first.GetNameBeside(frame) << " has " << (*first.Spacing)[0] << " x "
         << (*first.Spacing)[1] << " mm";
    fail(what.str());
  }
  if (Difference(frame.Axes, first.Axes) > 1e-4)
  {
    fail("has another Image Orientation (Patient) (0020,0037) than " + first.GetNameBeside(frame) +
      "; the images of a volume are parallel");
  }
  if (a.Patient.Id != b.Patient.Id || a.Patient.Name != b.Patient.Name)
  {
    const bool byId = a.Patient.Id != b.Patient.Id;
    fail(std::string("is of another patient (") + (byId ? "0010,0020" : "0010,0010") + ") than " +
      first.GetNameBeside(frame) + (byId ? "" : ": the name differs"));
  }
  if (a.FrameOfReferenceUid != b.FrameOfReferenceUid)
  {
    fail("has another Frame of Reference UID (0020,0052) than " + first.GetNameBeside(frame) +
      "; their positions cannot be compared");
  }
}
}

//------------------------------------------------------------------------------
std::string CTFrame::GetName() const
{
  std::string name = GetBaseName(this->Header->File);
  if (this->Header->Frames > 1)
  {
    name += " frame " + std::to_string(this->Number + 1);
  }
  return name;
}

//------------------------------------------------------------------------------
std::string CTFrame::GetNameBeside(const CTFrame& other) const
{
  const std::string name = this->GetName();
  const std::string& path = this->Header->File;
  const bool same = name == other.GetName() && path != other.Header->File;
  return same ? path.substr(0, path.find_last_of('/') + 1) + name : name;
}

//------------------------------------------------------------------------------
std::string CTSeries::GetName() const
{
  return this->IsOneOfKernels ? NameWithKernel(*this) : this->Uid;
}

//------------------------------------------------------------------------------
std::string CTSeries::Describe() const
{
  std::ostringstream text;
  const CTFileHeader& header = *this->Frames.front().Header;
  text << this->GetName() << "  ";
  if (!header.SeriesNumber.empty())
  {
    text << "series " << header.SeriesNumber << ", ";
  }
  if (!header.SeriesDescription.empty())
  {
    text << "\"" << header.SeriesDescription << "\", ";
  }
  text << this->Frames.size() << (this->Frames.size() == 1 ? " image of " : " images of ")
       << header.Columns << " x " << header.Rows;
  const std::size_t acquisitions = this->GetAcquisitions().size();
  if (acquisitions > 1)
  {
    text << ", " << acquisitions << " acquisitions";
  }
  return text.str();
}

//------------------------------------------------------------------------------
std::vector<int> CTSeries::GetAcquisitions() const
{
  std::set<int> numbers;
  for (const CTFrame& frame : this->Frames)
  {
    if (frame.Acquisition)
    {
      numbers.insert(*frame.Acquisition);
    }
  }
  return { numbers.begin(), numbers.end() };
}

//------------------------------------------------------------------------------
std::string CTSeriesList::Describe() const
{
  std::string text;
  for (const CTSeries& series : this->Series)
  {
    text += "\n  " + series.Describe() + ", first file " + series.Frames.front().GetName();
  }
  return text;
}

//------------------------------------------------------------------------------
std::string WhyNotInVolume(const CTFrame& frame)
{
  const CTFileHeader& header = *frame.Header;
  if (header.Modality == "RTSTRUCT")
  {
    return "is an RT structure set, not CT (0008,0060); open it with Outline Reader";
  }
  if (header.Modality != "CT")
  {
    return header.Modality.empty() ? "has no Modality (0008,0060)"
                                   : "is of modality " + header.Modality + ", not CT (0008,0060)";
  }
  if (header.SopClassUid.rfind(SecondaryCapture, 0) == 0)
  {
    return "is a secondary capture (0008,0016)";
  }
  if (header.SeriesUid.empty())
  {
    return "has no Series Instance UID (0020,000E)";
  }
  if (IsLocalizer(frame))
  {
    return "is a localizer (0008,0008)";
  }
  if (header.SamplesPerPixel != 1)
  {
    return "is a colour image (0028,0002)";
  }
  return {};
}

//------------------------------------------------------------------------------
CTSeriesList ListSeries(const std::vector<CTFrame>& frames)
{
  struct Omission
  {
    std::string Example;
    int Count = 0;
  };
  std::map<std::string, Omission> omitted;
  std::map<std::string, CTSeries> found;
  for (const CTFrame& frame : frames)
  {
    const std::string why = WhyNotInVolume(frame);
    if (!why.empty())
    {
      Omission& omission = omitted[why];
      omission.Example = omission.Count == 0 ? frame.GetName() : omission.Example;
      ++omission.Count;
      continue;
    }
    // a series whose files disagree on its number is one nevertheless
    CTSeries& series = found[frame.Header->SeriesUid];
    series.Uid = frame.Header->SeriesUid;
    series.Frames.push_back(frame);
  }
  CTSeriesList list;
  for (auto& entry : found)
  {
    for (CTSeries& part : SplitByKernel(std::move(entry.second)))
    {
      list.Series.push_back(std::move(part));
    }
  }
  const auto number = [](const CTSeries& series)
  { return std::strtol(series.Frames.front().Header->SeriesNumber.c_str(), nullptr, 10); };
  std::stable_sort(list.Series.begin(), list.Series.end(),
    [&](const CTSeries& a, const CTSeries& b) { return number(a) < number(b); });
  if (list.Series.size() > 1)
  {
    list.Notes.push_back("there are " + std::to_string(list.Series.size()) +
      " CT series (0020,000E) or kernels (0018,1210); SeriesList names them, one is read");
  }
  for (const auto& [why, omission] : omitted)
  {
    std::string note = omission.Example + ": left out, it " + why;
    if (omission.Count > 1)
    {
      note += "; so are " + std::to_string(omission.Count - 1) + " others";
    }
    list.Notes.push_back(note);
  }
  return list;
}

//------------------------------------------------------------------------------
const CTSeries& SelectSeries(const CTSeriesList& list, const std::string& requested,
  const std::string& file, const std::string& openedUid)
{
  std::string notes;
  for (const std::string& note : list.Notes)
  {
    notes += "\n  " + note;
  }
  if (list.Series.empty())
  {
    throw std::runtime_error(file + ": there is no CT image" + notes);
  }
  const std::string uid = requested.substr(0, requested.find(' '));
  const std::string wanted = uid.empty() ? openedUid : uid;
  if (wanted.empty() && list.Series.size() == 1)
  {
    return list.Series.front();
  }
  if (wanted.empty())
  {
    throw std::runtime_error(file + ": there are " + std::to_string(list.Series.size()) +
      " CT series" + DescribePatients(list.Series) +
      "; set SeriesUID to one of these (0020,000E):" + list.Describe());
  }
  const bool hasKernel = requested.rfind(uid + " kernel ", 0) == 0;
  const auto holdsFile = [&](const CTSeries& series)
  {
    return std::any_of(series.Frames.begin(), series.Frames.end(),
      [&](const CTFrame& frame) { return GetBaseName(frame.Header->File) == GetBaseName(file); });
  };
  std::vector<const CTSeries*> found;
  for (const CTSeries& series : list.Series)
  {
    if (series.Uid == wanted && (!hasKernel || IsNamed(requested, NameWithKernel(series))) &&
      (!uid.empty() || !series.IsOneOfKernels || holdsFile(series)))
    {
      found.push_back(&series);
    }
  }
  if (found.size() == 1)
  {
    return *found.front();
  }
  if (!found.empty())
  {
    throw std::runtime_error(file + ": series " + wanted + " has " + std::to_string(found.size()) +
      " convolution kernels (0018,1210); set SeriesUID to one of these:" + list.Describe());
  }
  const std::string what = uid.empty()
    ? ": the series of this file has no image for a CT volume"
    : ": there is no CT series " + (hasKernel ? requested : wanted);
  throw std::runtime_error(file + what + "; there are:" + list.Describe() + notes);
}

//------------------------------------------------------------------------------
std::vector<CTFrame> SelectAcquisition(const CTSeries& series, int acquisition)
{
  std::vector<CTFrame> frames;
  for (const CTFrame& frame : series.Frames)
  {
    if (acquisition == -1 || frame.Acquisition == acquisition)
    {
      frames.push_back(frame);
    }
  }
  if (frames.empty())
  {
    std::string numbers;
    for (const int number : series.GetAcquisitions())
    {
      numbers += " " + std::to_string(number);
    }
    throw std::runtime_error("series " + series.Uid + " has no image of acquisition " +
      std::to_string(acquisition) +
      " (0020,0012); there are:" + (numbers.empty() ? " none" : numbers));
  }
  return frames;
}

//------------------------------------------------------------------------------
std::vector<std::string> TakeOutScouts(std::vector<CTFrame>& frames)
{
  std::vector<std::pair<Vec3, std::size_t>> directions; // normals, and how many images have them
  const auto find = [&](const Vec3& normal)
  {
    return std::find_if(directions.begin(), directions.end(),
      [&](const auto& known) { return std::abs(Dot(known.first, normal)) > 1 - 1e-6; });
  };
  for (const CTFrame& frame : frames)
  {
    const Vec3 normal = GetNormal(frame);
    const auto known = find(normal);
    if (known != directions.end())
    {
      ++known->second;
    }
    else if (Norm(normal) > 0)
    {
      directions.emplace_back(normal, 1);
    }
    if (directions.size() > MostDirections)
    {
      return {}; // whatever this is, it is no stack with scouts
    }
  }
  const auto main = std::max_element(directions.begin(), directions.end(),
    [](const auto& a, const auto& b) { return a.second < b.second; });
  if (main == directions.end() || main->second < 3)
  {
    return {};
  }
  const auto isScout = [&](const CTFrame& frame)
  {
    const Vec3 normal = GetNormal(frame);
    const auto known = find(normal);
    return known != directions.end() && known->second <= 2 &&
      std::abs(Dot(normal, main->first)) < 0.5;
  };
  const auto scouts =
    static_cast<std::size_t>(std::count_if(frames.begin(), frames.end(), isScout));
  if (2 * scouts > main->second)
  {
    return {};
  }
  std::vector<std::string> notes;
  const auto end = std::stable_partition(
    frames.begin(), frames.end(), [&](const CTFrame& frame) { return !isScout(frame); });
  for (auto scout = end; scout != frames.end(); ++scout)
  {
    notes.push_back(scout->GetName() +
      ": left out, it is a scout by its Image Orientation (Patient) (0020,0037): it lies across " +
      std::to_string(main->second) + " parallel images");
  }
  frames.erase(end, frames.end());
  return notes;
}

//------------------------------------------------------------------------------
void CheckSameVolume(const std::vector<CTFrame>& frames)
{
  CheckFramePositions(frames);
  for (const CTFrame& frame : frames)
  {
    CheckImage(frame);
    CheckSame(frame, frames.front());
  }
}

//------------------------------------------------------------------------------
std::vector<std::string> FindDoubtsOfSeries(const std::vector<CTFrame>& frames)
{
  using Value = std::function<const std::string&(const CTFileHeader&)>;
  const std::pair<const char*, Value> tags[] = {
    { "Patient's Birth Date (0010,0030)",
      [](const CTFileHeader& h) -> const std::string& { return h.Patient.BirthDate; } },
    { "Patient's Sex (0010,0040)",
      [](const CTFileHeader& h) -> const std::string& { return h.Patient.Sex; } },
    { "Patient Position (0018,5100)",
      [](const CTFileHeader& h) -> const std::string& { return h.PatientPosition; } },
    { "Convolution Kernel (0018,1210)",
      [](const CTFileHeader& h) -> const std::string& { return h.ConvolutionKernel; } },
  };
  std::vector<std::string> doubts;
  for (const auto& [name, value] : tags)
  {
    const CTFrame* first = nullptr; // that has a value
    const CTFrame* other = nullptr;
    std::size_t count = 0;
    for (const CTFrame& frame : frames)
    {
      const std::string& text = value(*frame.Header);
      first = first || text.empty() ? first : &frame;
      if (first && !text.empty() && text != value(*first->Header))
      {
        other = other ? other : &frame;
        ++count;
      }
    }
    if (other)
    {
      doubts.push_back(other->GetNameBeside(*first) +
        (count > 1 ? " and " + std::to_string(count - 1) + " more have" : std::string(" has")) +
        " another " + name + " than " + first->GetNameBeside(*other) +
        ": two scans, or two reconstructions of one, may have got into one series; compare with "
        "the "
        "hospital's viewer");
    }
  }
  return doubts;
}
}
