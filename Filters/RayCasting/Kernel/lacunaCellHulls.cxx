// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCellHulls.h"

#include "lacunaWide.h"

#include <cmath>
#include <limits>

namespace lacuna
{
namespace
{
// The Bezier points of four cells along an axis: the five where cells meet, then the four at a
// third of each cell, then the four at two thirds. Along x the first five lie in a vector of eight,
// the others in a second one. Loops over LineSize become vector code; elements 5 to 7 of a line are
// rubbish that nobody looks at.
constexpr int NumberOfPoints = 13;
constexpr int Thirds = 5;
constexpr int TwoThirds = 9;
constexpr int LineSize = 16;
constexpr int ThirdsInLine = 8;
constexpr int TwoThirdsInLine = 12;

struct Range
{
  alignas(32) float Low[LineSize];
  alignas(32) float High[LineSize];
};

/// Bezier points along one row from its control points; reads p[0..9].
LACUNA_INLINE void AlongRow(const float* p, float* line)
{
  constexpr float sixth = 1.0F / 6;
  constexpr float third = 1.0F / 3;
  for (int i = 0; i < 8; ++i)
  {
    line[i] = sixth * (p[i] + p[i + 2]) + 4 * sixth * p[i + 1];
  }
  for (int i = 0; i < 4; ++i)
  {
    line[ThirdsInLine + i] = third * (2 * p[i + 1] + p[i + 2]);
  }
  for (int i = 0; i < 4; ++i)
  {
    line[TwoThirdsInLine + i] = third * (p[i + 1] + 2 * p[i + 2]);
  }
}

/// The same across seven lines, to thirteen that lie stride floats apart.
LACUNA_INLINE void AcrossLines(const float (*in)[LineSize], float* out, int stride)
{
  constexpr float sixth = 1.0F / 6;
  constexpr float third = 1.0F / 3;
  for (int n = 0; n < 5; ++n)
  {
    for (int i = 0; i < LineSize; ++i)
    {
      out[n * stride + i] = sixth * (in[n][i] + in[n + 2][i]) + 4 * sixth * in[n + 1][i];
    }
  }
  for (int n = 0; n < 4; ++n)
  {
    for (int i = 0; i < LineSize; ++i)
    {
      const float p = in[n + 1][i];
      const float q = in[n + 2][i];
      out[(Thirds + n) * stride + i] = third * (2 * p + q);
      out[(TwoThirds + n) * stride + i] = third * (p + 2 * q);
    }
  }
}

LACUNA_INLINE float Lesser(float a, float b)
{
  return a < b ? a : b;
}

LACUNA_INLINE float Greater(float a, float b)
{
  return a > b ? a : b;
}

/// Of the lines that bound a cell.
LACUNA_INLINE void MergeLines(
  const float* a, const float* b, const float* c, const float* d, Range& result)
{
  for (int i = 0; i < LineSize; ++i)
  {
    result.Low[i] = Lesser(Lesser(a[i], b[i]), Lesser(c[i], d[i]));
    result.High[i] = Greater(Greater(a[i], b[i]), Greater(c[i], d[i]));
  }
}

LACUNA_INLINE void MergeRanges(
  const Range& a, const Range& b, const Range& c, const Range& d, Range& result)
{
  for (int i = 0; i < LineSize; ++i)
  {
    result.Low[i] = Lesser(Lesser(a.Low[i], b.Low[i]), Lesser(c.Low[i], d.Low[i]));
    result.High[i] = Greater(Greater(a.High[i], b.High[i]), Greater(c.High[i], d.High[i]));
  }
}

LACUNA_INLINE void Store(CellHulls& hulls, float low, float high, float tolerance, int bit)
{
  hulls.Outside |= static_cast<std::uint64_t>(high < -tolerance) << bit;
  hulls.Inside |= static_cast<std::uint64_t>(low > tolerance) << bit;
}

LACUNA_WIDE CellHulls ClassifyCubic(const float (*points)[7][8], float tolerance)
{
  alignas(32) float net[NumberOfPoints][7][LineSize]; // [y][z][x]
  for (int k = 0; k < 7; ++k)
  {
    alignas(32) float lines[7][LineSize];
    for (int j = 0; j < 7; ++j)
    {
      AlongRow(points[k][j], lines[j]);
    }
    AcrossLines(lines, net[0][k], 7 * LineSize);
  }
  Range columns[NumberOfPoints][4]; // [y][cell k]
  for (int n = 0; n < NumberOfPoints; ++n)
  {
    alignas(32) float column[NumberOfPoints][LineSize];
    AcrossLines(net[n], column[0], LineSize);
    for (int k = 0; k < 4; ++k)
    {
      MergeLines(
        column[k], column[k + 1], column[Thirds + k], column[TwoThirds + k], columns[n][k]);
    }
  }
  CellHulls hulls;
  for (int k = 0; k < 4; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      Range cell;
      MergeRanges(
        columns[j][k], columns[j + 1][k], columns[Thirds + j][k], columns[TwoThirds + j][k], cell);
      for (int i = 0; i < 4; ++i)
      {
        const float low = Lesser(Lesser(cell.Low[i], cell.Low[i + 1]),
          Lesser(cell.Low[ThirdsInLine + i], cell.Low[TwoThirdsInLine + i]));
        const float high = Greater(Greater(cell.High[i], cell.High[i + 1]),
          Greater(cell.High[ThirdsInLine + i], cell.High[TwoThirdsInLine + i]));
        Store(hulls, low, high, tolerance, CellHulls::BitOf(i, j, k));
      }
    }
  }
  return hulls;
}

CellHulls ClassifyLinear(const float (*points)[5][8], float tolerance)
{
  CellHulls hulls;
  for (int k = 0; k < 4; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      float low[5];
      float high[5];
      for (int i = 0; i < 5; ++i)
      {
        const float a = points[k][j][i];
        const float b = points[k][j + 1][i];
        const float c = points[k + 1][j][i];
        const float d = points[k + 1][j + 1][i];
        low[i] = Lesser(Lesser(a, b), Lesser(c, d));
        high[i] = Greater(Greater(a, b), Greater(c, d));
      }
      for (int i = 0; i < 4; ++i)
      {
        Store(hulls, Lesser(low[i], low[i + 1]), Greater(high[i], high[i + 1]), tolerance,
          CellHulls::BitOf(i, j, k));
      }
    }
  }
  return hulls;
}

