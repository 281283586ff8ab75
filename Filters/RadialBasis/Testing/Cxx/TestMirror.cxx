// SPDX-License-Identifier: BSD-3-Clause
// Mirror as a pipeline sees it: arrays, marks, pieces, errors.
#include "RBFTestMaps.h"
#include "lacunaCheck.h"
#include "lacunaCoordinates.h"
#include "lacunaFieldData.h"
#include "lacunaProvenance.h"
#include "vtkCallbackCommand.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageAlgorithm.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaMirror.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkShortArray.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cmath>
#include <limits>

namespace
{
// Two balls of different size and a lump aside: symmetric in one plane only, which contains the
// centres c0 and c1; oblique, and the extent starts anywhere.
struct Scene
{
  vtkNew<vtkImageData> Image;
  lacuna::Vec3 Middle{ 0, 0, 0 };
  lacuna::Vec3 Normal{ 0, 0, 0 };

  Scene()
  {
    this->Image->SetExtent(-3, 46, 4, 59, 10, 55);
    this->Image->SetSpacing(1.2, 1.1, 1.4);
    this->Image->SetOrigin(40, -90, 12);
    const lacuna::Vec3 x = lacuna::Normalized({ 0.9, 0.3, -0.2 });
    const lacuna::Vec3 y = lacuna::Normalized(lacuna::Cross({ 0, 0.2, 1 }, x));
    const lacuna::Vec3 z = lacuna::Cross(x, y);
    vtkNew<vtkMatrix3x3> direction;
    for (int a = 0; a < 3; ++a)
    {
      direction->SetElement(a, 0, x[a]);
      direction->SetElement(a, 1, y[a]);
      direction->SetElement(a, 2, z[a]);
    }
    this->Image->SetDirectionMatrix(direction);
    this->Image->GetCenter(this->Middle.data());
    this->Normal = lacuna::Normalized({ 0.8, 0.5, 0.3 });
    const lacuna::Vec3 u = lacuna::Normalized(lacuna::Cross(this->Normal, { 0, 0, 1 }));
    const lacuna::Vec3 v = lacuna::Cross(this->Normal, u);
    vtkNew<vtkShortArray> scalars;
    scalars->SetName("CT");
    for (vtkIdType i = 0; i < this->Image->GetNumberOfPoints(); ++i)
    {
      lacuna::Vec3 p{ 0, 0, 0 };
      this->Image->GetPoint(i, p.data());
      const lacuna::Vec3 q = p - this->Middle;
      const double a = std::abs(Dot(q, this->Normal));
      const double b = Dot(q, u);
      const double c = Dot(q, v);
      const auto ball = [&](double ca, double cb, double cc, double r)
      { return 1 / (1 + std::exp(2 * (std::hypot(a - ca, b - cb, c - cc) - r))); };
      scalars->InsertNextValue(static_cast<short>(std::lround(
        -1000 + 1000 * ball(0, -4, 2, 15) + 600 * ball(13, 6, -3, 7) + 400 * ball(0, 5, 9, 6))));
    }
    this->Image->GetPointData()->SetScalars(scalars);
  }
};

double Field(vtkDataObject* data, const char* name, int component = 0)
{
  vtkDataArray* array = data->GetFieldData()->GetArray(name);
  return array ? array->GetComponent(0, component) : vtkMath::Nan();
}

void TestVolume()
{
  Scene scene;
  vtkNew<vtkLacunaMirror> mirror;
  mirror->SetInputData(scene.Image);
  const auto messages = lacunaCheck::Watch(mirror);
  mirror->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  LACUNA_CHECK_THAT(messages->Warnings.empty(), messages->Warnings);
  vtkImageData* output = mirror->GetOutput();
  vtkPointData* points = output->GetPointData();
  LACUNA_CHECK(points->GetNumberOfArrays() == 3); // nothing that is not mirrored beside it
  vtkDataArray* mirrored = points->GetScalars();
  LACUNA_CHECK(mirrored && std::string(mirrored->GetName()) == "MirroredCT");
  LACUNA_CHECK(mirrored && mirrored->GetDataType() == VTK_SHORT);
  LACUNA_CHECK(points->GetArray("vtkValidPointMask") && points->GetArray("Asymmetry"));
  LACUNA_CHECK(lacuna::Coordinates::IsMirrored(output));
  LACUNA_CHECK(!lacuna::Coordinates::IsMirrored(scene.Image));
  LACUNA_CHECK(lacuna::Provenance::Get(output).size() == 1);
  lacuna::Vec3 normal{ 0, 0, 0 };
  lacuna::Vec3 origin{ 0, 0, 0 };
  for (int a = 0; a < 3; ++a)
  {
    normal[a] = Field(output, lacuna::Coordinates::MirrorNormalName, a);
    origin[a] = Field(output, lacuna::Coordinates::MirrorOriginName, a);
  }
  LACUNA_CHECK_NEAR(Norm(Cross(normal, scene.Normal)) * 180 / vtkMath::Pi(), 0, 0.05);
  LACUNA_CHECK(Dot(normal, scene.Normal) > 0); // the largest component is positive
  LACUNA_CHECK_NEAR(Norm(origin - scene.Middle), 0, 0.02);
  LACUNA_CHECK(Field(output, "SymmetryScore") > 0.9999);
  LACUNA_CHECK(Field(output, "SymmetryOverlap") > 0.6);
  LACUNA_CHECK(Field(output, "SymmetryAmbiguity") < 0.2);
  LACUNA_CHECK(Field(output, "AsymmetryRMS") < 5);
  vtkPolyData* square = vtkPolyData::SafeDownCast(mirror->GetOutputDataObject(1));
  LACUNA_CHECK(square && square->GetNumberOfPolys() == 1);
  LACUNA_CHECK(Field(square, "SymmetryScore") > 0.9999);
  for (vtkIdType i = 0; i < square->GetNumberOfPoints(); ++i)
  {
    lacuna::Vec3 p{ 0, 0, 0 };
    square->GetPoint(i, p.data());
    LACUNA_CHECK_NEAR(Dot(p - origin, normal), 0, 1e-9);
  }

  // given, the plane is taken as it is; a piece is a part of the whole
  mirror->SetPlaneMethod(vtkLacunaMirror::Given);
  mirror->SetOrigin(scene.Middle.data());
  const lacuna::Vec3 longer = -3 * scene.Normal;
  mirror->SetNormal(longer[0], longer[1], longer[2]);
  mirror->Update();
  LACUNA_CHECK_NEAR(
    Field(output, lacuna::Coordinates::MirrorNormalName, 1), scene.Normal[1], 1e-15);
  LACUNA_CHECK(!output->GetFieldData()->GetArray("SymmetryAmbiguity"));
  vtkNew<vtkImageData> whole;
  whole->DeepCopy(output);
  const int piece[6] = { 5, 20, 10, 30, 12, 13 };
  mirror->Modified();
  mirror->UpdateExtent(piece);
  LACUNA_CHECK(output->GetNumberOfPoints() == 16 * 21 * 2);
  for (int j = 10; j <= 30; ++j)
  {
    LACUNA_CHECK(output->GetScalarComponentAsDouble(7, j, 13, 0) ==
      whole->GetScalarComponentAsDouble(7, j, 13, 0));
  }
}

void TestDepthMap()
{
  TestMap map; // an inclined plane: in which it is symmetric is not known, so one is given
  vtkNew<vtkLacunaMirror> mirror;
  mirror->SetInputData(map.Image);
  mirror->SetPlaneMethod(vtkLacunaMirror::Given);
  const lacuna::Vec3 origin = map.GetSurfacePoint(50, 40);
  mirror->SetOrigin(origin.data());
  mirror->SetNormal(map.Right.data());
  auto messages = lacunaCheck::Watch(mirror);
  mirror->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  LACUNA_CHECK(messages->HasWarning("the symmetry is poor"));
  vtkImageData* output = mirror->GetOutput();
  const lacuna::DepthMap contract(output); // throws unless it is a depth map
  vtkDataArray* depth = contract.GetDepth();
  vtkDataArray* asymmetry = output->GetPointData()->GetArray("Asymmetry");
  LACUNA_CHECK(output->GetPointData()->GetArray("Normals"));
  LACUNA_CHECK(lacuna::Coordinates::IsMirrored(output));
  int seen = 0;
  for (vtkIdType i = 0; i < depth->GetNumberOfTuples(); ++i)
  {
    const lacuna::Vec2 p = map.GetPosition(i);
    const double x = 100 - p[0]; // where the mirror image comes from
    const bool inside = x > 10.001 && x < 88.999;
    if (inside)
    {
      ++seen;
      LACUNA_CHECK_NEAR(depth->GetComponent(i, 0), map.Depth(x, p[1]), 1e-9);
      LACUNA_CHECK_NEAR(
        asymmetry->GetComponent(i, 0), map.Depth(p[0], p[1]) - map.Depth(x, p[1]), 1e-9);
    }
    LACUNA_CHECK(output->GetPointData()->GetArray("vtkValidPointMask")->GetComponent(i, 0) ==
      !std::isnan(depth->GetComponent(i, 0)));
  }
  LACUNA_CHECK(seen > 3000);

  // whole millimetres become parts of them, which is announced
  vtkNew<vtkImageData> whole;
  whole->ShallowCopy(map.Image);
  vtkNew<vtkShortArray> millimetres;
  vtkDataArray* given = map.Image->GetPointData()->GetArray(lacuna::DepthMap::DepthName);
  millimetres->SetName(given->GetName());
  for (vtkIdType i = 0; i < given->GetNumberOfTuples(); ++i)
  {
    const double value = given->GetComponent(i, 0);
    millimetres->InsertNextValue(std::isnan(value) ? 0 : static_cast<short>(std::lround(value)));
  }
  whole->GetPointData()->SetScalars(millimetres);
  mirror->SetInputData(whole);
  mirror->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  LACUNA_CHECK(vtkImageData::GetScalarType(mirror->GetOutputInformation(0)) == VTK_DOUBLE);
  LACUNA_CHECK(output->GetPointData()->GetScalars()->GetDataType() == VTK_DOUBLE);
  mirror->SetInputData(map.Image);

  // from the side the other side is not seen
  const lacuna::Vec3 far = origin + 200 * map.Right;
  mirror->SetOrigin(far.data());
  mirror->Update();
  LACUNA_CHECK(messages->HasError("does not show both sides"));
  LACUNA_CHECK(output->GetNumberOfPoints() == 0);
}

// A reader of images: tells of its scalars by name and type before they are there.
class Announcing : public vtkImageAlgorithm
{
public:
  static Announcing* New();
  vtkTypeMacro(Announcing, vtkImageAlgorithm);

