// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "lacunaProvenance.h"
#include "lacunaTrackedSlices.h"
#include "vtkBitArray.h"
#include "vtkCallbackCommand.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkExtentTranslator.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImageMedian3D.h"
#include "vtkInformation.h"
#include "vtkInformationStringKey.h"
#include "vtkLacunaSpeckleFilter.h"
#include "vtkMatrix3x3.h"
#include "vtkPointData.h"
#include "vtkSOADataArrayTemplate.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTrivialProducer.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <sstream>
#include <string>

namespace
{
/// Values without order, by a hash of the position; extent and geometry of a cropped oblique image.
vtkSmartPointer<vtkImageData> MakeImage(int type, const int extent[6])
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(const_cast<int*>(extent));
  image->SetOrigin(-10, 20, 5);
  image->SetSpacing(0.5, 0.7, 2);
  const double direction[9] = { 0, 0, 1, 1, 0, 0, 0, 1, 0 };
  image->SetDirectionMatrix(direction);
  image->AllocateScalars(type, 1);
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  scalars->SetName("Echo");
  vtkNew<vtkUnsignedCharArray> mask;
  mask->SetName("vtkValidPointMask");
  unsigned hash = 12345;
  for (vtkIdType i = 0; i < scalars->GetNumberOfTuples(); ++i)
  {
    hash = hash * 1664525u + 1013904223u;
    scalars->SetComponent(i, 0, hash >> 24);
    mask->InsertNextValue(i % 3 != 0);
  }
  image->GetPointData()->AddArray(mask);
  return image;
}

double Value(vtkImageData* image, int x, int y, int z)
{
  return image->GetScalarComponentAsDouble(x, y, z, 0);
}

// The inner samples, where vtkImageMedian3D takes the whole window too.
void TestEqualsVTKMedian()
{
  const int extent[6] = { 3, 32, -4, 19, 0, 8 };
  const auto image = MakeImage(VTK_UNSIGNED_CHAR, extent);
  vtkNew<vtkImageMedian3D> vtk;
  vtk->SetInputData(image);
  vtk->SetKernelSize(5, 3, 3);
  vtk->Update();
  vtkNew<vtkLacunaSpeckleFilter> filter;
  filter->SetInputData(image);
  filter->SetKernelSize(5, 3, 3);
  filter->Update();
  bool equal = true;
  for (int z = 1; z <= 7; ++z)
  {
    for (int y = -3; y <= 18; ++y)
    {
      for (int x = 5; x <= 30; ++x)
      {
        equal = equal && Value(vtk->GetOutput(), x, y, z) == Value(filter->GetOutput(), x, y, z);
      }
    }
  }
  LACUNA_CHECK(equal);
}

void TestKeepsEverythingElse()
{
  const int extent[6] = { 3, 22, -4, 9, 2, 5 };
  const auto image = MakeImage(VTK_SHORT, extent);
  vtkNew<vtkDoubleArray> times;
  times->SetName(lacuna::TrackedSlices::TimestampName);
  times->SetNumberOfTuples(40); // all slices of the sweep, however cropped the stack is
  times->Fill(1.5);
  image->GetFieldData()->AddArray(times);
  vtkNew<vtkLacunaSpeckleFilter> filter;
  filter->SetInputData(image);
  filter->Update();
  vtkImageData* output = filter->GetOutput();
  for (int i = 0; i < 6; ++i)
  {
    LACUNA_CHECK(output->GetExtent()[i] == extent[i]);
  }
  for (int i = 0; i < 3; ++i)
  {
    LACUNA_CHECK(output->GetOrigin()[i] == image->GetOrigin()[i]);
    LACUNA_CHECK(output->GetSpacing()[i] == image->GetSpacing()[i]);
  }
  for (int i = 0; i < 9; ++i)
  {
    LACUNA_CHECK(
      output->GetDirectionMatrix()->GetData()[i] == image->GetDirectionMatrix()->GetData()[i]);
  }
  vtkDataArray* kept = output->GetFieldData()->GetArray(lacuna::TrackedSlices::TimestampName);
  LACUNA_CHECK(kept && kept->GetNumberOfTuples() == 40);
  vtkDataArray* mask = output->GetPointData()->GetArray("vtkValidPointMask");
  LACUNA_CHECK(mask && mask->GetComponent(1, 0) == 1 && mask->GetComponent(3, 0) == 0);
  LACUNA_CHECK(output->GetScalarType() == VTK_SHORT);
  LACUNA_CHECK(output->GetPointData()->GetNumberOfArrays() == 2);
  LACUNA_CHECK(std::string(output->GetPointData()->GetScalars()->GetName()) == "Echo");
  const auto steps = lacuna::Provenance::Get(output);
  LACUNA_CHECK(steps.size() == 1);
  LACUNA_CHECK(!steps.empty() &&
    steps[0].find("Operation=Median KernelSize=5,5,1 KernelShape=Box") != std::string::npos);
  // The input is as it was.
  LACUNA_CHECK(image->GetPointData()->GetScalars() != output->GetPointData()->GetScalars());
}

