// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Quantities that grow evenly from voxel to voxel.
#ifndef lacunaAffineFunction_h
#define lacunaAffineFunction_h

namespace lacuna
{
/// I i + J j + K k + C, a function of the voxel indices i, j, k.
struct AffineFunction
{
  double I, J, K, C;

  double operator()(double i, double j, double k) const
  {
    return this->I * i + this->J * j + this->K * k + this->C;
  }
};

inline AffineFunction operator-(const AffineFunction& f)
{
  return { -f.I, -f.J, -f.K, -f.C };
}

inline AffineFunction operator+(const AffineFunction& f, const AffineFunction& g)
{
  return { f.I + g.I, f.J + g.J, f.K + g.K, f.C + g.C };
}

inline AffineFunction operator+(const AffineFunction& f, double c)
{
  return { f.I, f.J, f.K, f.C + c };
}

inline AffineFunction operator*(double s, const AffineFunction& f)
{
  return { s * f.I, s * f.J, s * f.K, s * f.C };
}
}
#endif