/// Bezier points of a cell along one axis, for four lines that lie side by side.
LACUNA_INLINE void ToBezier(const float (*in)[4], int stride, float (*out)[4])
{
  constexpr float sixth = 1.0F / 6;
  constexpr float third = 1.0F / 3;
  for (int m = 0; m < 4; ++m)
  {
    const float p = in[0][m];
    const float q = in[stride][m];
    const float r = in[2 * stride][m];
    const float s = in[3 * stride][m];
    out[0][m] = sixth * (p + r) + 4 * sixth * q;
    out[stride][m] = third * (2 * q + r);
    out[2 * stride][m] = third * (q + 2 * r);
    out[3 * stride][m] = sixth * (q + s) + 4 * sixth * r;
  }
}

struct FloatPlanes
{
  float Slope[3];
  float Low;
  float High;
};

LACUNA_WIDE void PlanesOfCubic(
  const float (*points)[7][8], int i, int j, int k, FloatPlanes& result)
{
  alignas(32) float a[16][4]; // row = 4 z + y
  alignas(32) float b[16][4];
  for (int z = 0; z < 4; ++z)
  {
    for (int y = 0; y < 4; ++y)
    {
      const float* row = points[k + z][j + y] + i;
      for (int x = 0; x < 4; ++x)
      {
        a[4 * z + y][x] = row[x];
      }
    }
  }
  for (int y = 0; y < 4; ++y)
  {
    ToBezier(a + y, 4, b + y);
  }
  for (int z = 0; z < 4; ++z)
  {
    ToBezier(b + 4 * z, 1, a + 4 * z);
  }
  // rows along x become columns: then all lines along x lie side by side
  for (int row = 0; row < 16; row += 4)
  {
    for (int m = 0; m < 4; ++m)
    {
      for (int x = 0; x < 4; ++x)
      {
        b[4 * x + row / 4][m] = a[row + m][x];
      }
    }
  }
  for (int z = 0; z < 4; ++z)
  {
    ToBezier(b + z, 4, a + z);
  }
  // a[4 x + z][y]; the plane through the corners by least squares
  const float c000 = a[0][0];
  const float c010 = a[0][3];
  const float c001 = a[3][0];
  const float c011 = a[3][3];
  const float c100 = a[12][0];
  const float c110 = a[12][3];
  const float c101 = a[15][0];
  const float c111 = a[15][3];
  const float sx = 0.25F * ((c100 - c000) + (c110 - c010) + (c101 - c001) + (c111 - c011));
  const float sy = 0.25F * ((c010 - c000) + (c110 - c100) + (c011 - c001) + (c111 - c101));
  const float sz = 0.25F * ((c001 - c000) + (c101 - c100) + (c011 - c010) + (c111 - c110));
  constexpr float third = 1.0F / 3;
  alignas(16) const float alongY[4] = { 0, third * sy, 2 * third * sy, sy };
  alignas(16) float low[4];
  alignas(16) float high[4];
  for (int m = 0; m < 4; ++m)
  {
    low[m] = high[m] = a[0][m] - alongY[m];
  }
  for (int row = 1; row < 16; ++row)
  {
    const float rest =
      static_cast<float>(row / 4) * third * sx + static_cast<float>(row % 4) * third * sz;
    for (int m = 0; m < 4; ++m)
    {
      const float d = a[row][m] - alongY[m] - rest;
      low[m] = Lesser(low[m], d);
      high[m] = Greater(high[m], d);
    }
  }
  result = { { sx, sy, sz }, Lesser(Lesser(low[0], low[1]), Lesser(low[2], low[3])),
    Greater(Greater(high[0], high[1]), Greater(high[2], high[3])) };
}