// VTK 9.6 shares the matrix that an image is given, and its pipeline writes into that of an output.
void TestLeavesDirectionsOfInputs()
{
  const int extent[6] = { 0, 4, 0, 4, 0, 2 };
  const auto first = MakeImage(VTK_SHORT, extent);
  const auto second = MakeImage(VTK_SHORT, extent);
  const double mirrored[9] = { 1, 0, 0, 0, 1, 0, 0, 0, -1 };
  second->SetDirectionMatrix(mirrored);
  vtkNew<vtkLacunaSpeckleFilter> filter;
  for (vtkImageData* image : { first.Get(), second.Get(), first.Get() })
  {
    filter->SetInputData(image);
    filter->Update();
  }
  for (int i = 0; i < 9; ++i)
  {
    const double* const output = filter->GetOutput()->GetDirectionMatrix()->GetData();
    LACUNA_CHECK(output[i] == (i == 2 || i == 3 || i == 7 ? 1 : 0));
    LACUNA_CHECK(first->GetDirectionMatrix()->GetData()[i] == output[i]);
    LACUNA_CHECK(second->GetDirectionMatrix()->GetData()[i] == mirrored[i]);
  }
}

void TestHonoursRequestedExtents()
{
  const int extent[6] = { 0, 40, 0, 30, 0, 12 };
  const auto image = MakeImage(VTK_FLOAT, extent);
  vtkNew<vtkTrivialProducer> producer;
  producer->SetOutput(image);
  producer->SetWholeExtent(const_cast<int*>(extent));
  for (int operation = 0; operation <= vtkLacunaSpeckleFilter::LaplacianOfGaussian; ++operation)
  {
    vtkNew<vtkLacunaSpeckleFilter> whole;
    vtkNew<vtkLacunaSpeckleFilter> part;
    for (vtkLacunaSpeckleFilter* filter : { whole.Get(), part.Get() })
    {
      filter->SetInputConnection(producer->GetOutputPort());
      filter->SetOperation(operation);
      filter->SetKernelSize(5, 4, 3);
    }
    whole->Update();
    const int asked[6] = { 10, 25, 0, 12, 6, 12 };
    part->UpdateExtent(asked);
    vtkImageData* piece = part->GetOutput();
    for (int i = 0; i < 6; ++i)
    {
      LACUNA_CHECK(piece->GetExtent()[i] == asked[i]);
    }
    LACUNA_CHECK(piece->GetPointData()->GetArray("vtkValidPointMask"));
    LACUNA_CHECK(piece->GetPointData()->GetArray("vtkValidPointMask")->GetComponent(0, 0) ==
      image->GetPointData()
        ->GetArray("vtkValidPointMask")
        ->GetComponent(
          image->ComputePointId(const_cast<int*>(std::array<int, 3>{ 10, 0, 6 }.data())), 0));
    bool equal = true;
    for (int z = 6; z <= 12; ++z)
    {
      for (int y = 0; y <= 12; ++y)
      {
        for (int x = 10; x <= 25; ++x)
        {
          equal = equal && Value(piece, x, y, z) == Value(whole->GetOutput(), x, y, z);
        }
      }
    }
    LACUNA_CHECK(equal);
    if (!equal)
    {
      std::cerr << "operation " << operation << "\n";
    }
  }
}

