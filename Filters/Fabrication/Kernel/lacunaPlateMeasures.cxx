// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPlateMeasures.h"

#include "lacunaExecution.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
// The triangles of a sheet by their feet.
class SheetIndex
{
public:
  SheetIndex(const PlateSheet& sheet, const std::vector<Vec3>& points)
    : Sheet(sheet)
    , Points(points)
  {
    this->Low = this->High = sheet.Feet[0];
    for (const Vec2& p : sheet.Feet)
    {
      for (int i = 0; i < 2; ++i)
      {
        this->Low[i] = std::min(this->Low[i], p[i]);
        this->High[i] = std::max(this->High[i], p[i]);
      }
    }
    // about two triangles in a cell
    const double area = (this->High[0] - this->Low[0]) * (this->High[1] - this->Low[1]);
    this->Cell = std::sqrt(2 * area / static_cast<double>(sheet.Triangles.size()));
    this->Columns = this->GetColumn(0, this->High[0]) + 1;
    this->Rows = this->GetColumn(1, this->High[1]) + 1;
    this->First.assign(static_cast<std::size_t>(this->Columns * this->Rows + 1), 0);
    for (const Triangle& t : sheet.Triangles)
    {
      this->Visit(t, [&](std::int64_t c) { ++this->First[c + 1]; });
    }
    for (std::size_t c = 1; c < this->First.size(); ++c)
    {
      this->First[c] += this->First[c - 1];
    }
    this->Items.resize(static_cast<std::size_t>(this->First.back()));
    std::vector<std::int64_t> fill(this->First.begin(), this->First.end() - 1);
    for (std::size_t k = 0; k < sheet.Triangles.size(); ++k)
    {
      this->Visit(sheet.Triangles[k],
        [&](std::int64_t c) { this->Items[fill[c]++] = static_cast<std::int32_t>(k); });
    }
  }

  // From p, whose foot is given, to the nearest triangle about the foot.
  double GetDistance(const Vec2& foot, const Vec3& p) const
  {
    double best = std::numeric_limits<double>::infinity();
    const std::int64_t column = this->GetColumn(0, foot[0]);
    const std::int64_t row = this->GetColumn(1, foot[1]);
    for (std::int64_t j = std::max<std::int64_t>(row - 1, 0); j <= row + 1 && j < this->Rows; ++j)
    {
      for (std::int64_t i = std::max<std::int64_t>(column - 1, 0);
           i <= column + 1 && i < this->Columns; ++i)
      {
        const std::int64_t c = i + this->Columns * j;
        for (std::int64_t k = this->First[c]; k < this->First[c + 1]; ++k)
        {
          const Triangle& t = this->Sheet.Triangles[this->Items[k]];
          best = std::min(
            best, SquaredDistanceToTriangle(p, this->Get(t[0]), this->Get(t[1]), this->Get(t[2])));
        }
      }
    }
    return std::sqrt(best);
  }

private:
  const Vec3& Get(std::int32_t i) const { return this->Points[this->Sheet.Points[i]]; }

  std::int64_t GetColumn(int axis, double x) const
  {
    const double within = std::clamp(x, this->Low[axis], this->High[axis]) - this->Low[axis];
    return static_cast<std::int64_t>(within / this->Cell);
  }

  template <class Body>
  void Visit(const Triangle& t, const Body& body) const
  {
    std::int64_t range[4];
    for (int i = 0; i < 2; ++i)
    {
      const double x[3] = { this->Sheet.Feet[t[0]][i], this->Sheet.Feet[t[1]][i],
        this->Sheet.Feet[t[2]][i] };
      range[2 * i] = this->GetColumn(i, *std::min_element(x, x + 3));
      range[2 * i + 1] = this->GetColumn(i, *std::max_element(x, x + 3));
    }
    for (std::int64_t j = range[2]; j <= range[3]; ++j)
    {
      for (std::int64_t i = range[0]; i <= range[1]; ++i)
      {
        body(i + this->Columns * j);
      }
    }
  }

  const PlateSheet& Sheet;
  const std::vector<Vec3>& Points;
  Vec2 Low;
  Vec2 High;
  double Cell = 1;
  std::int64_t Columns = 1;
  std::int64_t Rows = 1;
  std::vector<std::int64_t> First;
  std::vector<std::int32_t> Items;
};

double GetLeastDistance(Execution& execution, const PlateSheet& from, const PlateSheet& to,
  const std::vector<Vec3>& points)
{
  const SheetIndex index(to, points);
  const auto count = static_cast<std::int64_t>(from.Feet.size() - from.BorderSize);
  std::vector<double> distances(static_cast<std::size_t>(count));
  execution.For(count, 256,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t k = begin; k < end; ++k)
      {
        const std::size_t i = from.BorderSize + static_cast<std::size_t>(k);
        distances[k] = index.GetDistance(from.Feet[i], points[from.Points[i]]);
      }
    });
  return distances.empty() ? std::numeric_limits<double>::infinity()
                           : *std::min_element(distances.begin(), distances.end());
}
}

//------------------------------------------------------------------------------
double SquaredDistanceToTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c)
{
  const auto toSegment = [&p](const Vec3& from, const Vec3& to)
  {
    const Vec3 along = to - from;
    const double length = Dot(along, along);
    const double t = length > 0 ? std::clamp(Dot(p - from, along) / length, 0.0, 1.0) : 0;
    const Vec3 miss = p - from - t * along;
    return Dot(miss, miss);
  };
  const Vec3 normal = Cross(b - a, c - a);
  const double area = Dot(normal, normal);
  if (area > 0 && Dot(Cross(b - a, p - a), normal) >= 0 && Dot(Cross(c - b, p - b), normal) >= 0 &&
    Dot(Cross(a - c, p - c), normal) >= 0)
  {
    const double height = Dot(p - a, normal);
    return height * height / area;
  }
  return std::min({ toSegment(a, b), toSegment(b, c), toSegment(c, a) });
}

//------------------------------------------------------------------------------
void MeasurePlate(
  Execution& execution, const PlateSheet& outer, const PlateSheet& inner, ImplantPlate& plate)
{
  const Vec3 middle = plate.Points.front();
  double six = 0;
  double twice = 0;
  for (std::size_t k = 0; k < plate.Triangles.size(); ++k)
  {
    const Triangle& t = plate.Triangles[k];
    const Vec3 a = plate.Points[t[0]] - middle;
    const Vec3 b = plate.Points[t[1]] - middle;
    const Vec3 c = plate.Points[t[2]] - middle;
    six += Dot(a, Cross(b, c));
    if (plate.Faces[k] == PlateFace::Outer)
    {
      twice += Norm(Cross(b - a, c - a));
    }
  }
  plate.Volume = six / 6;
  plate.OuterArea = twice / 2;
  plate.MinimumThickness = std::min(GetLeastDistance(execution, outer, inner, plate.Points),
    GetLeastDistance(execution, inner, outer, plate.Points));
}
}
