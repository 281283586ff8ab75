// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Curves of IGES files for tests, evaluated by the recursive definition of B-splines, which shares
/// nothing with the writer.
#ifndef lacunaIGESCurves_h
#define lacunaIGESCurves_h

#include "lacunaIGESParser.h"

#include <array>

/// All B-splines of a degree at x.
inline std::vector<double> IGESBasis(const std::vector<double>& knots, std::size_t degree, double x)
{
  const std::size_t intervals = knots.size() - 1;
  std::vector<double> b(intervals, 0.0);
  std::size_t span = degree;
  while (span + degree + 2 < knots.size() && knots[span + 1] <= x)
  {
    ++span;
  }
  b[span] = 1;
  for (std::size_t q = 1; q <= degree; ++q)
  {
    for (std::size_t i = 0; i + q < intervals; ++i)
    {
      const double left = knots[i + q] - knots[i];
      const double right = knots[i + q + 1] - knots[i + 1];
      b[i] = (left > 0 ? (x - knots[i]) / left * b[i] : 0) +
        (right > 0 ? (knots[i + q + 1] - x) / right * b[i + 1] : 0);
    }
  }
  b.resize(intervals - degree);
  return b;
}

inline std::array<double, 3> IGESPoint(const IGESSurface& surface, double u, double v)
{
  const std::vector<double> bu = IGESBasis(surface.Knots[0], 3, u);
  const std::vector<double> bv = IGESBasis(surface.Knots[1], 3, v);
  std::array<double, 3> p{};
  for (std::size_t j = 0; j < bv.size(); ++j)
  {
    for (std::size_t i = 0; i < bu.size() && bv[j] != 0; ++i)
    {
      for (std::size_t c = 0; c < 3; ++c)
      {
        p[c] += bv[j] * bu[i] * surface.Points[3 * (i + bu.size() * j) + c];
      }
    }
  }
  return p;
}

/// The contents of a 126, checked for consistency.
struct IGESCurve
{
  std::size_t Degree = 0;
  bool Planar = false;
  bool Closed = false;
  std::vector<double> Knots;
  std::vector<double> Points; // x, y, z
  double Limits[2];
  double Normal[3];
  std::vector<long> Properties;

  explicit IGESCurve(const IGESParser::Entity& entity)
  {
    IGESParser::Require(entity.Type == 126 && entity.Form == 0, "a 126");
    std::size_t next = 0;
    const auto integer = [&] { return IGESParser::Integer(entity.Parameters.at(next++)); };
    const auto real = [&] { return IGESParser::Real(entity.Parameters.at(next++)); };
    const auto size = static_cast<std::size_t>(integer()) + 1;
    this->Degree = static_cast<std::size_t>(integer());
    this->Planar = integer() == 1;
    this->Closed = integer() == 1;
    IGESParser::Require(integer() == 1, "polynomial");
    IGESParser::Require(integer() == 0, "not periodic");
    for (std::size_t k = 0; k < size + this->Degree + 1; ++k)
    {
      this->Knots.push_back(real());
      IGESParser::Require(k == 0 || this->Knots[k] >= this->Knots[k - 1], "knots grow");
    }
    IGESParser::Require(
      this->Knots[this->Degree] == this->Knots.front() && this->Knots[size] == this->Knots.back(),
      "clamped knots");
    for (std::size_t k = this->Degree; k < size; ++k)
    {
      IGESParser::Require(this->Knots[k] < this->Knots[k + 1], "simple interior knots");
    }
    for (std::size_t k = 0; k < size; ++k)
    {
      IGESParser::Require(real() == 1, "weights are 1");
    }
    for (std::size_t k = 0; k < 3 * size; ++k)
    {
      this->Points.push_back(real());
    }
    for (double& limit : this->Limits)
    {
      limit = real();
    }
    IGESParser::Require(
      this->Limits[0] == this->Knots.front() && this->Limits[1] == this->Knots.back(), "limits");
    for (double& n : this->Normal)
    {
      n = real();
    }
    if (next < entity.Parameters.size())
    {
      IGESParser::Require(integer() == 0, "no associativities");
      for (long count = integer(); count > 0; --count)
      {
        this->Properties.push_back(integer());
      }
    }
    IGESParser::Require(next == entity.Parameters.size(), "nothing left over");
    bool closed = true;
    for (std::size_t c = 0; c < 3; ++c)
    {
      closed = closed && this->Points[c] == this->Points[3 * size - 3 + c];
    }
    IGESParser::Require(closed == this->Closed, "says whether it is closed");
  }