// Of other arrays: names, unit, colours, kind and values.
void TestPartsKeepOtherArrays()
{
  const int extent[6] = { 0, 9, -2, 6, 3, 8 };
  const auto image = MakeImage(VTK_FLOAT, extent);
  vtkNew<vtkDoubleArray> flow;
  flow->SetName("Flow");
  flow->SetNumberOfComponents(3);
  flow->SetComponentName(1, "along");
  vtkNew<vtkStringArray> texts;
  texts->SetName("Text");
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    flow->InsertNextTuple3(static_cast<double>(i), 2, 3);
    texts->InsertNextValue(std::to_string(i));
  }
  flow->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), "mm/s");
  flow->CreateDefaultLookupTable();
  image->GetPointData()->SetVectors(flow);
  image->GetPointData()->AddArray(texts);
  vtkNew<vtkLacunaSpeckleFilter> filter;
  filter->SetInputData(image);
  filter->UpdateInformation();
  const int asked[6] = { 2, 7, 1, 4, 3, 5 };
  filter->UpdateExtent(asked);
  vtkImageData* part = filter->GetOutput();
  LACUNA_CHECK(part->GetNumberOfPoints() == 6 * 4 * 3);
  auto* found = vtkDoubleArray::SafeDownCast(part->GetPointData()->GetVectors());
  auto* labels = vtkStringArray::SafeDownCast(part->GetPointData()->GetAbstractArray("Text"));
  LACUNA_CHECK(found && labels && std::string(found->GetName()) == "Flow");
  if (!found || !labels)
  {
    return;
  }
  LACUNA_CHECK(std::string(found->GetComponentName(1)) == "along");
  LACUNA_CHECK(
    found->HasInformation() && found->GetInformation()->Has(vtkDataArray::UNITS_LABEL()));
  LACUNA_CHECK(found->GetLookupTable() == flow->GetLookupTable());
  int corner[3] = { 7, 4, 5 };
  const vtkIdType whole = image->ComputePointId(corner);
  LACUNA_CHECK(found->GetComponent(part->ComputePointId(corner), 0) == static_cast<double>(whole));
  LACUNA_CHECK(labels->GetValue(part->ComputePointId(corner)) == std::to_string(whole));
}

void TestAsksForNoMoreThanItNeeds()
{
  const int extent[6] = { 0, 99, 0, 99, 0, 9 };
  const auto image = MakeImage(VTK_UNSIGNED_CHAR, extent);
  vtkNew<vtkTrivialProducer> producer;
  producer->SetOutput(image);
  producer->SetWholeExtent(const_cast<int*>(extent));
  vtkNew<vtkLacunaSpeckleFilter> filter;
  filter->SetInputConnection(producer->GetOutputPort());
  filter->SetOperation(vtkLacunaSpeckleFilter::Opening);
  filter->SetKernelSize(5, 4, 1);
  const int asked[6] = { 0, 9, 50, 59, 3, 3 };
  filter->UpdateExtent(asked);
  int needed[6];
  producer->GetOutputInformation(0)->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), needed);
  const int expected[6] = { 0, 13, 47, 62, 3, 3 };
  for (int i = 0; i < 6; ++i)
  {
    LACUNA_CHECK(needed[i] == expected[i]);
  }
}

