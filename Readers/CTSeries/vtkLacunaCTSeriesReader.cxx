// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaCTSeriesReader.h"

#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaCTGeometry.h"
#include "lacunaCTSeries.h"
#include "lacunaCTVolume.h"
#include "lacunaCoordinates.h"
#include "lacunaDicomDecoder.h"
#include "lacunaDicomFolder.h"
#include "lacunaFieldData.h"
#include "lacunaHounsfield.h"
#include "lacunaMemory.h"
#include "lacunaParameterText.h"
#include "lacunaPatientIdentity.h"
#include "lacunaPrintableText.h"
#include "lacunaReading.h"
#include "lacunaVolumeDirection.h"
#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkExecutive.h"
#include "vtkExtentTranslator.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationIntegerRequestKey.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkOutputWindow.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <new>
#include <utility>

namespace
{
constexpr const char* ScalarsName = "HounsfieldUnits";
constexpr std::array<const char*, 2> MissingSlicesNames{ "Error", "Interpolate" };
constexpr std::array<const char*, 2> GantryTiltNames{ "Correct", "Refuse" };

std::string Text(const char* s)
{
  return s ? s : "";
}

void AddString(vtkDataObject* data, const char* name, const std::string& text)
{
  if (text.empty())
  {
    return;
  }
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  array->InsertNextValue(text);
  data->GetFieldData()->AddArray(array);
}

// Headers are read before the request for data, when VTK has not yet reset an abort of before.
class HeaderExecution : public lacuna::AlgorithmExecution
{
public:
  using lacuna::AlgorithmExecution::AlgorithmExecution;

protected:
  bool OnProgress(double) override { return true; }
};

// The notes on files that message does not have yet: a file that was left out may be what it is
// about.
std::string AddNotes(const std::string& message, const std::vector<std::string>& notes)
{
  constexpr std::size_t Most = 8;
  std::vector<std::string> fresh;
  for (const std::string& note : notes)
  {
    if (message.find(note.substr(0, note.rfind("; the file is left out"))) == std::string::npos)
    {
      fresh.push_back(note);
    }
  }
  std::string text = message;
  for (std::size_t i = 0; i < std::min(fresh.size(), Most); ++i)
  {
    text += (i == 0 ? "\nOf the files there:\n  " : "\n  ") + fresh[i];
  }
  return fresh.size() > Most
    ? text + "\n  and " + std::to_string(fresh.size() - Most) + " notes more"
    : text;
}

// Keeps its memory from pair to pair.
class ImageComparison
{
public:
  bool operator()(const lacuna::CTFrame& a, const lacuna::CTFrame& b)
  {
    if (a.RescaleSlope != b.RescaleSlope || a.RescaleIntercept != b.RescaleIntercept)
    {
      return false;
    }
    this->Decoder.Read(a, this->First);
    this->Decoder.Read(b, this->Second);
    return this->First.Format.Signed == this->Second.Format.Signed &&
      this->First.Bytes == this->Second.Bytes;
  }

private:
  lacuna::DicomDecoder Decoder;
  lacuna::CTPixels First;
  lacuna::CTPixels Second;
};
}

struct vtkLacunaCTSeriesReader::Content
{
  // The header is another object when the file has changed.
  using Image = std::pair<std::shared_ptr<const lacuna::CTFileHeader>, int>;

  lacuna::DicomFolder Folder;
  vtkNew<vtkStringArray> SeriesList;
  vtkNew<vtkStringArray> Notes;
  bool Warned = false; // of what follows
  std::vector<std::string> Warnings;
  lacuna::CTGeometry Geometry;
  lacuna::ScalarType Type = lacuna::ScalarType::Int16;
  std::map<std::pair<Image, Image>, bool> SameImages; // whose pixels were compared
};

vtkStandardNewMacro(vtkLacunaCTSeriesReader);

//------------------------------------------------------------------------------
vtkLacunaCTSeriesReader::vtkLacunaCTSeriesReader()
  : Found(std::make_unique<Content>())
{
  this->Sharing = lacuna::Share::Parts;
  this->SetNumberOfInputPorts(0);
}

//------------------------------------------------------------------------------
vtkLacunaCTSeriesReader::~vtkLacunaCTSeriesReader()
{
  this->SetFileName(nullptr);
  this->SetSeriesUID(nullptr);
}

//------------------------------------------------------------------------------
int vtkLacunaCTSeriesReader::CanReadFile(const char* fileName)
{
  return fileName && lacuna::IsCTFileOrFolder(fileName) ? 1 : 0;
}

//------------------------------------------------------------------------------
vtkStringArray* vtkLacunaCTSeriesReader::GetSeriesList()
{
  return this->Found->SeriesList;
}

//------------------------------------------------------------------------------
vtkStringArray* vtkLacunaCTSeriesReader::GetNotes()
{
  return this->Found->Notes;
}