  std::array<double, 3> At(double t) const
  {
    const std::vector<double> b = IGESBasis(this->Knots, this->Degree, t);
    std::array<double, 3> p{};
    for (std::size_t k = 0; k < b.size(); ++k)
    {
      for (std::size_t c = 0; c < 3; ++c)
      {
        p[c] += b[k] * this->Points[3 * k + c];
      }
    }
    return p;
  }
};

/// A 102 of lines, checked for consistency: each begins where the one before ends.
struct IGESPolygon
{
  std::vector<std::array<double, 3>> Corners;
  std::vector<long> Properties;

  IGESPolygon(const IGESParser& file, const IGESParser::Entity& entity)
  {
    IGESParser::Require(entity.Type == 102 && entity.Form == 0, "a 102");
    const auto sides = static_cast<std::size_t>(IGESParser::Integer(entity.Parameters.at(0)));
    for (std::size_t k = 1; k <= sides; ++k)
    {
      const IGESParser::Entity& side =
        file.Entities.at(IGESParser::Integer(entity.Parameters.at(k)));
      IGESParser::Require(side.Type == 110 && side.Status == "00010000", "a side");
      std::array<double, 3> ends[2];
      for (std::size_t c = 0; c < 6; ++c)
      {
        ends[c / 3][c % 3] = IGESParser::Real(side.Parameters.at(c));
      }
      IGESParser::Require(this->Corners.empty() || this->Corners.back() == ends[0], "a chain");
      if (this->Corners.empty())
      {
        this->Corners.push_back(ends[0]);
      }
      this->Corners.push_back(ends[1]);
    }
    for (std::size_t next = sides + 3; next < entity.Parameters.size(); ++next)
    {
      this->Properties.push_back(IGESParser::Integer(entity.Parameters[next]));
    }
  }
};

/// A 144 with all that belongs to it, checked for consistency: statuses, pointers.
struct IGESTrimmedSurface
{
  struct Boundary
  {
    IGESCurve Parameters;
    IGESCurve Space;
  };
  IGESSurface Surface;
  std::vector<Boundary> Boundaries; // the outer one, holes
  std::vector<long> Properties;

  IGESTrimmedSurface(const IGESParser& file, const IGESParser::Entity& entity)
    : Surface(Part(file, entity.Parameters.at(0), 128, "00010000"))
  {
    IGESParser::Require(entity.Type == 144 && entity.Form == 0, "a 144");
    IGESParser::Require(entity.Status == "00000000", "an independent entity");
    IGESParser::Require(IGESParser::Integer(entity.Parameters.at(1)) == 1, "own outer boundary");
    const auto holes = static_cast<std::size_t>(IGESParser::Integer(entity.Parameters.at(2)));
    for (std::size_t k = 0; k <= holes; ++k)
    {
      const IGESParser::Entity& curve = Part(file, entity.Parameters.at(3 + k), 142, "00010000");
      IGESParser::Require(curve.Parameters.size() == 5, "parameters of a 142");
      IGESParser::Require(curve.Parameters[1] == entity.Parameters[0], "of the same surface");
      const Boundary boundary{ IGESCurve(Part(file, curve.Parameters[2], 126, "00010500")),
        IGESCurve(Part(file, curve.Parameters[3], 126, "00010000")) };
      IGESParser::Require(boundary.Parameters.Closed && boundary.Space.Closed, "closed boundary");
      IGESParser::Require(boundary.Parameters.Planar && boundary.Parameters.Normal[2] == 1,
        "parameter curves are planar");
      IGESParser::Require(boundary.Parameters.Limits[0] == boundary.Space.Limits[0] &&
          boundary.Parameters.Limits[1] == boundary.Space.Limits[1],
        "the same interval");
      this->Boundaries.push_back(boundary);
    }
    std::size_t next = 4 + holes;
    if (next < entity.Parameters.size())
    {
      IGESParser::Require(IGESParser::Integer(entity.Parameters[next++]) == 0, "associativities");
      for (++next; next < entity.Parameters.size(); ++next)
      {
        this->Properties.push_back(IGESParser::Integer(entity.Parameters[next]));
      }
    }
  }

private:
  static const IGESParser::Entity& Part(
    const IGESParser& file, const std::string& pointer, long type, const char* status)
  {
    const IGESParser::Entity& entity = file.Entities.at(IGESParser::Integer(pointer));
    IGESParser::Require(entity.Type == type, "a pointer to a " + std::to_string(type));
    IGESParser::Require(entity.Status == status, std::string("status ") + status + " of a part");
    return entity;
  }
};
#endif