void PlanesOfLinear(const float (*points)[5][8], int i, int j, int k, FloatPlanes& result)
{
  float c[2][2][2];
  float s[3] = { 0, 0, 0 };
  for (int n = 0; n < 8; ++n)
  {
    const int x = n & 1;
    const int y = n >> 1 & 1;
    const int z = n >> 2;
    const float v = c[z][y][x] = points[k + z][j + y][i + x];
    s[0] += x ? v : -v;
    s[1] += y ? v : -v;
    s[2] += z ? v : -v;
  }
  result.Low = std::numeric_limits<float>::infinity();
  result.High = -result.Low;
  for (int a = 0; a < 3; ++a)
  {
    result.Slope[a] = 0.25F * s[a];
  }
  for (int n = 0; n < 8; ++n)
  {
    const int x = n & 1;
    const int y = n >> 1 & 1;
    const int z = n >> 2;
    const float d = c[z][y][x] - static_cast<float>(x) * result.Slope[0] -
      static_cast<float>(y) * result.Slope[1] - static_cast<float>(z) * result.Slope[2];
    result.Low = Lesser(result.Low, d);
    result.High = Greater(result.High, d);
  }
}

LACUNA_WIDE float FindGreatest(const float* values, int count)
{
  float greatest[8] = { 0, 0, 0, 0, 0, 0, 0, 0 };
  for (int n = 0; n < count; n += 8)
  {
    for (int i = 0; i < 8; ++i)
    {
      greatest[i] = Greater(std::abs(values[n + i]), greatest[i]);
    }
  }
  for (int i = 1; i < 8; ++i)
  {
    greatest[0] = Greater(greatest[0], greatest[i]);
  }
  return greatest[0];
}
}

template <int Support>
void BlockPoints<Support>::SetTolerance(float rounded)
{
  const float greatest =
    Greater(rounded, FindGreatest(&this->Values[0][0][0], Width * Width * RowSize));
  // A Bezier point has been rounded some ten times, by 2^-24 each.
  constexpr float tolerance = 1.0F / (1 << 19);
  this->Tolerance = greatest > 1e-30F && greatest < 1e35F ? tolerance * greatest
                                                          : std::numeric_limits<float>::infinity();
}

template <int Support>
CellHulls BlockPoints<Support>::Classify() const
{
  if (!(this->Tolerance < std::numeric_limits<float>::infinity()))
  {
    return {};
  }
  if constexpr (Support == 4)
  {
    return ClassifyCubic(this->Values, this->Tolerance);
  }
  else
  {
    return ClassifyLinear(this->Values, this->Tolerance);
  }
}

template <int Support>
CellPlanes BlockPoints<Support>::FindPlanes(int i, int j, int k) const
{
  const double tolerance = this->Tolerance;
  if (!(tolerance < std::numeric_limits<double>::infinity()))
  {
    return { Vec3{ 0, 0, 0 }, -tolerance, tolerance };
  }
  FloatPlanes planes;
  if constexpr (Support == 4)
  {
    PlanesOfCubic(this->Values, i, j, k, planes);
  }
  else
  {
    PlanesOfLinear(this->Values, i, j, k, planes);
  }
  // A slope is at most the difference of two points: its products are rounded by no more than they.
  return { Vec3{ planes.Slope[0], planes.Slope[1], planes.Slope[2] }, planes.Low - 4 * tolerance,
    planes.High + 4 * tolerance };
}

template struct BlockPoints<2>;
template struct BlockPoints<4>;
}
