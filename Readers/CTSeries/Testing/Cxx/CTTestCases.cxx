// SPDX-License-Identifier: BSD-3-Clause
#include "CTTestCases.h"

#include "lacunaMatrix4.h"

#include <algorithm>

namespace
{
constexpr double Pi = 3.14159265358979323846;

// A scan turned about the patient's origin, as a whole.
CTTestSeries Turn(CTTestSeries series, const lacuna::Matrix4& rotation)
{
  series.Row = rotation.Vector(series.Row);
  series.Column = rotation.Vector(series.Column);
  series.First = rotation.Point(series.First);
  series.Step = rotation.Vector(series.Step);
  return series;
}

CTTestSeries Compressed(const std::string& syntax)
{
  CTTestSeries series;
  series.TransferSyntax = syntax;
  return series;
}
}

//------------------------------------------------------------------------------
std::map<std::string, CTTestSeries> MakeExactCases()
{
  std::map<std::string, CTTestSeries> cases;
  const CTTestSeries axial;
  cases["axial"] = axial;

  CTTestSeries& prone = cases["prone"];
  prone.Row = { -1, 0, 0 };
  prone.Column = { 0, -1, 0 };
  prone.First = { 19, 23, -16 };
  prone.PatientPosition = "HFP";

  // seen from the head: the normal points to the feet
  CTTestSeries& feetFirst = cases["feet first"];
  feetFirst.Row = { -1, 0, 0 };
  feetFirst.First = { 19, -24, -16 };
  feetFirst.PatientPosition = "FFS";

  CTTestSeries& descending = cases["descending"];
  descending.First = { -20, -24, 16 };
  descending.Step = { 0, 0, -2 };

  CTTestSeries& coronal = cases["coronal"];
  coronal.Column = { 0, 0, -1 };
  coronal.First = { -20, -25, 20 };
  coronal.Step = { 0, 2.5, 0 };

  CTTestSeries& sagittal = cases["sagittal"];
  sagittal.Row = { 0, 1, 0 };
  sagittal.Column = { 0, 0, -1 };
  sagittal.First = { -18, -24, 21 };
  sagittal.Step = { 2.2, 0, 0 };

  cases["oblique"] = Turn(axial, lacuna::Matrix4::Rotation({ 1, -2, 0.5 }, 0.7));

  CTTestSeries& twelveBits = cases["12 bits"];
  twelveBits.BitsStored = 12;
  twelveBits.Signed = false;
  twelveBits.Intercept = -1024;

  CTTestSeries& signedTwelve = cases["signed 13 bits"];
  signedTwelve.BitsStored = 13;
  signedTwelve.Slope = 1;
  signedTwelve.Intercept = 24;

  CTTestSeries& wide = cases["16 bits unsigned"];
  wide.Signed = false;
  wide.Intercept = -32000;

  CTTestSeries& fractions = cases["fractions"];
  fractions.Slope = 0.25;
  fractions.Intercept = 0.5;

  CTTestSeries& inverse = cases["MONOCHROME1"];
  inverse.Photometric = "MONOCHROME1";

  CTTestSeries& multiFrame = cases["multi-frame"];
  multiFrame.MultiFrame = true;

  cases["implicit"] = Compressed("1.2.840.10008.1.2");
  cases["deflated"] = Compressed("1.2.840.10008.1.2.1.99");
  cases["big endian"] = Compressed("1.2.840.10008.1.2.2");
  cases["JPEG lossless"] = Compressed("1.2.840.10008.1.2.4.70");
  cases["JPEG-LS"] = Compressed("1.2.840.10008.1.2.4.80");
  cases["JPEG 2000"] = Compressed("1.2.840.10008.1.2.4.90");
  cases["RLE"] = Compressed("1.2.840.10008.1.2.5");

  CTTestSeries& compressedFrames = cases["multi-frame JPEG 2000"];
  compressedFrames = Compressed("1.2.840.10008.1.2.4.90");
  compressedFrames.MultiFrame = true;
  CTTestSeries& deflatedFrames = cases["multi-frame deflated"];
  deflatedFrames = Compressed("1.2.840.10008.1.2.1.99");
  deflatedFrames.MultiFrame = true;
  CTTestSeries& runFrames = cases["multi-frame RLE"];
  runFrames = Compressed("1.2.840.10008.1.2.5");
  runFrames.MultiFrame = true;
  CTTestSeries& umlauts = cases["Sch\xC3\xA4"
                                "del ger\xC3\xA4t 1"];
  umlauts.Description = "Sch\xE4"
                        "del"; // ISO_IR 100
  return cases;
}

//------------------------------------------------------------------------------
std::map<std::string, CTTestSeries> MakeTiltedCases()
{
  std::map<std::string, CTTestSeries> cases;
  CTTestSeries tilted;
  const lacuna::Matrix4 tilt = lacuna::Matrix4::Rotation({ 1, 0, 0 }, 20 * Pi / 180);
  tilted.Row = tilt.Vector(tilted.Row);
  tilted.Column = tilt.Vector(tilted.Column);
  cases["tilted"] = tilted;

  CTTestSeries back = tilted;
  const lacuna::Matrix4 other = lacuna::Matrix4::Rotation({ 1, 0, 0 }, -12 * Pi / 180);
  back.Column = other.Vector({ 0, 1, 0 });
  cases["tilted back"] = back;

  CTTestSeries both;
  const lacuna::Matrix4 swivel =
    lacuna::Matrix4::Rotation({ 0, 1, 0 }, 0.2) * lacuna::Matrix4::Rotation({ 1, 0, 0 }, 0.3);
  both.Row = swivel.Vector({ 1, 0, 0 });
  both.Column = swivel.Vector({ 0, 1, 0 });
  cases["tilted both ways"] = both;
  cases["tilted and turned"] = Turn(tilted, lacuna::Matrix4::Rotation({ 0.3, 1, 2 }, 1.1));
  return cases;
}

//------------------------------------------------------------------------------
std::map<std::string, CTTestSeries> MakeBodyCases()
{
  std::map<std::string, CTTestSeries> cases;
  CTTestSeries axial;
  axial.First = { -27, -38, -28 };
  axial.Step = { 0, 0, 1.4 };
  axial.RowSpacing = 1.1;
  axial.Columns = 58;
  axial.Rows = 52;
  axial.Slices = 40;
  axial.Truth = [](const lacuna::Vec3& point)
  { return std::clamp(300 - 100 * DistanceToLetter(point), -700.0, 1300.0); };
  cases["body axial"] = axial;

  CTTestSeries feetFirst = axial;
  feetFirst.Row = { -1, 0, 0 };
  feetFirst.First = { 25, -38, -28 };
  feetFirst.PatientPosition = "FFS";
  feetFirst.TransferSyntax = "1.2.840.10008.1.2.4.70";
  cases["body feet first"] = feetFirst;

  CTTestSeries oblique = Turn(axial, lacuna::Matrix4::Rotation({ 1, -2, 0.5 }, 0.4));
  oblique.MultiFrame = true;
  cases["body oblique"] = oblique;

  CTTestSeries tilted = axial;
  const lacuna::Matrix4 tilt = lacuna::Matrix4::Rotation({ 1, 0, 0 }, 15 * Pi / 180);
  tilted.Column = tilt.Vector(tilted.Column);
  cases["body tilted"] = tilted;
  return cases;
}