//------------------------------------------------------------------------------
void vtkLacunaCTSeriesReader::OpenSeries()
{
  Content& found = *this->Found;
  HeaderExecution execution(this);
  const auto add = [&](const std::vector<std::string>& notes)
  {
    for (const std::string& note : notes)
    {
      found.Notes->InsertNextValue(note);
    }
  };
  found.Folder.Scan(this->FileName, execution);
  const lacuna::CTSeriesList list = lacuna::ListSeries(found.Folder.GetFrames());
  for (const lacuna::CTSeries& series : list.Series)
  {
    found.SeriesList->InsertNextValue(series.Describe());
  }
  found.Warnings = found.Folder.GetWarnings();
  add(found.Folder.GetWarnings());
  add(found.Folder.GetNotes());
  add(list.Notes);
  try
  {
    this->FindVolume(list);
  }
  catch (const lacuna::Aborted&)
  {
    throw;
  }
  catch (const std::runtime_error& e)
  {
    std::vector<std::string> omissions = found.Folder.GetWarnings();
    omissions.insert(omissions.end(), list.Notes.begin(), list.Notes.end());
    throw std::runtime_error(AddNotes(e.what(), omissions));
  }
  add(found.Geometry.Notes);
  found.Warnings.insert(
    found.Warnings.end(), found.Geometry.Warnings.begin(), found.Geometry.Warnings.end());
}

//------------------------------------------------------------------------------
void vtkLacunaCTSeriesReader::FindVolume(const lacuna::CTSeriesList& list)
{
  this->CheckProperties();
  Content& found = *this->Found;
  const std::string requested = Text(this->SeriesUID);
  const std::string file = this->FileName;
  const std::string opened = found.Folder.GetOpenedSeries();
  const lacuna::CTSeries& series = lacuna::SelectSeries(list, requested, file, opened);
  std::vector<lacuna::CTFrame> frames = lacuna::SelectAcquisition(series, this->Acquisition);
  for (const std::string& note : lacuna::TakeOutScouts(frames))
  {
    found.Notes->InsertNextValue(note);
  }
  lacuna::CheckSameVolume(frames);
  const std::vector<std::string> doubts = lacuna::FindDoubtsOfSeries(frames);
  found.Warnings.insert(found.Warnings.end(), doubts.begin(), doubts.end());
  const std::string doubt = lacuna::CheckRescaleType(frames);
  if (!doubt.empty())
  {
    found.Warnings.push_back(doubt);
  }
  found.Type = lacuna::GetHounsfieldType(frames, this->PaddingValue);

  lacuna::CTGeometryOptions options;
  options.InterpolateMissing = this->MissingSlices == Interpolate;
  options.CorrectTilt = this->GantryTilt == Correct;
  options.PositionTolerance = this->PositionTolerance;
  // each change of a property comes here, and a series may be there twice as a whole
  const auto known = std::exchange(found.SameImages, {});
  ImageComparison isSame;
  options.SameImage = [&](const lacuna::CTFrame& a, const lacuna::CTFrame& b)
  {
    const std::pair<Content::Image, Content::Image> pair{ { a.Header, a.Number },
      { b.Header, b.Number } };
    const auto before = known.find(pair);
    const bool same = before == known.end() ? isSame(a, b) : before->second;
    found.SameImages.emplace(pair, same);
    return same;
  };
  found.Geometry = lacuna::FindCTGeometry(frames, options);
}

//------------------------------------------------------------------------------
void vtkLacunaCTSeriesReader::Announce(const lacuna::Ports& ports)
{
  Content& found = *this->Found;
  found.Warned = false;
  found.SeriesList->Reset();
  found.Notes->Reset();
  lacuna::Reading::Run(
    this->FileName, "a DICOM file of a CT series, or its folder",
    [this](unsigned long code) { this->SetErrorCode(code); },
    [&]
    {
      this->OpenSeries();
      this->AnnounceGrid(ports.GetOutputInformation());
    });
}

//------------------------------------------------------------------------------
void vtkLacunaCTSeriesReader::AnnounceGrid(vtkInformation* info) const
{
  const Content& found = *this->Found;
  const lacuna::CTGeometry& geometry = found.Geometry;
  const int extent[6] = { 0, static_cast<int>(geometry.Columns) - 1, 0,
    static_cast<int>(geometry.Rows) - 1, 0, static_cast<int>(geometry.Planes.size()) - 1 };
  double direction[9];
  for (int i = 0; i < 9; ++i)
  {
    direction[i] = geometry.Axes[i % 3][i / 3];
  }
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkDataObject::ORIGIN(), geometry.Origin.data(), 3);
  info->Set(vtkDataObject::SPACING(), geometry.Spacing.data(), 3);
  info->Set(vtkDataObject::DIRECTION(), direction, 9);
  // Ranks share out whole images, each of which is read by one of them.
  info->Set(vtkExtentTranslator::UPDATE_SPLIT_MODE(), vtkExtentTranslator::Z_SLAB_MODE);
  vtkDataObject::SetPointDataActiveScalarInfo(info, lacuna::ArrayScalarType::ToVTK(found.Type), 1);
}