/// What each rank of several makes, and asks for, under MPI.
void TestPieces()
{
  const int extent[6] = { -3, 40, 5, 30, 0, 12 };
  const auto image = MakeImage(VTK_SHORT, extent);
  vtkNew<vtkTrivialProducer> producer;
  producer->SetOutput(image);
  producer->SetWholeExtent(const_cast<int*>(extent));
  vtkNew<vtkLacunaSpeckleFilter> whole;
  whole->SetInputConnection(producer->GetOutputPort());
  whole->SetKernelSize(5, 3, 3);
  whole->Update();
  vtkNew<vtkExtentTranslator> translator;
  for (const int ghosts : { 0, 1 })
  {
    for (int piece = 0; piece < 3; ++piece)
    {
      vtkNew<vtkLacunaSpeckleFilter> part;
      part->SetInputConnection(producer->GetOutputPort());
      part->SetKernelSize(5, 3, 3);
      part->UpdatePiece(piece, 3, ghosts);
      vtkImageData* output = part->GetOutput();
      int expected[6];
      translator->PieceToExtentThreadSafe(
        piece, 3, ghosts, const_cast<int*>(extent), expected, vtkExtentTranslator::BLOCK_MODE, 0);
      LACUNA_CHECK(std::equal(expected, expected + 6, output->GetExtent()));
      int asked[6];
      producer->GetOutputInformation(0)->Get(
        vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), asked);
      const int reach[3] = { 2, 1, 1 };
      for (int i = 0; i < 6; ++i)
      {
        const int margin = i % 2 == 0 ? -reach[i / 2] : reach[i / 2];
        LACUNA_CHECK(asked[i] ==
          (i % 2 == 0 ? std::max(extent[i], expected[i] + margin)
                      : std::min(extent[i], expected[i] + margin)));
      }
      LACUNA_CHECK(output->GetPointData()->HasArray("vtkGhostType") == ghosts);
      bool equal = true;
      for (int z = expected[4]; z <= expected[5]; ++z)
      {
        for (int y = expected[2]; y <= expected[3]; ++y)
        {
          for (int x = expected[0]; x <= expected[1]; ++x)
          {
            equal = equal && Value(output, x, y, z) == Value(whole->GetOutput(), x, y, z);
          }
        }
      }
      LACUNA_CHECK(equal);
    }
  }
}

void TestTypesAndComponents()
{
  const int extent[6] = { 0, 15, 0, 9, 0, 3 };
  for (const int type : { VTK_CHAR, VTK_SIGNED_CHAR, VTK_UNSIGNED_CHAR, VTK_SHORT,
         VTK_UNSIGNED_SHORT, VTK_INT, VTK_UNSIGNED_INT, VTK_LONG, VTK_UNSIGNED_LONG, VTK_LONG_LONG,
         VTK_UNSIGNED_LONG_LONG, VTK_ID_TYPE, VTK_FLOAT, VTK_DOUBLE })
  {
    const auto image = MakeImage(type, extent);
    vtkNew<vtkLacunaSpeckleFilter> filter;
    filter->SetInputData(image);
    filter->SetOperation(vtkLacunaSpeckleFilter::Maximum);
    filter->Update();
    LACUNA_CHECK(filter->GetOutput()->GetScalarType() == type);
    LACUNA_CHECK(Value(filter->GetOutput(), 5, 5, 1) >= Value(image, 6, 7, 1));
    filter->SetOperation(vtkLacunaSpeckleFilter::LaplacianOfGaussian);
    filter->Update();
    LACUNA_CHECK(
      filter->GetOutput()->GetScalarType() == (type == VTK_DOUBLE ? VTK_DOUBLE : VTK_FLOAT));
  }

  vtkNew<vtkImageData> vectors;
  vectors->SetDimensions(9, 8, 1);
  vectors->AllocateScalars(VTK_FLOAT, 3);
  for (vtkIdType i = 0; i < 72; ++i)
  {
    vectors->GetPointData()->GetScalars()->SetTuple3(i, i % 9, 100, i / 9);
  }
  vtkNew<vtkLacunaSpeckleFilter> filter;
  filter->SetInputData(vectors);
  filter->Update();
  const double* middle = filter->GetOutput()->GetPointData()->GetScalars()->GetTuple3(4 * 9 + 5);
  LACUNA_CHECK(middle[0] == 5 && middle[1] == 100 && middle[2] == 4);
}

