// SPDX-License-Identifier: BSD-3-Clause
// Every voxel of every scan has the Hounsfield units of its place in the patient.
#include "CTSeriesReaderTesting.h"
#include "CTTestCases.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"
#include "vtkType.h"

#include <algorithm>
#include <cmath>

namespace
{
lacuna::Vec3 GetPoint(vtkImageData* image, vtkIdType id)
{
  lacuna::Vec3 point{};
  image->GetPoint(id, point.data());
  return point;
}

bool IsNearEdge(const lacuna::Vec3& point, double distance)
{
  return IsInLetter(point, distance) != IsInLetter(point, -distance);
}

// error: of rounding, HU. Returns how many voxels lie in the letter.
int CheckVoxels(vtkImageData* image, double error)
{
  LACUNA_CHECK_NEAR(image->GetDirectionMatrix()->Determinant(), 1, 1e-12);
  vtkDataArray* values = image->GetPointData()->GetArray("HounsfieldUnits");
  int letter = 0;
  int wrong = 0;
  for (vtkIdType id = 0; values && id < image->GetNumberOfPoints(); ++id)
  {
    const lacuna::Vec3 point = GetPoint(image, id);
    letter += IsInLetter(point) ? 1 : 0;
    const bool edge = IsNearEdge(point, 1e-6);
    wrong += !edge && std::abs(values->GetTuple1(id) - CTTruth(point)) > error + 1e-5 ? 1 : 0;
  }
  LACUNA_CHECK_THAT(wrong == 0, std::to_string(wrong) + " voxels have another value");
  return letter;
}

void TestExact()
{
  const auto cases = MakeExactCases();
  LACUNA_CHECK_THAT(
    cases.size() == 24, "the user guide (cranioplasty.md) tells how many there are");
  for (const auto& [name, series] : cases)
  {
    ReaderOf test(series);
    test.Reader->Update();
    LACUNA_CHECK_THAT(test.Errors.empty(), name + ": " + test.Errors);
    LACUNA_CHECK_THAT(test.Warnings.empty(), name + ": " + test.Warnings);
    vtkImageData* image = test.Reader->GetOutput();
    int size[3];
    image->GetDimensions(size);
    LACUNA_CHECK_THAT(
      size[0] == series.Columns && size[1] == series.Rows && size[2] == series.Slices, name);
    const int letter = CheckVoxels(image, series.Slope / 2);
    LACUNA_CHECK_THAT(letter > 500, name);
    const int type = series.Slope != 1 ? VTK_FLOAT
      : name == "16 bits unsigned"     ? VTK_INT
                                       : VTK_SHORT;
    LACUNA_CHECK_THAT(name == "signed 13 bits" || image->GetScalarType() == type, name);
    LACUNA_CHECK_NEAR(image->GetSpacing()[0], 0.9, 1e-12);
    LACUNA_CHECK_NEAR(image->GetSpacing()[1], 1.3, 1e-12);
    LACUNA_CHECK_NEAR(image->GetSpacing()[2], lacuna::Norm(series.Step), 1e-9);
  }
}

// The truth is linear outside of the letter, and the correction is exact there.
void TestTilted()
{
  for (const auto& [name, series] : MakeTiltedCases())
  {
    ReaderOf test(series);
    test.Reader->Update();
    LACUNA_CHECK_THAT(test.Errors.empty(), name + ": " + test.Errors);
    vtkImageData* image = test.Reader->GetOutput();
    LACUNA_CHECK_NEAR(image->GetDirectionMatrix()->Determinant(), 1, 1e-12);
    vtkDataArray* values = image->GetPointData()->GetScalars();
    int inside = 0;
    int letter = 0;
    int wrong = 0;
    for (vtkIdType id = 0; values && id < image->GetNumberOfPoints(); ++id)
    {
      const double value = values->GetTuple1(id);
      const lacuna::Vec3 point = GetPoint(image, id);
      if (value == -1024 || IsNearEdge(point, 3))
      {
        continue;
      }
      ++inside;
      letter += IsInLetter(point) ? 1 : 0;
      wrong += std::abs(value - CTTruth(point)) > 1.2 ? 1 : 0;
    }
    LACUNA_CHECK_THAT(wrong == 0, name + ": " + std::to_string(wrong) + " wrong");
    LACUNA_CHECK_THAT(letter > 20, name + ": letter " + std::to_string(letter));
    // all pixels but the outermost are somewhere
    LACUNA_CHECK_THAT(inside > 0.6 * series.Columns * series.Rows * series.Slices, name);
    LACUNA_CHECK_CONTAINS(test.GetNotes(), "degrees");

    test.Reader->SetGantryTilt(vtkLacunaCTSeriesReader::Refuse);
    test.ExpectError("set GantryTilt to Correct");
  }
}

void TestTiltAngle()
{
  ReaderOf test(MakeTiltedCases()["tilted"]);
  test.Reader->Update();
  vtkDataArray* tilt = test.Reader->GetOutput()->GetFieldData()->GetArray("GantryTilt");
  LACUNA_CHECK(tilt != nullptr);
  LACUNA_CHECK_NEAR(tilt ? tilt->GetTuple1(0) : 0, 20, 1e-9);
}

// A rank gets whole slices.
void TestPieces()
{
  ReaderOf test{ CTTestSeries() };
  test.Reader->UpdatePiece(1, 3, 0);
  const int* extent = test.Reader->GetOutput()->GetExtent();
  LACUNA_CHECK(extent[0] == 0 && extent[1] == 43 && extent[2] == 0 && extent[3] == 35);
  LACUNA_CHECK(extent[4] > 0 && extent[5] < 16 && extent[5] > extent[4]);
  CheckVoxels(test.Reader->GetOutput(), 0.5);
}

// Any part of the volume is the same part of the whole.
void TestExtents()
{
  for (const CTTestSeries& series : { CTTestSeries(), MakeTiltedCases()["tilted both ways"] })
  {
    ReaderOf test(series);
    test.Reader->Update();
    const vtkMTimeType read = test.Reader->GetOutput()->GetUpdateTime();
    test.Reader->Update();
    LACUNA_CHECK(test.Reader->GetOutput()->GetUpdateTime() == read); // not once more
    vtkNew<vtkImageData> whole;
    whole->DeepCopy(test.Reader->GetOutput());
    for (const auto& part :
      { std::array<int, 6>{ 3, 20, 5, 11, 2, 2 }, std::array<int, 6>{ 0, 43, 7, 30, 4, 16 },
        std::array<int, 6>{ 43, 43, 35, 35, 16, 16 } })
    {
      vtkNew<vtkLacunaCTSeriesReader> reader;
      reader->SetFileName(test.Folder.c_str());
      reader->UpdateExtent(part.data());
      vtkImageData* image = reader->GetOutput();
      LACUNA_CHECK(std::equal(part.begin(), part.end(), image->GetExtent()));
      int wrong = 0;
      for (int k = part[4]; k <= part[5]; ++k)
      {
        for (int j = part[2]; j <= part[3]; ++j)
        {
          for (int i = part[0]; i <= part[1]; ++i)
          {
            wrong += image->GetScalarComponentAsDouble(i, j, k, 0) !=
                whole->GetScalarComponentAsDouble(i, j, k, 0)
              ? 1
              : 0;
          }
        }
      }
      LACUNA_CHECK(wrong == 0);
    }
  }
}

void TestPadding()
{
  CTTestSeries series;
  series.Edits = { { 0x0028, 0x0120, "SS", "-2000", {} }, { 0x0028, 0x0121, "SS", "-1990", {} } };
  series.Stored = [](int i, int j, int k) { return i < 3 ? -2000 + 5 * i : 10 * j + k; };
  ReaderOf test(series);
  test.Reader->SetPaddingValue(-1000);
  test.Reader->Update();
  LACUNA_CHECK(test.Errors.empty());
  vtkImageData* image = test.Reader->GetOutput();
  for (int i = 0; i < 3; ++i)
  {
    LACUNA_CHECK(image->GetScalarComponentAsDouble(i, 2, 1, 0) == -1000);
  }
  LACUNA_CHECK(image->GetScalarComponentAsDouble(3, 2, 1, 0) == 21);
}

// Each slice has its own rescale.
void TestRescalePerSlice()
{
  CTTestSeries series;
  series.Slices = 3;
  series.Edits = { { 0x0028, 0x1053, "DS", "2", { 1 } }, { 0x0028, 0x1052, "DS", "-7", { 1 } } };
  series.Stored = [](int i, int, int) { return 100 + i; };
  ReaderOf test(series);
  test.Reader->Update();
  vtkImageData* image = test.Reader->GetOutput();
  LACUNA_CHECK(image->GetScalarComponentAsDouble(4, 0, 0, 0) == 104);
  LACUNA_CHECK(image->GetScalarComponentAsDouble(4, 0, 1, 0) == 201);
  LACUNA_CHECK(image->GetScalarComponentAsDouble(4, 0, 2, 0) == 104);
}

std::string AllTexts(vtkDataObject* data)
{
  std::string all;
  vtkFieldData* fields = data->GetFieldData();
  for (int a = 0; a < fields->GetNumberOfArrays(); ++a)
  {
    all += std::string(fields->GetArrayName(a)) + "\n";
    auto* texts = vtkStringArray::SafeDownCast(fields->GetAbstractArray(a));
    for (vtkIdType i = 0; texts && i < texts->GetNumberOfValues(); ++i)
    {
      all += texts->GetValue(i) + "\n";
    }
  }
  return all;
}

void TestIdentity()
{
  ReaderOf test{ CTTestSeries() };
  test.Reader->Update();
  const std::string texts = AllTexts(test.Reader->GetOutput());
  for (const char* secret : { "Secret", "SECRET", "1901", "2026", "1.2.826", test.Folder.c_str() })
  {
    LACUNA_CHECK_THAT(texts.find(secret) == std::string::npos, secret);
    LACUNA_CHECK_THAT(test.GetSeriesList().find("Secret") == std::string::npos, "series list");
  }
  LACUNA_CHECK_CONTAINS(texts, "PatientPosition\nHFS\n");
  LACUNA_CHECK_CONTAINS(texts, "Series=fnv1a:");
  test.Reader->KeepPatientIdentityOn();
  test.Reader->Update();
  const std::string kept = AllTexts(test.Reader->GetOutput());
  LACUNA_CHECK_CONTAINS(kept, "PatientName\nSecret^Name\n");
  LACUNA_CHECK_CONTAINS(kept, "PatientID\nSECRET-ID\n");
  LACUNA_CHECK_CONTAINS(kept, "SeriesInstanceUID\n1.2.826.0.1.3680043.2.1125.1\n");
  const std::string provenance = kept.substr(kept.find("Provenance"));
  LACUNA_CHECK_THAT(provenance.find("1.2.826") == std::string::npos, "provenance");
}
}

int TestCTSeriesReader(int, char*[])
{
  TestExact();
  TestTilted();
  TestTiltAngle();
  TestExtents();
  TestPieces();
  TestPadding();
  TestRescalePerSlice();
  TestIdentity();
  return lacunaCheck::Result();
}
