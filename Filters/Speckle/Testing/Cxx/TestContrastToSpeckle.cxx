// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "lacunaProvenance.h"
#include "vtkCallbackCommand.h"
#include "vtkExecutive.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkLacunaContrastToSpeckle.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"
#include "vtkTrivialProducer.h"
#include "vtkUnsignedCharArray.h"

#include <cmath>
#include <functional>
#include <sstream>

namespace
{
/// 10 x 6 samples 1 mm apart from (100, 0, 0): 10 and 12 alternately, the left four columns 50
/// more.
vtkSmartPointer<vtkImageData> MakeImage()
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(10, 6, 1);
  image->SetOrigin(100, 0, 0);
  image->AllocateScalars(VTK_SHORT, 1);
  vtkNew<vtkIntArray> left;
  left->SetName("Left");
  for (int y = 0; y < 6; ++y)
  {
    for (int x = 0; x < 10; ++x)
    {
      image->SetScalarComponentFromDouble(x, y, 0, 0, 10 + 2 * (x % 2) + (x < 4 ? 50 : 0));
      left->InsertNextValue(x < 4 ? 7 : 0);
    }
  }
  image->GetPointData()->AddArray(left);
  return image;
}

double Get(vtkTable* table, const char* column)
{
  vtkDataArray* array = vtkDataArray::SafeDownCast(table->GetColumnByName(column));
  LACUNA_CHECK(array && array->GetNumberOfTuples() == 1);
  return array ? array->GetComponent(0, 0) : 0;
}

void TestMasksAndBoxes()
{
  const auto image = MakeImage();
  vtkNew<vtkLacunaContrastToSpeckle> contrast;
  contrast->SetInputData(image);
  contrast->SetInsideArray("Left");
  contrast->SetIsoValue(30);
  contrast->Update();
  vtkTable* table = contrast->GetOutput();
  LACUNA_CHECK(Get(table, "InsideCount") == 24);
  LACUNA_CHECK(Get(table, "OutsideCount") == 36);
  LACUNA_CHECK_NEAR(Get(table, "InsideMean"), 61, 1e-12);
  LACUNA_CHECK_NEAR(Get(table, "OutsideMean"), 11, 1e-12);
  LACUNA_CHECK_NEAR(Get(table, "InsideVariance"), 1, 1e-12);
  LACUNA_CHECK_NEAR(Get(table, "OutsideSNR"), 11, 1e-12);
  LACUNA_CHECK_NEAR(Get(table, "CSR"), 50 / std::sqrt(2.0), 1e-12);
  LACUNA_CHECK(Get(table, "Regions") == 1);
  LACUNA_CHECK(Get(table, "IsoValue") == 30);
  LACUNA_CHECK(lacuna::Provenance::Get(table).size() == 1);

  // The columns of 12 stand alone; so do those of 62.
  contrast->SetIsoValue(11.5);
  contrast->Update();
  LACUNA_CHECK(Get(table, "Regions") == 4);

  // Boxes: two columns inside, three outside, in physical coordinates.
  contrast->SetInsideArray("");
  contrast->SetInsideBounds(100, 101, 0, 5, 0, 0);
  contrast->SetOutsideBounds(107, 109, 0, 2, -1, 1);
  contrast->Update();
  LACUNA_CHECK(Get(table, "InsideCount") == 12);
  LACUNA_CHECK(Get(table, "OutsideCount") == 9);

  // A mask and a box: both must hold. Invalid points belong to no region.
  vtkNew<vtkUnsignedCharArray> valid;
  valid->SetName("vtkValidPointMask");
  valid->SetNumberOfTuples(60);
  valid->Fill(1);
  valid->SetValue(0, 0);
  image->GetPointData()->AddArray(valid);
  contrast->SetInsideArray("Left");
  contrast->SetInsideBounds(99, 101, 0, 0, 0, 0);
  contrast->SetOutsideBounds(1, -1, 1, -1, 1, -1);
  contrast->Update();
  LACUNA_CHECK(Get(table, "InsideCount") == 1);
  LACUNA_CHECK(Get(table, "OutsideCount") == 58);
}

void TestPieces()
{
  // Under MPI each rank asks its filter for a piece: all of the row is in the first. VTK 9.6 does
  // not make a table anew when the same filter is asked for another piece.
  for (const int piece : { 1, 0, 2 })
  {
    vtkNew<vtkLacunaContrastToSpeckle> contrast;
    contrast->SetInputData(MakeImage());
    contrast->SetInsideArray("Left");
    contrast->UpdatePiece(piece, 3, 0);
    vtkTable* table = contrast->GetOutput();
    LACUNA_CHECK(table->GetNumberOfColumns() == 11);
    LACUNA_CHECK(table->GetNumberOfRows() == (piece == 0 ? 1 : 0));
  }
}