//------------------------------------------------------------------------------
void vtkLacunaCTSeriesReader::Describe(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("MissingSlices", this->MissingSlices, MissingSlicesNames)
    .Add("GantryTilt", this->GantryTilt, GantryTiltNames)
    .Add("Acquisition", this->Acquisition, ValueRange::AtLeast(-1))
    .Add("PositionTolerance", this->PositionTolerance, lacuna::CTGeometryOptions::ToleranceRange)
    .Add("PaddingValue", this->PaddingValue, ValueRange::Any("HU"))
    .Add("KeepPatientIdentity", this->KeepPatientIdentity);
}

//------------------------------------------------------------------------------
std::string vtkLacunaCTSeriesReader::Parameters(int) const
{
  const lacuna::CTGeometry& geometry = this->Found->Geometry;
  lacuna::Properties properties;
  properties
    // tells which scan it was to one who has it, and nothing to others
    .Add("Series", "fnv1a:" + lacuna::HashText(geometry.Slices[0].Frame.Header->SeriesUid))
    .Add("Images", geometry.Slices.size());
  this->Describe(properties);
  properties.Add("Interpolated", geometry.Interpolated.size()).Add("Tilt", geometry.TiltDegrees);
  return properties.GetText();
}

//------------------------------------------------------------------------------
void vtkLacunaCTSeriesReader::AddFieldData(vtkImageData* output) const
{
  const lacuna::CTGeometry& geometry = this->Found->Geometry;
  const lacuna::CTFileHeader& header = *geometry.Slices[0].Frame.Header;
  lacuna::VolumeDirection::Record(output);
  const std::pair<const char*, const std::string&> texts[] = { { "PatientPosition",
                                                                 header.PatientPosition },
    { "ConvolutionKernel", header.ConvolutionKernel }, { "PatientName", header.Patient.Name },
    { "PatientID", header.Patient.Id }, { "PatientBirthDate", header.Patient.BirthDate },
    { "PatientSex", header.Patient.Sex }, { "StudyDate", header.StudyDate },
    { "StudyInstanceUID", header.StudyUid }, { "SeriesInstanceUID", header.SeriesUid } };
  for (const auto& [name, text] : texts)
  {
    if (this->KeepPatientIdentity || !lacuna::IdentifiesPatient(name))
    {
      AddString(output, name, text);
    }
  }
  if (geometry.TiltDegrees != 0)
  {
    lacuna::FieldData::Set(output, "GantryTilt", { geometry.TiltDegrees }, 1);
  }
  if (!geometry.Interpolated.empty())
  {
    vtkNew<vtkIntArray> array;
    array->SetName("InterpolatedSlices");
    for (const int plane : geometry.Interpolated)
    {
      array->InsertNextValue(plane);
    }
    output->GetFieldData()->AddArray(array);
  }
  lacuna::Coordinates::Mark(output, lacuna::Coordinates::Patient);
}

//------------------------------------------------------------------------------
void vtkLacunaCTSeriesReader::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  Content& found = *this->Found;
  for (const std::string& warning : found.Warnings)
  {
    if (!found.Warned)
    {
      vtkWarningMacro(<< lacuna::ToPrintable(warning));
    }
  }
  found.Warned = true;
  vtkInformation* info = ports.GetOutputInformation();
  auto* output = ports.GetOutput<vtkImageData>();
  std::array<int, 6> extent = ports.GetExtent();
  output->SetOrigin(info->Get(vtkDataObject::ORIGIN()));
  output->SetSpacing(info->Get(vtkDataObject::SPACING()));
  output->SetDirectionMatrix(info->Get(vtkDataObject::DIRECTION()));
  output->SetExtent(extent.data());
  this->AddFieldData(output);
  lacuna::Reading::Run(
    this->FileName, "", [this](unsigned long code) { this->SetErrorCode(code); },
    [&]
    {
      lacuna::RequireMemory("The CT volume",
        static_cast<double>(output->GetNumberOfPoints()) *
          static_cast<double>(lacuna::GetScalarSize(found.Type)));
      void* voxels =
        lacuna::Arrays::AddScalars(output, lacuna::ArrayScalarType::ToVTK(found.Type), ScalarsName)
          ->GetVoidPointer(0);
      lacuna::PreferLargePages(voxels,
        static_cast<std::size_t>(output->GetNumberOfPoints()) * lacuna::GetScalarSize(found.Type));
      lacuna::DicomDecoder decoder;
      lacuna::ReadCTVolume(
        found.Geometry, extent, found.Type, this->PaddingValue,
        [&](const lacuna::CTFrame& frame, lacuna::CTPixels& pixels)
        { decoder.Read(frame, pixels); },
        voxels, execution);
    });
}

//------------------------------------------------------------------------------
void vtkLacunaCTSeriesReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->vtkLacunaAlgorithm::PrintSelf(os, indent);
  os << indent << "FileName: " << Text(this->FileName) << "\n";
  os << indent << "SeriesUID: " << Text(this->SeriesUID) << "\n";
}