  vtkSmartPointer<vtkImageData> Image;
  const char* Name = nullptr;

protected:
  Announcing() { this->SetNumberOfInputPorts(0); }

  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkInformation* info = outputs->GetInformationObject(0);
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), this->Image->GetExtent(), 6);
    info->Set(vtkDataObject::ORIGIN(), this->Image->GetOrigin(), 3);
    info->Set(vtkDataObject::SPACING(), this->Image->GetSpacing(), 3);
    info->Set(vtkDataObject::DIRECTION(), this->Image->GetDirectionMatrix()->GetData(), 9);
    vtkDataObject::SetActiveAttributeInfo(info, vtkDataObject::FIELD_ASSOCIATION_POINTS,
      vtkDataSetAttributes::SCALARS, this->Name, this->Image->GetScalarType(), 1, -1);
    return 1;
  }

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkImageData::GetData(outputs)->ShallowCopy(this->Image);
    return 1;
  }
};
vtkStandardNewMacro(Announcing);

// What has not been read yet is known by its name: depths become double, a volume keeps its type.
void TestAnnounced()
{
  const auto announce = [](vtkImageData* image, const char* name, int type)
  {
    vtkNew<Announcing> reader;
    reader->Image = image;
    reader->Name = name;
    vtkNew<vtkLacunaMirror> mirror;
    mirror->SetInputConnection(reader->GetOutputPort());
    mirror->SetPlaneMethod(vtkLacunaMirror::Given);
    mirror->SetOrigin(image->GetCenter());
    auto messages = lacunaCheck::Watch(mirror);
    mirror->UpdateInformation();
    LACUNA_CHECK(reader->GetOutput()->GetNumberOfPoints() == 0);
    LACUNA_CHECK(vtkImageData::GetScalarType(mirror->GetOutputInformation(0)) == type);
    mirror->Update();
    LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
    LACUNA_CHECK(mirror->GetOutput()->GetScalarType() == type);
  };
  TestMap map;
  vtkNew<vtkImageData> depths;
  depths->DeepCopy(map.Image);
  vtkNew<vtkFloatArray> single;
  single->DeepCopy(map.Image->GetPointData()->GetArray(lacuna::DepthMap::DepthName));
  depths->GetPointData()->SetScalars(single);
  announce(depths, lacuna::DepthMap::DepthName, VTK_DOUBLE);
  announce(Scene().Image, "CT", VTK_SHORT);
}

