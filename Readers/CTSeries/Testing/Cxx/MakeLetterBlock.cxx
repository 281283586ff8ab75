// SPDX-License-Identifier: BSD-3-Clause
// Writes scans of a block with a letter F sunk into five of its faces, for scripts: MakeLetterBlock
// FOLDER. Away from edges the Hounsfield units are 40 times the depth below the nearest face, mm, so
// that the faces are where HU = 0 to a fraction of a micrometre, however the scan lies.
#include "CTTestSeries.h"

#include "lacunaMatrix4.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <map>

namespace
{
using lacuna::Vec3;

// The block's axes, x, y, z to patient; letter_block.py has the same.
const lacuna::Matrix4 Axes = lacuna::Matrix4::Rotation({ 0.3, -1, 0.5 }, 0.35);
constexpr double Half = 28;
constexpr double PitDepth = 6;

// How far inside the letter, mm; a lies along its bars, b up its stem.
double InLetter(double a, double b)
{
  const auto bar = [&](double a0, double a1, double b0, double b1)
  { return std::min(std::min(a - a0, a1 - a), std::min(b - b0, b1 - b)); };
  return std::max({ bar(-8, -3.5, -10, 10), bar(-8, 8, 5.5, 10), bar(-8, 4, -2.5, 2) });
}

double Truth(const Vec3& point)
{
  const double q[3] = { lacuna::Dot(Axes.Column(0), point), lacuna::Dot(Axes.Column(1), point),
    lacuna::Dot(Axes.Column(2), point) };
  double inside = 1e9;
  for (int axis = 0; axis < 3; ++axis)
  {
    inside = std::min(inside, Half - std::abs(q[axis]));
  }
  for (int face = 0; face < 5; ++face)
  {
    const int axis = face / 2;
    const double sign = face % 2 ? -1 : 1;
    // as seen from outside, a to the right and b up, for the one sign
    const double a = sign * q[(axis + 1) % 3];
    const double b = q[(axis + 2) % 3];
    inside = std::min(inside, -std::min(InLetter(a, b), sign * q[axis] - Half + PitDepth));
  }
  return std::clamp(40 * inside, -640.0, 640.0);
}
}

int main(int argc, char* argv[])
{
  if (argc != 2)
  {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  std::map<std::string, CTTestSeries> cases;
  CTTestSeries axial;
  axial.First = { -46, -45.5, -45 };
  axial.Step = { 0, 0, 1.1 };
  axial.RowSpacing = 1;
  axial.ColumnSpacing = 0.9;
  axial.Columns = 103;
  axial.Rows = 92;
  axial.Slices = 83;
  axial.Slope = 0.02;
  axial.Truth = Truth;
  cases["axial"] = axial;
  CTTestSeries& feetFirst = cases["feet first"] = axial;
  feetFirst.Row = { -1, 0, 0 };
  feetFirst.First = { 45.8, -45.5, -45 };
  feetFirst.PatientPosition = "FFS";
  CTTestSeries& sagittal = cases["sagittal"] = axial;
  sagittal.Row = { 0, 1, 0 };
  sagittal.Column = { 0, 0, -1 };
  sagittal.First = { -45, -46, 45.5 };
  sagittal.Step = { 1.1, 0, 0 };
  CTTestSeries& oblique = cases["oblique"] = axial;
  const lacuna::Matrix4 turn = lacuna::Matrix4::Rotation({ 1, -2, 0.5 }, 0.2);
  oblique.Row = turn.Vector(oblique.Row);
  oblique.Column = turn.Vector(oblique.Column);
  oblique.First = turn.Vector(oblique.First);
  oblique.Step = turn.Vector(oblique.Step);
  // feet first, turned, and each image 0.25 mm further along its rows and -0.15 mm along its columns
  CTTestSeries& tilted = cases["tilted"] = axial;
  const lacuna::Matrix4 lie = lacuna::Matrix4::Rotation({ 2, 1, -3 }, 0.3);
  tilted.Row = lie.Vector({ -1, 0, 0 });
  tilted.Step = lie.Vector({ 0.15, 0.25, 1.1 });
  tilted.Columns = 117;
  tilted.Rows = 114;
  tilted.First = lie.Vector({ 46.1, -66.5, -45 });
  tilted.Column = lie.Vector(tilted.Column);
  tilted.PatientPosition = "FFS";
  try
  {
    for (const auto& [name, series] : cases)
    {
      series.Write(std::string(argv[1]) + "/" + name);
    }
  }
  catch (const std::exception& e)
  {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
  return 0;
}