void TestFiltersTheChosenArray()
{
  const int extent[6] = { 0, 15, 0, 9, 0, 0 };
  const auto image = MakeImage(VTK_UNSIGNED_CHAR, extent);
  vtkNew<vtkFloatArray> other;
  other->SetName("Other");
  other->SetNumberOfTuples(image->GetNumberOfPoints());
  other->Fill(3);
  other->SetValue(55, 1000);
  image->GetPointData()->AddArray(other);
  vtkNew<vtkLacunaSpeckleFilter> filter;
  filter->SetInputData(image);
  filter->SetScalarArray("Other");
  filter->Update();
  vtkPointData* data = filter->GetOutput()->GetPointData();
  LACUNA_CHECK(data->GetArray("Other")->GetComponent(55, 0) == 3);
  LACUNA_CHECK(data->GetScalars() == data->GetArray("Echo"));
  LACUNA_CHECK(data->GetScalars()->GetComponent(55, 0) ==
    image->GetPointData()->GetScalars()->GetComponent(55, 0));
}

void TestArraysThatAreNotContiguous()
{
  const int extent[6] = { 0, 15, 0, 9, 0, 0 };
  const auto image = MakeImage(VTK_FLOAT, extent);
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  vtkNew<vtkSOADataArrayTemplate<float>> apart; // one component after the other
  apart->SetName("Apart");
  apart->SetNumberOfComponents(2);
  apart->SetNumberOfTuples(scalars->GetNumberOfTuples());
  for (vtkIdType i = 0; i < scalars->GetNumberOfTuples(); ++i)
  {
    apart->SetTypedComponent(i, 0, 7);
    apart->SetTypedComponent(i, 1, static_cast<float>(scalars->GetComponent(i, 0)));
  }
  image->GetPointData()->AddArray(apart);
  vtkNew<vtkLacunaSpeckleFilter> single;
  vtkNew<vtkLacunaSpeckleFilter> both;
  single->SetInputData(image);
  both->SetInputData(image);
  both->SetScalarArray("Apart");
  single->Update();
  both->Update();
  vtkDataArray* truth = single->GetOutput()->GetPointData()->GetScalars();
  vtkDataArray* filtered = both->GetOutput()->GetPointData()->GetArray("Apart");
  for (vtkIdType i = 0; i < truth->GetNumberOfTuples(); ++i)
  {
    LACUNA_CHECK(filtered->GetComponent(i, 0) == 7);
    LACUNA_CHECK(filtered->GetComponent(i, 1) == truth->GetComponent(i, 0));
  }
}

void TestMillimetres()
{
  // An impulse spreads as far in mm along x as along y, whatever the spacing.
  vtkNew<vtkImageData> image;
  image->SetDimensions(81, 81, 1);
  image->SetSpacing(0.5, 1, 1);
  image->AllocateScalars(VTK_DOUBLE, 1);
  image->GetPointData()->GetScalars()->Fill(0);
  image->SetScalarComponentFromDouble(40, 40, 0, 0, 1);
  vtkNew<vtkLacunaSpeckleFilter> filter;
  filter->SetInputData(image);
  filter->SetOperation(vtkLacunaSpeckleFilter::Gaussian);
  filter->SetStandardDeviation(3);
  filter->Update();
  vtkImageData* output = filter->GetOutput();
  LACUNA_CHECK_NEAR(Value(output, 46, 40, 0) / Value(output, 40, 40, 0), std::exp(-0.5), 1e-12);
  LACUNA_CHECK_NEAR(Value(output, 40, 43, 0) / Value(output, 40, 40, 0), std::exp(-0.5), 1e-12);
}

