// SPDX-License-Identifier: BSD-3-Clause
// The reader in VTK: NIfTI files by way of VTK's header, requested parts, errors and recovery.
#include "NrrdFile.h"
#include "lacunaCheck.h"
#include "lacunaCoordinates.h"
#include "lacunaProvenance.h"
#include "lacunaVolumeDirection.h"
#include "vtkCallbackCommand.h"
#include "vtkDataArray.h"
#include "vtkErrorCode.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaVolumeReader.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkNIFTIImageReader.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cstring>
#include <functional>
#include <limits>

namespace
{
template <class T>
void Put(std::string& bytes, std::size_t at, T value, bool swapped)
{
  std::string part(sizeof(T), '\0');
  std::memcpy(part.data(), &value, sizeof(T));
  if (swapped)
  {
    std::reverse(part.begin(), part.end());
  }
  bytes.replace(at, sizeof(T), part);
}

// 4 x 3 x 2 voxels of 16 bits, 100 column + 10 row + slice; sform: x to the patient's left, y to
// superior, z to anterior. Offsets are those of nifti1.h.
struct Nifti
{
  bool Swapped = false; // the other byte order
  std::int16_t DataType = 4;
  std::int16_t Times = 1;
  float Slope = 1;
  float Intercept = -1024;
  std::string Magic = std::string("n+1\0", 4);
  std::int16_t Code = 1;
  float Shear = 0;
  std::int16_t SliceCount = 2;

  std::string Get() const
  {
    std::string bytes(352, '\0');
    const bool s = this->Swapped;
    Put(bytes, 0, 348, s);
    const std::int16_t dim[8] = { this->Times > 1 ? std::int16_t(4) : std::int16_t(3), 4, 3,
      this->SliceCount, this->Times, 1, 1, 1 };
    const float pixdim[8] = { 1, 0.5F, 1.5F, 2, 1, 0, 0, 0 };
    for (std::size_t i = 0; i < 8; ++i)
    {
      Put(bytes, 40 + 2 * i, dim[i], s);
      Put(bytes, 76 + 4 * i, pixdim[i], s);
    }
    Put(bytes, 70, this->DataType, s);
    Put(bytes, 72, std::int16_t(16), s);
    Put(bytes, 108, 352.F, s);
    Put(bytes, 112, this->Slope, s);
    Put(bytes, 116, this->Intercept, s);
    bytes[123] = 10;
    Put(bytes, 254, this->Code, s);
    const float rows[12] = { -0.5F, this->Shear, 0, 10, 0, 0, 2, 20, 0, 1.5F, 0, 30 };
    for (std::size_t i = 0; i < 12; ++i)
    {
      Put(bytes, 280 + 4 * i, rows[i], s);
    }
    bytes.replace(344, 4, this->Magic);
    for (int k = 0; k < 2 * this->Times; ++k)
    {
      for (int n = 0; n < 12; ++n)
      {
        std::string value(2, '\0');
        Put(value, 0, static_cast<std::int16_t>(100 * (n % 4) + 10 * (n / 4) + k % 2), s);
        bytes += value;
      }
    }
    return bytes;
  }
};

struct Test
{
  TemporaryFile File;
  vtkNew<vtkLacunaVolumeReader> Reader;
  vtkNew<lacunaCheck::Messages> Messages;

  explicit Test(const std::string& name, const std::string& content)
    : File(name, content)
  {
    this->Reader->SetFileName(this->File.GetPath().c_str());
    this->Messages->Watch(this->Reader);
    vtkNew<vtkCallbackCommand> nothing; // executives repeat what algorithms report
    nothing->SetCallback([](vtkObject*, unsigned long, void*, void*) {});
    this->Reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, nothing);
  }
  vtkImageData* Update()
  {
    this->Messages->Errors.clear();
    this->Messages->Warnings.clear();
    this->Reader->Update();
    return this->Reader->GetOutput();
  }
  void Change(const std::string& content)
  {
    this->File.Write(content);
    this->Reader->Modified();
  }
};

// Where the voxel with a stored value lies.
void CheckVoxels(vtkImageData* image, double intercept)
{
  LACUNA_CHECK(image->GetNumberOfPoints() == 24);
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  LACUNA_CHECK(scalars && std::string(scalars->GetName()) == "Intensity");
  for (vtkIdType at = 0; scalars && at < image->GetNumberOfPoints(); ++at)
  {
    const int value = static_cast<int>(scalars->GetTuple1(at) - intercept);
    const double ras[3] = { 10 - 0.5 * (value / 100), 20. + 2 * (value % 10),
      30 + 1.5 * (value / 10 % 10) };
    double point[3];
    image->GetPoint(at, point);
    LACUNA_CHECK_NEAR(point[0], -ras[0], 1e-9);
    LACUNA_CHECK_NEAR(point[1], -ras[1], 1e-9);
    LACUNA_CHECK_NEAR(point[2], ras[2], 1e-9);
  }
}

