// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCellHulls.h"

#include "lacunaWide.h"

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
inline void AlongRow(const float* p, float* line)
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
inline void AcrossLines(const float (*in)[LineSize], float* out, int stride)
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

inline float Lesser(float a, float b)
{
  return a < b ? a : b;
}

inline float Greater(float a, float b)
{
  return a > b ? a : b;
}

/// Of the lines that bound a cell.
inline void MergeLines(
  const float* a, const float* b, const float* c, const float* d, Range& result)
{
  for (int i = 0; i < LineSize; ++i)
  {
    result.Low[i] = Lesser(Lesser(a[i], b[i]), Lesser(c[i], d[i]));
    result.High[i] = Greater(Greater(a[i], b[i]), Greater(c[i], d[i]));
  }
}

inline void MergeRanges(
  const Range& a, const Range& b, const Range& c, const Range& d, Range& result)
{
  for (int i = 0; i < LineSize; ++i)
  {
    result.Low[i] = Lesser(Lesser(a.Low[i], b.Low[i]), Lesser(c.Low[i], d.Low[i]));
    result.High[i] = Greater(Greater(a.High[i], b.High[i]), Greater(c.High[i], d.High[i]));
  }
}

inline void Store(CellHulls& hulls, float low, float high, float tolerance, int bit)
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
}

template <int Support>
CellHulls BlockPoints<Support>::Classify(float tolerance) const
{
  if constexpr (Support == 4)
  {
    return ClassifyCubic(this->Values, tolerance);
  }
  else
  {
    return ClassifyLinear(this->Values, tolerance);
  }
}

template struct BlockPoints<2>;
template struct BlockPoints<4>;
}