void TestErrors()
{
  const int extent[6] = { 0, 15, 0, 9, 0, 0 };
  const auto image = MakeImage(VTK_UNSIGNED_CHAR, extent);
  const auto errors =
    [&](vtkImageData* input, const std::function<void(vtkLacunaSpeckleFilter*)>& set)
  {
    vtkNew<vtkLacunaSpeckleFilter> filter;
    vtkNew<lacunaCheck::Messages> messages;
    messages->Watch(filter);
    messages->Watch(filter->GetExecutive());
    filter->SetInputData(input);
    set(filter);
    filter->Update();
    LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
    return messages->Errors;
  };
  const auto has = [](const std::string& text, const char* part)
  { return text.find(part) != std::string::npos; };
  LACUNA_CHECK(has(errors(image, [](auto* f) { f->SetKernelSize(5, 0, 1); }),
    "KernelSize is 0 voxels; it must be from 1 to 255 voxels"));
  LACUNA_CHECK(has(errors(image, [](auto* f) { f->SetKernelSize(1, 1, 1000); }),
    "KernelSize is 1000 voxels; it must be from 1 to 255 voxels"));
  LACUNA_CHECK(has(errors(image,
                     [](auto* f)
                     {
                       f->SetOperation(vtkLacunaSpeckleFilter::AnyRank);
                       f->SetRank(101);
                     }),
    "Rank is 101; it must be from 0 to 100"));
  LACUNA_CHECK(has(errors(image,
                     [](auto* f)
                     {
                       f->SetOperation(vtkLacunaSpeckleFilter::Gaussian);
                       f->SetStandardDeviation(0);
                     }),
    "StandardDeviation is 0 mm; it must be above 0 mm"));
  LACUNA_CHECK(has(errors(image,
                     [](auto* f)
                     {
                       f->SetOperation(vtkLacunaSpeckleFilter::AdaptiveMedian);
                       f->SetAdaptiveStrength(-1);
                     }),
    "AdaptiveStrength is -1; it must be 0 or more"));
  LACUNA_CHECK(has(errors(image, [](auto* f) { f->SetOperation(14); }),
    "Operation is 14; it must be 0 (Median), 1 (Rank), 2 (Minimum), 3 (Maximum), 4 (Opening), "
    "5 (Closing), 6 (OpenClose), 7 (CloseOpen), 8 (Mode), 9 (AdaptiveMedian), 10 (Mean), "
    "11 (Gaussian), 12 (LaplacianOfGaussian) or 13 (TopHat)"));
  LACUNA_CHECK(has(errors(image, [](auto* f) { f->SetKernelShape(-1); }),
    "KernelShape is -1; it must be 0 (Box) or 1 (Ellipsoid)"));
  vtkNew<vtkImageData> bare;
  bare->SetDimensions(4, 4, 1);
  LACUNA_CHECK(has(errors(bare, [](auto*) {}), "no active point scalars"));

  LACUNA_CHECK(has(
    errors(image, [](auto* f) { f->SetScalarArray("Elsewhere"); }), "no point array 'Elsewhere'"));
  LACUNA_CHECK(has(errors(image,
                     [](auto* f)
                     {
                       f->SetOperation(vtkLacunaSpeckleFilter::LaplacianOfGaussian);
                       f->SetStandardDeviation(1e300);
                     }),
    "must be 0 to 166"));
  LACUNA_CHECK(has(errors(image, [](auto* f) { f->SetKernelSize(255, 255, 255); }),
    "at most 1048576 are possible"));

  // Arrays that are damaged or no numbers.
  vtkNew<vtkImageData> other;
  other->DeepCopy(image);
  vtkNew<vtkFloatArray> five;
  five->SetName("Five");
  five->SetNumberOfTuples(5);
  vtkNew<vtkBitArray> bits;
  bits->SetName("Bits");
  bits->SetNumberOfTuples(image->GetNumberOfPoints());
  vtkNew<vtkStringArray> words;
  words->SetName("Words");
  words->SetNumberOfTuples(image->GetNumberOfPoints());
  for (vtkAbstractArray* array :
    std::initializer_list<vtkAbstractArray*>{ five.Get(), bits.Get(), words.Get() })
  {
    other->GetPointData()->AddArray(array);
  }
  LACUNA_CHECK(has(errors(other, [](auto* f) { f->SetScalarArray("Five"); }),
    "its point array Five has 5 values for 160 points"));
  other->GetPointData()->RemoveArray("Five");
  LACUNA_CHECK(has(errors(other, [](auto* f) { f->SetScalarArray("Bits"); }), "of type bit"));
  LACUNA_CHECK(
    has(errors(other, [](auto* f) { f->SetScalarArray("Words"); }), "no point array 'Words'"));

  // A part of an image would be filtered as if it ended there.
  vtkNew<vtkTrivialProducer> producer;
  const int whole[6] = { 0, 30, 0, 9, 0, 0 };
  producer->SetOutput(image);
  producer->SetWholeExtent(const_cast<int*>(whole));
  LACUNA_CHECK(
    has(errors(image, [&](auto* f) { f->SetInputConnection(producer->GetOutputPort()); }),
      "only the part 0 15 0 9 0 0 of the image in input 0 arrived, 0 30 0 9 0 0 is needed"));

  // Nothing in, nothing out, no error.
  vtkNew<vtkImageData> empty;
  LACUNA_CHECK(errors(empty, [](auto*) {}).empty());
}

