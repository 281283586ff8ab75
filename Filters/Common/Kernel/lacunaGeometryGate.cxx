// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGeometryGate.h"

#include <algorithm>
#include <array>
#include <limits>
#include <sstream>

namespace lacuna
{
namespace
{
// Numbers of two decimals are off by up to 0.005, the products of axes of them by 0.017.
constexpr double TwoDecimals = 0.0175;
constexpr double QuaternionOfTwoDecimals = 0.01;
constexpr double Kilometre = 1e6;      // mm
constexpr double SmallestPixel = 1e-3; // mm
constexpr double LargestPixel = 10;    // mm
constexpr double LongestPixel = 50;    // times its width
constexpr double LargestCosine = 0.1;
constexpr double ExactCosine = 0.0025;
constexpr double ExactLength = 0.001;
constexpr double RoundedPixel = 0.01; // pixels are mm already, within this part

double GetCosine(const Vec3& a, const Vec3& b)
{
  return Dot(Normalized(a), Normalized(b));
}

template <class... Parts>
std::string Join(const Parts&... parts)
{
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

std::string Join(const Vec3& v)
{
  return Join(v[0], ", ", v[1], " and ", v[2]);
}

Vec3 GetLengths(const Matrix4& m)
{
  return { Norm(m.Column(0)), Norm(m.Column(1)), Norm(m.Column(2)) };
}

// What neither a pose nor a calibration may have.
GeometryFinding CheckTransform(const Matrix4& m)
{
  if (!m.IsFinite())
  {
    return { GeometryFault::NotFinite, "has numbers that are not finite", "mend the matrix" };
  }
  if (!m.IsAffine())
  {
    const bool transposed = m(0, 3) == 0 && m(1, 3) == 0 && m(2, 3) == 0 && m(3, 3) == 1;
    return { GeometryFault::LastRow,
      Join("has the last row ", m(3, 0), " ", m(3, 1), " ", m(3, 2), " ", m(3, 3), ", not 0 0 0 1"),
      transposed ? "it is transposed: put the position into the last column" : "mend the matrix" };
  }
  const Vec3 lengths = GetLengths(m);
  if (!(std::abs(m.Determinant3()) > 1e-6 * lengths[0] * lengths[1] * lengths[2]))
  {
    return { GeometryFault::Singular, "is singular: its axes lie in a plane or have no length",
      "mend the matrix" };
  }
  if (!(Norm(m.Column(3)) <= Kilometre))
  {
    return { GeometryFault::FarAway,
      "is more than a kilometre away, at " + Join(m.Column(3)) + " mm",
      "check the position and its unit, which is mm" };
  }
  return {};
}

// Whether the third column confirms the first two, of lengths l.
bool FitsThirdColumn(const Vec3& l)
{
  const auto isSame = [](double a, double b) { return std::abs(a - b) <= ExactLength * b; };
  // 1 stands for nothing: then the sides confirm each other
  return isSame(l[2], (l[0] + l[1]) / 2) || isSame(l[2], std::sqrt(l[0] * l[1])) ||
    (isSame(l[2], 1) && isSame(l[0], l[1]));
}

double GetDegrees(double cosine)
{
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::acos(-1.0);
}
}

GeometryFinding CheckPose(const Matrix4& pose)
{
  if (GeometryFinding finding = CheckTransform(pose))
  {
    return finding;
  }
  double stretch = 0;
  double shear = 0;
  for (int a = 0; a < 3; ++a)
  {
    stretch = std::max(stretch, std::abs(Dot(pose.Column(a), pose.Column(a)) - 1));
    shear = std::max(shear, std::abs(Dot(pose.Column(a), pose.Column((a + 1) % 3))));
  }
  const double worst = std::max(stretch, shear);
  if (!(worst <= TwoDecimals))
  {
    return { GeometryFault::NotRigid,
      stretch > shear
        ? "is not rigid: its columns have the lengths " + Join(GetLengths(pose)) + ", not 1"
        : "is not rigid: its axes are not perpendicular",
      "check its digits; a pose is of the probe (ProbeToTracker), not of the image's pixels" };
  }
  if (pose.Determinant3() < 0)
  {
    return { GeometryFault::Mirrored, "mirrors: its axes are left-handed",
      "convert the poses to right-handed axes" };
  }
  if (worst > RigidTolerance)
  {
    return { GeometryFault::Rounded,
      Join("is not a rotation and a translation by ", worst,
        ", as of numbers with 2 or 3 decimals or a wrong digit"),
      "check its digits, and record 5 decimals or more" };
  }
  return {};
}

GeometryFinding CheckQuaternion(double length)
{
  if (!std::isfinite(length))
  {
    return { GeometryFault::NotFinite, "has numbers that are not finite", "mend the quaternion" };
  }
  if (std::abs(length - 1) <= RigidTolerance)
  {
    return {};
  }
  return { std::abs(length - 1) <= QuaternionOfTwoDecimals ? GeometryFault::Rounded
                                                           : GeometryFault::NotRigid,
    Join("has a quaternion of length ", length, ", not 1"),
    "check its digits, and record 4 decimals or more" };
}

GeometryFinding CheckImage(const Matrix4& m)
{
  GeometryFinding finding = CheckTransform(m);
  if (finding && finding.Fault != GeometryFault::Singular)
  {
    return finding;
  }
  const Vec3 x = m.Column(0);
  const Vec3 y = m.Column(1);
  const Vec3 z = m.Column(2);
  const Vec3 lengths = GetLengths(m);
  const double ratio = std::max(lengths[0], lengths[1]) / std::min(lengths[0], lengths[1]);
  const auto isSize = [](double length)
  { return length >= SmallestPixel && length <= LargestPixel; };
  if (!isSize(lengths[0]) || !isSize(lengths[1]) || !(ratio <= LongestPixel))
  {
    return { GeometryFault::PixelSize,
      Join("has pixels of ", lengths[0], " x ", lengths[1], " mm, which no ultrasound has"),
      "check the matrix and its unit, which is mm" };
  }
  const double cosine = GetCosine(x, y);
  if (std::abs(cosine) > LargestCosine)
  {
    return { GeometryFault::Skewed,
      Join("is skewed: rows and columns meet at ", GetDegrees(cosine), " degrees, not 90"),
      "check its digits" };
  }
  if (finding)
  {
    return finding;
  }
  if (m.Determinant3() < 0)
  {
    return { GeometryFault::MirroredImage, "mirrors: its axes are left-handed",
      "look whether the picture lies the right way round in its frame; if it does, change the sign "
      "of the third column, which places no pixel, to say so" };
  }
  if (std::abs(cosine) > ExactCosine)
  {
    return { GeometryFault::Inexact,
      Join("is skewed: rows and columns meet at ", GetDegrees(cosine),
        " degrees, not 90; 100 mm down, pixels are off by ", 100 * std::abs(cosine), " mm"),
      "check its digits; where it was fitted so, calibrate anew" };
  }
  const bool upright =
    std::abs(GetCosine(x, z)) <= ExactCosine && std::abs(GetCosine(y, z)) <= ExactCosine;
  if (!upright || !FitsThirdColumn(lengths))
  {
    return { GeometryFault::Inexact,
      Join("has pixels of ", lengths[0], " x ", lengths[1],
        " mm, which its third column does not confirm: it is ",
        upright ? Join(lengths[2], " long, not their mean ", (lengths[0] + lengths[1]) / 2)
                : "not perpendicular to rows and columns"),
      "compare the pixels with the depth scale in the picture and check the digits; where the "
      "matrix is right, make the third column perpendicular to the others and as long as the mean "
      "of their lengths" };
  }
  return {};
}

GeometryFinding CheckImageChain(const std::vector<Matrix4>& links, std::size_t& link)
{
  Matrix4 product;
  for (const Matrix4& matrix : links)
  {
    product = matrix * product;
  }
  link = links.size();
  if (GeometryFinding finding = CheckImage(product))
  {
    return finding;
  }
  product = Matrix4();
  bool inMillimetres = false;
  for (std::size_t i = 0; i < links.size(); ++i)
  {
    GeometryFinding finding = inMillimetres ? CheckPose(links[i]) : GeometryFinding();
    if (finding.Fault == GeometryFault::NotRigid || finding.Fault == GeometryFault::Rounded ||
      finding.Fault == GeometryFault::Mirrored)
    {
      link = i;
      return { finding.Fault == GeometryFault::Rounded ? finding.Fault : GeometryFault::Inexact,
        finding.Text + ", though the transforms before it have turned pixels into mm",
        "check its digits" };
    }
    product = links[i] * product;
    const Vec3 lengths = GetLengths(product);
    inMillimetres =
      std::abs(lengths[0] - 1) > RoundedPixel || std::abs(lengths[1] - 1) > RoundedPixel;
  }
  return {};
}

Matrix4 NoPose()
{
  std::array<double, 16> none{};
  none.fill(std::numeric_limits<double>::quiet_NaN());
  return Matrix4(none);
}

GeometryAction GetAction(GeometryOrigin origin, GeometryFault fault)
{
  constexpr GeometryAction u = GeometryAction::Use;
  constexpr GeometryAction w = GeometryAction::Warn;
  constexpr GeometryAction f = GeometryAction::Flag;
  constexpr GeometryAction r = GeometryAction::Refuse;
  // columns: origins; rows: faults
  constexpr std::array<std::array<GeometryAction, 7>, 12> actions{ {
    { u, u, u, u, u, u, u }, // None
    { f, r, r, f, f, r, r }, // NotFinite
    { f, r, r, r, f, r, r }, // LastRow
    { f, r, r, r, f, r, r }, // Singular
    { f, r, r, r, f, u, r }, // FarAway: among slices, outliers are found by their neighbours
    { f, r, r, r, f, u, r }, // NotRigid
    { f, r, r, r, f, u, r }, // Mirrored
    { w, w, w, w, f, u, r }, // Rounded
    { f, r, r, r, f, r, r }, // PixelSize
    { f, r, r, r, f, r, r }, // Skewed
    { w, w, r, r, f, u, r }, // MirroredImage
    { w, w, w, w, f, u, r }, // Inexact
  } };
  return actions[static_cast<std::size_t>(fault)][static_cast<std::size_t>(origin)];
}
}
