// SPDX-License-Identifier: BSD-3-Clause
#include "TestMillingMould.h"
#include "lacunaCheck.h"
#include "lacunaCoordinates.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkLacunaGCodeWriter.h"
#include "vtkPointData.h"

#include <vtksys/SystemTools.hxx>

#include <functional>
#include <string>

using namespace millingMould;

namespace
{
//------------------------------------------------------------------------------
// The mark of mirrored data goes through the path, and stops at the file.
void TestMirrored(const std::string& file)
{
  const auto mould = Mould();
  lacuna::Coordinates::MarkMirrored(mould, { 1, 2, 3 }, { 1, 0, 0 });
  vtkNew<vtkLacunaMillingToolPath> filter;
  filter->SetInputData(mould);
  filter->SetOverrun(4);
  auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_CONTAINS(messages->Warnings, "mirror image");
  LACUNA_CHECK(lacuna::Coordinates::IsMirrored(filter->GetOutput()));
  LACUNA_CHECK(lacuna::Coordinates::IsMirrored(filter->GetOutputDataObject(1)));
  vtkNew<vtkLacunaGCodeWriter> writer;
  writer->SetInputConnection(filter->GetOutputPort());
  writer->SetFileName(file.c_str());
  vtksys::SystemTools::RemoveFile(file);
  auto refused = lacunaCheck::Watch(writer);
  LACUNA_CHECK(writer->Write() == 0 && !vtksys::SystemTools::FileExists(file));
  LACUNA_CHECK_CONTAINS(refused->Errors, "mirror image");
  writer->AllowMirroredOn();
  auto allowed = lacunaCheck::Watch(writer);
  LACUNA_CHECK(writer->Write() == 1);
  LACUNA_CHECK_CONTAINS(allowed->Warnings, "mirror image");
  LACUNA_CHECK_CONTAINS(Read(file), "(MIRROR IMAGE, LEFT IS RIGHT)");
}

//------------------------------------------------------------------------------
// What ParaView's Transform does to a path is seen by the writer.
void TestMoved(const std::string& file)
{
  vtkNew<vtkLacunaMillingToolPath> filter;
  filter->SetInputData(Mould());
  filter->SetRoughingStep(2);
  filter->SetOverrun(4);
  filter->Update();
  const auto write =
    [&](const lacuna::Matrix4& move, bool single, const std::string& words, bool written)
  {
    vtkNew<vtkPolyData> path;
    path->DeepCopy(filter->GetOutput());
    vtkNew<vtkPoints> points;
    points->SetDataType(single ? VTK_FLOAT : VTK_DOUBLE);
    for (vtkIdType k = 0; k < path->GetNumberOfPoints(); ++k)
    {
      lacuna::Vec3 p;
      path->GetPoint(k, p.data());
      points->InsertNextPoint(move.Point(p).data());
    }
    path->SetPoints(points);
    vtkNew<vtkLacunaGCodeWriter> writer;
    writer->SetInputData(path);
    writer->SetFileName(file.c_str());
    vtksys::SystemTools::RemoveFile(file);
    const bool warns = written && !words.empty();
    if (warns) // not unasked
    {
      const auto asked = lacunaCheck::Watch(writer);
      LACUNA_CHECK(writer->Write() == 0 && !vtksys::SystemTools::FileExists(file));
      LACUNA_CHECK_CONTAINS(asked->Errors, words);
    }
    writer->SetAcceptWarnings(warns);
    const auto messages = lacunaCheck::Watch(writer);
    LACUNA_CHECK(writer->Write() == (written ? 1 : 0));
    LACUNA_CHECK(vtksys::SystemTools::FileExists(file) == written);
    LACUNA_CHECK_CONTAINS((written ? messages->Warnings : messages->Errors), words);
    LACUNA_CHECK((written ? messages->Errors : messages->Warnings).empty());
    if (written)
    {
      const bool moved = Read(file).find("THE PATH WAS MOVED SINCE") != std::string::npos;
      LACUNA_CHECK(moved != (Read(file).find("PRESS COORDINATES, TOOL TIP") != std::string::npos));
      LACUNA_CHECK_THAT(moved == !words.empty(), "the file says so, too");
    }
    return messages->Warnings.empty();
  };
  using lacuna::Matrix4;
  LACUNA_CHECK(write({}, false, "", true));
  LACUNA_CHECK(write({}, true, "", true));
  write(Matrix4::Scaling({ -1, 1, 1 }), false, "it is mirrored", false);
  // about the middle of the part, where its bounds stay
  write(Matrix4::Translation({ 0, 20, 0 }) * Matrix4::Scaling({ 1, -1, 1 }), true, "it is mirrored",
    false);
  write(Matrix4::Scaling({ 1 / 25.4, 1 / 25.4, 1 / 25.4 }), false, "distances in it", false);
  write(Matrix4::Scaling({ 1, 1, 1.01 }), true, "distances in it", false);
  write(Matrix4::Rotation({ 1, 0, 0 }, 0.001), false, "it is tilted by 0.057 degrees", false);
  write(
    Matrix4::Translation({ 5, 0, 0 }), true, "it lies up to 5 mm elsewhere. The program's", true);
  write(Matrix4::Translation({ 3, 0, 4 }), false, "up to 5 mm elsewhere. All of it is 4 mm higher",
    true);
  write(Matrix4::Translation({ 0, 0, -0.01 }), true, "it lies 0.01 mm lower", false);
  write(Matrix4::Translation({ 20, 0, -20 }), false, "it lies 20 mm lower", false);
  write(Matrix4::Rotation({ 0, 0, 1 }, 0.001), false, "PressToPatient does not lead", true);

  // one position deeper than the filter made it
  vtkNew<vtkPolyData> path;
  path->DeepCopy(filter->GetOutput());
  double p[3];
  path->GetPoint(500, p);
  path->GetPoints()->SetPoint(500, p[0], p[1], p[2] - 0.01);
  vtkNew<vtkLacunaGCodeWriter> writer;
  writer->SetInputData(path);
  writer->SetFileName(file.c_str());
  const auto messages = lacunaCheck::Watch(writer);
  LACUNA_CHECK(writer->Write() == 0);
  LACUNA_CHECK_CONTAINS(messages->Errors, "distances in it are other ones by up to 0.01 mm");
}

//------------------------------------------------------------------------------
// What it does to a mould is seen by the filter.
void TestMovedMould(const std::string& file)
{
  using lacuna::Matrix4;
  const auto mill = [&file](const std::function<double(double, double)>& height,
                      const Matrix4& move, double weight, const std::string& error,
                      const std::string& warning)
  {
    const auto mould = Mould(height);
    vtkNew<vtkImageData> patient;
    lacuna::Coordinates::Mark(patient, lacuna::Coordinates::Patient);
    lacuna::Coordinates::MarkPress(patient, mould);
    vtkNew<vtkDoubleArray> made;
    made->SetName("PressPosition");
    made->SetNumberOfComponents(4);
    vtkNew<vtkPoints> points; // single precision
    for (vtkIdType k = 0; k < mould->GetNumberOfPoints(); ++k)
    {
      lacuna::Vec3 p;
      mould->GetPoint(k, p.data());
      // some are filled in by filters
      k % 7 == 1 ? made->InsertNextTuple4(0, 0, 0, 0)
                 : made->InsertNextTuple4(p[0], p[1], p[2], weight);
      points->InsertNextPoint(move.Point(p).data());
    }
    mould->SetPoints(points);
    mould->GetPointData()->AddArray(made);
    vtkNew<vtkLacunaMillingToolPath> filter;
    filter->SetInputData(mould);
    filter->SetRoughingStep(2);
    const auto messages = lacunaCheck::Watch(filter);
    filter->Update();
    LACUNA_CHECK_CONTAINS(messages->Errors, error);
    LACUNA_CHECK(messages->Errors.empty() == error.empty());
    LACUNA_CHECK_CONTAINS(messages->Warnings, warning);
    LACUNA_CHECK((messages->Warnings.find("since it was made") == std::string::npos) ==
      (warning.empty() || !error.empty()));
    LACUNA_CHECK((filter->GetOutput()->GetNumberOfPoints() == 0) == !error.empty());
    if (!error.empty())
    {
      return;
    }
    // where it leads is not passed on, but told
    const bool moved = !warning.empty();
    for (vtkDataObject* output : { filter->GetOutputDataObject(0), filter->GetOutputDataObject(1) })
    {
      LACUNA_CHECK(output->GetFieldData()->HasArray("PressToPatient") == !moved);
      LACUNA_CHECK(lacuna::Coordinates::Get(output) == lacuna::Coordinates::Press);
      LACUNA_CHECK(lacuna::Coordinates::GetBeforePress(output) == (moved ? "" : "Patient"));
      LACUNA_CHECK((Field(output, "MovedSincePress") > 0.4) == moved);
    }
    vtkNew<vtkLacunaGCodeWriter> writer;
    writer->SetInputData(filter->GetOutput());
    writer->SetFileName(file.c_str());
    writer->AcceptWarningsOn();
    LACUNA_CHECK(writer->Write() == 1);
    LACUNA_CHECK(
      (Read(file).find("MM, PRESS COORDINATES, TOOL TIP") == std::string::npos) == moved);
    LACUNA_CHECK((Read(file).find("THE MOULD WAS MOVED") != std::string::npos) == moved);
  };
  const auto flat = [](double, double) { return -1.0; };
  mill(Height, {}, 1, "", "");
  mill(flat, {}, 1, "", "");
  mill(Height, Matrix4::Scaling({ -1, 1, 1 }), 1, "it is mirrored", "");
  mill(Height, Matrix4::Scaling({ -1, 1, 1 }), 0, "", ""); // no telling
  mill(
    Height, Matrix4::Scaling({ 1, 1.01, 1 }), 1, "distances in it are other ones by up to 0.", "");
  mill(flat, Matrix4::Scaling({ 1.01, 1, 1 }), 1, "distances in it", "");
  mill(Height, Matrix4::Translation({ 3, 4, 0 }), 1, "", "lies up to 5 mm elsewhere, and Press");
  mill(flat, Matrix4::Translation({ 0, 0, -0.5 }), 1, "", "lies up to 0.5 mm elsewhere");
  mill(Height, Matrix4::Rotation({ 1, 0, 0 }, 0.1), 1, "", "tilted by 5.73 degrees");
}
}

int TestMillingToolPathMoved(int argc, char* argv[])
{
  const std::string folder = Folder(argc, argv);
  TestMirrored(folder + "/TestMillingToolPathMirrored.nc");
  TestMoved(folder + "/TestMillingToolPathMoved.nc");
  TestMovedMould(folder + "/TestMillingToolPathMovedMould.nc");
  return lacunaCheck::Result();
}