void TestWarnsWhenSlicesAreMixed()
{
  const int extent[6] = { 0, 15, 0, 9, 0, 4 };
  const auto image = MakeImage(VTK_UNSIGNED_CHAR, extent);
  vtkNew<vtkUnsignedCharArray> status;
  status->SetName(lacuna::TrackedSlices::SliceStatusName);
  status->SetNumberOfTuples(5);
  image->GetFieldData()->AddArray(status);
  for (const int z : { 1, 3 })
  {
    vtkNew<vtkLacunaSpeckleFilter> filter;
    vtkNew<lacunaCheck::Messages> messages;
    messages->Watch(filter);
    filter->SetInputData(image);
    filter->SetKernelSize(3, 3, z);
    filter->Update();
    LACUNA_CHECK(messages->HasWarning("tracked slices") == (z > 1));
  }
}

void TestAbort()
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(500, 500, 60);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  image->GetPointData()->GetScalars()->Fill(1);
  vtkNew<vtkLacunaSpeckleFilter> filter;
  filter->SetInputData(image);
  filter->SetKernelSize(9, 9, 9);
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
    { static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1); });
  filter->AddObserver(vtkCommand::ProgressEvent, stop);
  filter->Update();
  LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
}

void TestPrint()
{
  vtkNew<vtkLacunaSpeckleFilter> filter;
  std::ostringstream text;
  filter->Print(text);
  for (const char* name : { "ScalarArray: ", "Operation: Median", "KernelSize: 5,5,1",
         "KernelShape: Box", "Rank: 50", "AdaptiveStrength: 10", "StandardDeviation: 1.4" })
  {
    LACUNA_CHECK(text.str().find(name) != std::string::npos);
  }
}
}

int TestSpeckleFilter(int, char*[])
{
  TestEqualsVTKMedian();
  TestKeepsEverythingElse();
  TestLeavesDirectionsOfInputs();
  TestHonoursRequestedExtents();
  TestPartsKeepOtherArrays();
  TestAsksForNoMoreThanItNeeds();
  TestPieces();
  TestTypesAndComponents();
  TestFiltersTheChosenArray();
  TestArraysThatAreNotContiguous();
  TestMillimetres();
  TestErrors();
  TestWarnsWhenSlicesAreMixed();
  TestAbort();
  TestPrint();
  return lacunaCheck::Result();
}