void TestProvenance()
{
  vtkNew<vtkLacunaContrastToSpeckle> contrast;
  contrast->SetInputData(MakeImage());
  contrast->SetInsideArray("Left");
  contrast->SetOutsideBounds(104, 200, 0, 5.5, 0, 0);
  contrast->Update();
  const auto steps = lacuna::Provenance::Get(contrast->GetOutput());
  LACUNA_CHECK(steps.size() == 1);
  LACUNA_CHECK_CONTAINS(steps.at(0),
    "InsideArray=Left InsideBounds=1,-1,1,-1,1,-1 OutsideArray=\"\" "
    "OutsideBounds=104,200,0,5.5,0,0 IsoValue=128");
}

void TestAbort()
{
  vtkNew<vtkLacunaContrastToSpeckle> contrast;
  contrast->SetInputData(MakeImage());
  contrast->SetInsideArray("Left");
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
    { static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1); });
  const unsigned long tag = contrast->AddObserver(vtkCommand::ProgressEvent, stop);
  contrast->Update();
  LACUNA_CHECK(contrast->GetOutput()->GetNumberOfRows() == 0);
  contrast->RemoveObserver(tag);
  contrast->SetAbortExecute(0);
  contrast->Modified();
  contrast->Update();
  LACUNA_CHECK(contrast->GetOutput()->GetNumberOfRows() == 1);
}

void TestErrors()
{
  const auto image = MakeImage();
  vtkNew<vtkIntArray> short5;
  short5->SetName("Short");
  short5->SetNumberOfTuples(5);
  vtkNew<vtkIntArray> triple;
  triple->SetName("Triple");
  triple->SetNumberOfComponents(3);
  triple->SetNumberOfTuples(60);
  image->GetPointData()->AddArray(triple);
  vtkNew<vtkFloatArray> nothing;
  nothing->SetName("Nothing");
  nothing->SetNumberOfTuples(60);
  nothing->Fill(std::nan(""));
  image->GetPointData()->AddArray(nothing);
  const auto fails =
    [&](const char* part, const std::function<void(vtkLacunaContrastToSpeckle*)>& set)
  {
    vtkNew<vtkLacunaContrastToSpeckle> contrast;
    vtkNew<lacunaCheck::Messages> messages;
    messages->Watch(contrast);
    messages->Watch(contrast->GetExecutive());
    contrast->SetInputData(image);
    set(contrast);
    contrast->Update();
    LACUNA_CHECK_CONTAINS(messages->Errors, part);
    LACUNA_CHECK(contrast->GetOutput()->GetNumberOfRows() == 0);
  };
  fails("give InsideArray or InsideBounds", [](auto*) {});
  fails("no point array 'Elsewhere'", [](auto* c) { c->SetInsideArray("Elsewhere"); });
  fails("no sample is inside", [](auto* c) { c->SetInsideBounds(0, 1, 0, 1, 0, 1); });
  fails("no sample is outside", [](auto* c) { c->SetInsideBounds(0, 1000, 0, 10, 0, 0); });
  fails("no sample is inside", [](auto* c) { c->SetInsideArray("Nothing"); });
  image->GetPointData()->AddArray(short5);
  fails("its point array Short has 5 values for 60 points",
    [](auto* c) { c->SetInsideArray("Short"); });
  image->GetPointData()->RemoveArray("Short");
  fails("array 'Triple' has 3 components", [](auto* c) { c->SetInsideArray("Triple"); });
  const auto inside = [](auto* c) { c->SetInsideArray("Left"); };
  fails("array 'Triple' has 3 components",
    [&](auto* c)
    {
      inside(c);
      c->SetScalarArray("Triple");
    });
  fails("no point array 'Elsewhere'",
    [&](auto* c)
    {
      inside(c);
      c->SetScalarArray("Elsewhere");
    });
  fails("IsoValue is nan grey level; it must be a finite number",
    [&](auto* c)
    {
      inside(c);
      c->SetIsoValue(std::nan(""));
    });

  // A damaged mask of valid points must not be read beyond its end.
  short5->SetName("vtkValidPointMask");
  image->GetPointData()->AddArray(short5);
  fails("array vtkValidPointMask has 5 values", inside);
  image->GetPointData()->RemoveArray("vtkValidPointMask");

  // An image of which a part is missing.
  vtkNew<vtkTrivialProducer> producer;
  const int whole[6] = { 0, 19, 0, 5, 0, 0 };
  producer->SetOutput(image);
  producer->SetWholeExtent(const_cast<int*>(whole));
  fails("only the part 0 9 0 5 0 0 of the image in input 0 arrived, 0 19 0 5 0 0 is needed",
    [&](auto* c)
    {
      inside(c);
      c->SetInputConnection(producer->GetOutputPort());
    });
}

void TestPrint()
{
  vtkNew<vtkLacunaContrastToSpeckle> contrast;
  std::ostringstream text;
  contrast->Print(text);
  for (const char* name : { "ScalarArray:", "InsideArray:", "OutsideArray:", "InsideBounds: 1,-1",
         "OutsideBounds:", "IsoValue: 128" })
  {
    LACUNA_CHECK(text.str().find(name) != std::string::npos);
  }
}
}

int TestContrastToSpeckle(int, char*[])
{
  TestMasksAndBoxes();
  TestPieces();
  TestProvenance();
  TestAbort();
  TestErrors();
  TestPrint();
  return lacunaCheck::Result();
}