void TestErrors()
{
  Scene scene;
  const auto fails = [&](vtkLacunaMirror* mirror, const char* text)
  {
    const auto messages = lacunaCheck::Watch(mirror);
    mirror->Update();
    LACUNA_CHECK_CONTAINS(messages->Errors, text);
    LACUNA_CHECK(mirror->GetOutput()->GetNumberOfPoints() == 0);
  };
  vtkNew<vtkLacunaMirror> mirror;
  mirror->SetInputData(scene.Image);
  mirror->SetPlaneMethod(7);
  fails(mirror, "PlaneMethod is 7; it must be 0 (BestSymmetry) or 1 (Given)");
  mirror->SetPlaneMethod(vtkLacunaMirror::Given);
  mirror->SetInterpolation(-1);
  fails(mirror, "Interpolation is -1; it must be 0 (BSpline), 1 (Linear) or 2 (Nearest)");
  mirror->SetInterpolation(vtkLacunaMirror::Linear);
  mirror->SetNormal(0, 0, 0);
  fails(mirror, "Normal must not be 0 0 0");
  mirror->SetNormal(1, 0, std::numeric_limits<double>::quiet_NaN());
  fails(mirror, "Normal is nan; it must be a finite number");
  mirror->SetNormal(1e160, 0, 0); // its length is beyond all numbers
  fails(mirror, "nor too long");
  mirror->SetNormal(1, 0, 0);
  mirror->SetOrigin(1e6, 0, 0);
  fails(mirror, "does not pass through the data");

  // twice mirrored would look like the patient
  mirror->SetOrigin(scene.Middle.data());
  vtkNew<vtkLacunaMirror> again;
  again->SetInputConnection(mirror->GetOutputPort());
  fails(again, "mirror image already");

  vtkNew<vtkImageData> constant;
  constant->SetDimensions(20, 20, 20);
  constant->AllocateScalars(VTK_FLOAT, 1);
  constant->GetPointData()->GetScalars()->Fill(3);
  vtkNew<vtkLacunaMirror> other;
  other->SetInputData(constant);
  fails(other, "the same value");
  constant->AllocateScalars(VTK_FLOAT, 3);
  fails(other, "one component");
  vtkNew<vtkImageData> empty;
  other->SetInputData(empty);
  const auto messages = lacunaCheck::Watch(other);
  other->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  LACUNA_CHECK(other->GetOutput()->GetNumberOfPoints() == 0);

  TestMap map;
  lacuna::FieldData::Set(map.Image, lacuna::DepthMap::EyePositionName, { 0, 0, 0 }, 3);
  lacuna::FieldData::Set(map.Image, lacuna::DepthMap::ViewAngleName, { 30 }, 1);
  other->SetInputData(map.Image);
  fails(other, "perspective");
}

void TestAbort()
{
  Scene scene;
  vtkNew<vtkLacunaMirror> mirror;
  mirror->SetInputData(scene.Image);
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
    { vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1); });
  mirror->AddObserver(vtkCommand::ProgressEvent, stop);
  mirror->Update();
  LACUNA_CHECK(mirror->GetOutput()->GetNumberOfPoints() == 0);
}
}

int TestMirror(int, char*[])
{
  TestVolume();
  TestDepthMap();
  TestAnnounced();
  TestErrors();
  TestAbort();
  vtkNew<vtkLacunaMirror> mirror;
  mirror->Print(std::cout);
  return lacunaCheck::Result();
}