void TestNifti()
{
  Nifti file;
  Test test("ct.nii", file.Get());
  LACUNA_CHECK(test.Reader->CanReadFile(test.File.GetPath().c_str()) == 1);
  vtkImageData* image = test.Update();
  CheckVoxels(image, -1024);
  LACUNA_CHECK(test.Messages->Errors.empty());
  LACUNA_CHECK(image->GetScalarType() == VTK_INT);
  LACUNA_CHECK_NEAR(image->GetDirectionMatrix()->Determinant(), 1, 1e-12);
  LACUNA_CHECK(lacuna::Coordinates::Get(image) == lacuna::Coordinates::Patient);
  lacuna::VolumeDirection::Check(image);
  LACUNA_CHECK(image->GetFieldData()->HasArray(lacuna::VolumeDirection::ArrayName));
  const std::string provenance = lacuna::Provenance::Get(image).back();
  LACUNA_CHECK_CONTAINS(provenance, "FileName=fnv1a:");
  LACUNA_CHECK(provenance.find("ct.nii") == std::string::npos);
  file.Swapped = true;
  file.Intercept = 0;
  test.Change(file.Get());
  CheckVoxels(test.Update(), 0);
  LACUNA_CHECK(test.Reader->GetOutput()->GetScalarType() == VTK_SHORT);

  Test packed("CT.nii.gz", Gzip(Nifti().Get()));
  LACUNA_CHECK(packed.Reader->CanReadFile(packed.File.GetPath().c_str()) == 1);
  CheckVoxels(packed.Update(), -1024);
}

void TestParts()
{
  Test test("ct.nii.gz", Gzip(Nifti().Get()));
  CheckVoxels(test.Update(), -1024);
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(test.Reader->GetOutput());
  const int extent[6] = { 1, 2, 0, 2, 1, 1 };
  test.Reader->Modified();
  test.Reader->UpdateExtent(extent);
  vtkImageData* part = test.Reader->GetOutput();
  LACUNA_CHECK(part->GetNumberOfPoints() == 6);
  for (int j = 0; j <= 2; ++j)
  {
    for (int i = 1; i <= 2; ++i)
    {
      LACUNA_CHECK(part->GetScalarComponentAsDouble(i, j, 1, 0) ==
        whole->GetScalarComponentAsDouble(i, j, 1, 0));
    }
  }
}

void ExpectError(Test& test, const std::string& part)
{
  vtkImageData* image = test.Update();
  LACUNA_CHECK(image->GetNumberOfPoints() == 0);
  LACUNA_CHECK_CONTAINS(test.Messages->Errors, part);
  LACUNA_CHECK(test.Reader->GetErrorCode() != vtkErrorCode::NoError);
}

void TestNiftiErrors()
{
  Test test("ct.nii", Nifti().Get());
  CheckVoxels(test.Update(), -1024);
  const auto change = [&](const std::function<void(Nifti&)>& edit)
  {
    Nifti file;
    edit(file);
    test.Change(file.Get());
  };
  const auto fails = [&](const std::function<void(Nifti&)>& edit, const std::string& part)
  {
    change(edit);
    ExpectError(test, part);
    change([](Nifti&) {}); // and a good one again
    CheckVoxels(test.Update(), -1024);
    LACUNA_CHECK(test.Reader->GetErrorCode() == vtkErrorCode::NoError);
  };
  fails([](Nifti& f) { f.Times = 3; }, "several volumes");
  fails([](Nifti& f) { f.Code = 0; }, "does not say how the patient lies");
  fails([](Nifti& f) { f.Shear = 0.3F; }, "not at right angles");
  fails([](Nifti& f) { f.Shear = std::numeric_limits<float>::quiet_NaN(); }, "not finite");
  fails([](Nifti& f) { f.DataType = 32; }, "type 32");
  fails([](Nifti& f) { f.DataType = 77; }, "type 77");
  fails([](Nifti& f) { f.Magic = std::string(4, '\0'); }, ".hdr and .img");
  fails([](Nifti& f) { f.SliceCount = 30000; }, "2 of the 30000 slices");
  const std::string good = Nifti().Get();
  for (const std::size_t size : { 0, 1, 100, 347, 351, 352, 353, 390, 399 })
  {
    test.Change(good.substr(0, size));
    ExpectError(test, "ct.nii: ");
  }
  test.Change(good);
  test.Reader->SetNIfTITransform(vtkLacunaVolumeReader::QForm);
  ExpectError(test, "qform_code is 0");
  test.Reader->SetNIfTITransform(vtkLacunaVolumeReader::SForm);
  CheckVoxels(test.Update(), -1024);

  const std::string packed = Gzip(good);
  Test compressed("ct.nii.gz", packed);
  for (std::size_t size = 0; size < packed.size(); size += 3)
  {
    compressed.Change(packed.substr(0, size));
    ExpectError(compressed, "ct.nii.gz: ");
  }
  std::string damaged = packed;
  damaged[damaged.size() - 6] ^= 1; // the check sum
  compressed.Change(damaged);
  ExpectError(compressed, "corrupt");
  Nifti huge;
  huge.SliceCount = 32000;
  compressed.Change(Gzip(huge.Get()));
  ExpectError(compressed, "ct.nii.gz: ");
}

