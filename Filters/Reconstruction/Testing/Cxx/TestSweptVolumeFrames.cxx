// SPDX-License-Identifier: BSD-3-Clause
/// vtkLacunaSweptVolume in the reference frame and along the sweep: the same object at the same
/// place, not mirrored.
#include "lacunaProvenance.h"
#include "lacunaTestStacks.h"
#include "vtkFloatArray.h"
#include "vtkImageAlgorithm.h"
#include "vtkInformation.h"
#include "vtkMatrix3x3.h"

#include <cmath>

using lacuna::Matrix4;
using lacuna::Vec3;
using namespace lacunaTestStacks;

namespace
{
const Matrix4 Probe =
  Matrix4::Translation({ -40, 90, 25 }) * Matrix4::Rotation({ 1, -2, 0.5 }, 0.9);

// 60 x 50 pixels of 0.4 mm that sample a field; 0.5 mm apart, askew to the reference frame.
vtkSmartPointer<vtkImageData> Scan(double (*field)(const Vec3&), double fan = 0)
{
  const int size[3] = { 60, 50, 50 };
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetDimensions(size);
  stack->AllocateScalars(VTK_FLOAT, 1);
  auto* pixel = static_cast<float*>(stack->GetScalarPointer());
  std::vector<Matrix4> poses;
  std::vector<double> times;
  std::vector<int> frames;
  for (int k = 0; k < size[2]; ++k)
  {
    const Matrix4 pose = Probe * Matrix4::Translation({ 0, 0, 0.5 * k }) *
      Matrix4::Rotation({ 1, 0, 0 }, fan * (k - 25)) * Matrix4::Scaling({ 0.4, 0.4, 1 });
    poses.push_back(pose);
    times.push_back(k);
    frames.push_back(k);
    for (int j = 0; j < size[1]; ++j)
    {
      for (int i = 0; i < size[0]; ++i)
      {
        *pixel++ = static_cast<float>(field(pose.Point({ double(i), double(j), 0 })));
      }
    }
  }
  lacuna::TrackedSlices::Write(stack, poses, times, std::vector<unsigned char>(size[2], 0), frames);
  return stack;
}

// Differs along all axes: every mirror and every mixed-up axis changes it.
double Ramp(const Vec3& x)
{
  return 3 * x[0] - 5 * x[1] + 7 * x[2] + 1000;
}

// Three balls of radii 5, 4 and 3 mm that no mirror maps on themselves.
double Balls(const Vec3& x)
{
  const Vec3 centres[3] = { { 7, 8, 10 }, { 17, 8, 10 }, { 8, 15, 19 } };
  double inside = 0;
  for (int n = 0; n < 3; ++n)
  {
    const double distance = Norm(x - Probe.Point(centres[n])) - (5 - n);
    inside += std::min(1.0, std::max(0.0, 0.5 - distance)); // a border 1 mm wide
  }
  return 100 * inside;
}

Vec3 GetPoint(vtkImageData* volume, int i, int j, int k)
{
  Vec3 point;
  volume->TransformIndexToPhysicalPoint(i, j, k, point.data());
  return point;
}

template <class Visit>
void ForEachVoxel(vtkImageData* volume, const Visit& visit)
{
  const int* extent = volume->GetExtent();
  for (int k = extent[4]; k <= extent[5]; ++k)
  {
    for (int j = extent[2]; j <= extent[3]; ++j)
    {
      for (int i = extent[0]; i <= extent[1]; ++i)
      {
        if (GetValue(volume, "vtkValidPointMask", i, j, k) == 1)
        {
          visit(GetPoint(volume, i, j, k), GetValue(volume, "Intensity", i, j, k));
        }
      }
    }
  }
}

vtkSmartPointer<vtkImageData> Reconstruct(
  vtkImageData* stack, int frame, const Configure& configure = {})
{
  vtkNew<vtkLacunaSweptVolume> filter;
  filter->SetInputData(stack);
  filter->SetOutputFrame(frame);
  filter->SetOutputSpacing(0.4, 0.4, 0.5);
  if (configure)
  {
    configure(filter);
  }
  filter->Update();
  return filter->GetOutput();
}

void TestPlaces()
{
  for (const double fan : { 0.0, 0.01 })
  {
    const auto stack = Scan(Ramp, fan);
    vtkIdType sizes[2];
    for (const int frame : { vtkLacunaSweptVolume::Reference, vtkLacunaSweptVolume::Principal })
    {
      const auto volume = Reconstruct(stack, frame);
      sizes[frame] = volume->GetNumberOfPoints();
      double largest = 0;
      vtkIdType filled = 0;
      ForEachVoxel(volume,
        [&](const Vec3& point, double grey)
        {
          largest = std::max(largest, std::abs(grey - Ramp(point)));
          ++filled;
        });
      const std::string name =
        "frame " + std::to_string(frame) + ", fan " + std::to_string(fan) + ": ";
      LACUNA_CHECK_THAT(
        largest < (fan == 0 ? 1e-3 : 0.05), name + "error " + std::to_string(largest));
      LACUNA_CHECK_THAT(filled > volume->GetNumberOfPoints() / 8, name + "filled");
      const double determinant = volume->GetDirectionMatrix()->Determinant();
      LACUNA_CHECK_THAT(std::abs(determinant - 1) < 1e-12, name + "right-handed");
      LACUNA_CHECK_THAT(
        volume->GetDirectionMatrix()->IsIdentity() == (frame == vtkLacunaSweptVolume::Reference),
        name + "direction");
    }
    LACUNA_CHECK_THAT(2 * sizes[1] < sizes[0], "a tighter box");
  }
}

void TestDirection()
{
  // along the slices: columns, rows, normals
  const auto volume = Reconstruct(Scan(Ramp), vtkLacunaSweptVolume::Principal);
  for (int a = 0; a < 3; ++a)
  {
    for (int row = 0; row < 3; ++row)
    {
      LACUNA_CHECK_NEAR(
        volume->GetDirectionMatrix()->GetElement(row, a), Probe.Column(a)[row], 1e-12);
    }
  }
  const int* size = volume->GetDimensions();
  LACUNA_CHECK_THAT(size[0] == 60 && size[1] == 50 && size[2] == 50, "one voxel per pixel");
  LACUNA_CHECK_THAT(
    Norm(GetPoint(volume, 0, 0, 0) - Probe.Point({ 0, 0, 0 })) < 1e-9, "begins at the first pixel");
  LACUNA_CHECK_CONTAINS(lacuna::Provenance::Get(volume).back(), "OutputFrame=Principal");
}

void TestVolumes()
{
  const auto stack = Scan(Balls);
  double volumes[2];
  Vec3 centres[2];
  for (const int frame : { vtkLacunaSweptVolume::Reference, vtkLacunaSweptVolume::Principal })
  {
    const auto volume = Reconstruct(stack, frame);
    double sum = 0;
    Vec3 moment{ 0, 0, 0 };
    ForEachVoxel(volume,
      [&](const Vec3& point, double grey)
      {
        sum += 0.01 * grey;
        moment = moment + 0.01 * grey * point;
      });
    volumes[frame] = sum * 0.4 * 0.4 * 0.5;
    centres[frame] = (1 / sum) * moment;
  }
  // a border that falls from r - w/2 to r + w/2 makes 4/3 pi (r^3 + r w^2/4) of a ball
  const double truth = 4.0 / 3 * 3.14159265358979 * (125 + 64 + 27 + 12 / 4.0);
  LACUNA_CHECK_NEAR(volumes[0], truth, 0.002 * truth);
  LACUNA_CHECK_NEAR(volumes[1], volumes[0], 0.002 * truth);
  LACUNA_CHECK_THAT(Norm(centres[0] - centres[1]) < 0.01, "centre of mass");
}

void TestBoundsAndPieces()
{
  const auto stack = Scan(Ramp, 0.01);
  const auto whole = Reconstruct(stack, vtkLacunaSweptVolume::Principal);
  // bounds along the frame's axes, from the reference frame's origin
  const Vec3 corner = GetPoint(whole, 10, 12, 9);
  Vec3 low;
  for (int a = 0; a < 3; ++a)
  {
    low[a] = 0;
    for (int row = 0; row < 3; ++row)
    {
      low[a] += whole->GetDirectionMatrix()->GetElement(row, a) * corner[row];
    }
  }
  const auto part = Reconstruct(stack, vtkLacunaSweptVolume::Principal,
    [&](vtkLacunaSweptVolume* filter)
    { filter->SetOutputBounds(low[0], low[0] + 4, low[1], low[1] + 6, low[2], low[2] + 5); });
  const int* size = part->GetDimensions();
  LACUNA_CHECK_THAT(size[0] == 11 && size[1] == 16 && size[2] == 11, "size of the bounds");
  LACUNA_CHECK_THAT(Norm(GetPoint(part, 0, 0, 0) - corner) < 1e-9, "place of the bounds");
  LACUNA_CHECK_NEAR(
    GetValue(part, "Intensity", 3, 4, 5), GetValue(whole, "Intensity", 13, 16, 14), 1e-3);

  for (int piece = 0; piece < 3; ++piece)
  {
    vtkNew<vtkLacunaSweptVolume> filter;
    filter->SetInputData(stack);
    filter->SetOutputFrameToPrincipal();
    filter->SetOutputSpacing(0.4, 0.4, 0.5);
    filter->UpdatePiece(piece, 3, 0);
    vtkImageData* output = filter->GetOutput();
    const int* e = output->GetExtent();
    bool same = output->GetNumberOfPoints() < whole->GetNumberOfPoints();
    for (int k = e[4]; k <= e[5]; ++k)
    {
      for (int j = e[2]; j <= e[3]; ++j)
      {
        for (int i = e[0]; i <= e[1]; ++i)
        {
          same = same &&
            GetValue(output, "Intensity", i, j, k) == GetValue(whole, "Intensity", i, j, k) &&
            GetPoint(output, i, j, k) == GetPoint(whole, i, j, k);
        }
      }
    }
    LACUNA_CHECK_THAT(same, "piece " + std::to_string(piece));
  }
}

void TestInformation()
{
  vtkNew<vtkLacunaSweptVolume> filter;
  filter->SetInputData(Scan(Ramp));
  filter->SetOutputFrameToPrincipal();
  filter->UpdateInformation();
  const double* direction = filter->GetOutputInformation(0)->Get(vtkDataObject::DIRECTION());
  LACUNA_CHECK_THAT(direction != nullptr, "direction is announced");
  LACUNA_CHECK_NEAR(direction[1], Probe(0, 1), 1e-12);
  filter->Update();
  filter->SetOutputFrameToReference();
  filter->Update();
  LACUNA_CHECK_THAT(filter->GetOutput()->GetDirectionMatrix()->IsIdentity(), "and forgotten");
}
}

int TestSweptVolumeFrames(int, char*[])
{
  TestPlaces();
  TestDirection();
  TestVolumes();
  TestBoundsAndPieces();
  TestInformation();
  return lacunaCheck::Result();
}