// VTK's own reader, whose matrix leads from its image to RAS, has the same values at the same places.
void TestBesideVTK()
{
  const Test test("ct.nii", Nifti().Get());
  test.Reader->Update();
  vtkImageData* own = test.Reader->GetOutput();
  vtkNew<vtkNIFTIImageReader> reader;
  reader->SetFileName(test.File.GetPath().c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  LACUNA_CHECK(image->GetNumberOfPoints() == 24);
  for (vtkIdType at = 0; at < image->GetNumberOfPoints(); ++at)
  {
    double point[4] = { 0, 0, 0, 1 };
    image->GetPoint(at, point);
    reader->GetSFormMatrix()->MultiplyPoint(point, point);
    double patient[3] = { -point[0], -point[1], point[2] };
    const vtkIdType there = own->FindPoint(patient);
    LACUNA_CHECK(there >= 0 &&
      own->GetPointData()->GetScalars()->GetTuple1(there) ==
        image->GetPointData()->GetScalars()->GetTuple1(at) - 1024);
  }
}

void TestOthers()
{
  Test test("none.nrrd", "");
  test.Reader->SetFileName(nullptr);
  ExpectError(test, "FileName is not set");
  LACUNA_CHECK(test.Reader->CanReadFile(nullptr) == 0);
  test.Reader->SetFileName("/nonexistent/ct.nii");
  ExpectError(test, "/nonexistent/ct.nii");
  LACUNA_CHECK(test.Reader->GetErrorCode() == vtkErrorCode::FileNotFoundError);
  test.Reader->SetFileName("/nonexistent/ct.mha");
  ExpectError(test, "no such file");

  const Test sequence("sweep.mha", MakeSequence().GetContent());
  LACUNA_CHECK(sequence.Reader->CanReadFile(sequence.File.GetPath().c_str()) == 0);

  NrrdFile file;
  file.Set("type", "uint8");
  file.Set("dimension", "4");
  file.Set("space", "RAS");
  file.Set("sizes", "3 2 2 2");
  file.Set("space directions", "none (1,0,0) (0,1,0) (0,0,1)");
  file.Set("kinds", "RGB-color domain domain domain");
  file.Set("space origin", "(0,0,0)");
  file.Set("encoding", "raw");
  file.Pixels = std::string("abcdefghijklmnopqrstuvwx");
  Test colours("colours.nrrd", file.GetContent());
  LACUNA_CHECK(colours.Reader->CanReadFile(colours.File.GetPath().c_str()) == 1);
  vtkImageData* image = colours.Update();
  LACUNA_CHECK(image->GetNumberOfScalarComponents() == 3);
  LACUNA_CHECK(image->GetScalarComponentAsDouble(1, 0, 0, 2) == 'f');
  file.Pixels = "abcdefghijklm";
  colours.Change(file.GetContent());
  ExpectError(colours, "1 of the 2 slices are there");
  file.Set("dimension", "3");
  file.Set("kinds", "domain domain domain");
  file.Set("space directions", "(1,0,0) (0,1,0) (0,0,1)");
  file.Set("sizes", "2000000 2000000 200000");
  colours.Change(file.GetContent());
  ExpectError(colours, "colours.nrrd: "); // before anything is allocated
  file.Remove("space origin");
  file.Set("sizes", "2 2 2");
  colours.Change(file.GetContent());
  colours.Update();
  LACUNA_CHECK_CONTAINS(colours.Messages->Warnings, "first voxel");
  colours.Reader->Print(std::cout);
}
}

int TestVolumeReader(int, char*[])
{
  TestNifti();
  TestParts();
  TestNiftiErrors();
  TestBesideVTK();
  TestOthers();
  return lacunaCheck::Result();
}
