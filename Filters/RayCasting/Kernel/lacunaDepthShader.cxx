// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthShader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacuna
{
namespace
{
constexpr int RowGrain = 4;
constexpr ValueRange Amount = ValueRange::Between(0, 1e6);

/// What is not a number is black.
unsigned char ToByte(double intensity)
{
  return intensity > 0 ? static_cast<unsigned char>(std::lround(255 * std::min(intensity, 1.0)))
                       : 0;
}

void Store(const Vec3& color, unsigned char* out)
{
  for (int a = 0; a < 3; ++a)
  {
    out[a] = ToByte(color[a]);
  }
}

/// Shades one point after the other.
class PointShader
{
public:
  PointShader(const DepthGrid& grid, const ShadingSettings& settings)
    : Grid(grid)
    , Settings(settings)
    , View(Normalized(grid.ImageToWorld.Column(2)))
  {
    const Sphere& data = settings.Data;
    const double centre =
      grid.Perspective ? Norm(data.Centre - grid.Eye) : Dot(data.Centre, this->View);
    this->Near = centre - data.Radius;
    this->Far = centre + data.Radius;
    if (grid.Perspective)
    {
      this->Near = std::max(this->Near, 0.0); // the eye is among the data
    }
    for (ShaderLight light : settings.Lights)
    {
      if (!light.IsPosition)
      {
        light.Place = Normalized(light.Place);
      }
      this->Lights.push_back(light);
    }
  }

  Vec3 Color(
    const Vec3& point, const Vec3& ray, const Vec3& normal, const ShadowProbe& shadows) const
  {
    const ShadingSettings& s = this->Settings;
    if (s.Model == ShadingModel::DepthOnly)
    {
      return this->Brightness(point) * s.SurfaceColor;
    }
    const Vec3 towardsViewer = -1 * ray;
    double diffuse = 0;
    double specular = 0;
    if (this->Lights.empty())
    {
      this->Reflect(normal, towardsViewer, towardsViewer, 1, diffuse, specular);
    }
    for (const ShaderLight& light : this->Lights)
    {
      const Vec3 way = light.Place - point;
      const Vec3 towardsLight = light.IsPosition ? Normalized(way) : light.Place;
      const double distance =
        light.IsPosition ? Norm(way) : std::numeric_limits<double>::infinity();
      if (Dot(normal, towardsLight) > 0 && !shadows.IsShadowed(point, towardsLight, distance))
      {
        this->Reflect(normal, towardsLight, towardsViewer, light.Intensity, diffuse, specular);
      }
    }
    const double cue = s.DepthCue > 0 ? 1 - s.DepthCue * (1 - this->Brightness(point)) : 1;
    const double matt = cue * (s.Ambient + s.Diffuse * diffuse);
    const double shine = cue * s.Specular * specular;
    return matt * s.SurfaceColor + Vec3{ shine, shine, shine };
  }

private:
  double Brightness(const Vec3& point) const
  {
    const double range = this->Far - this->Near;
    if (!(range > 0))
    {
      return 1;
    }
    const double distance =
      this->Grid.Perspective ? Norm(point - this->Grid.Eye) : Dot(point, this->View);
    return DepthIntensity((distance - this->Near) / range, this->Settings.Law);
  }

  void Reflect(const Vec3& normal, const Vec3& towardsLight, const Vec3& towardsViewer,
    double intensity, double& diffuse, double& specular) const
  {
    const double cosine = Dot(normal, towardsLight);
    if (!(cosine > 0))
    {
      return;
    }
    diffuse += intensity * cosine;
    const Vec3 reflected = 2 * cosine * normal - towardsLight;
    const double alignment = Dot(reflected, towardsViewer);
    if (this->Settings.Specular > 0 && alignment > 0)
    {
      specular += intensity * std::pow(std::min(alignment, 1.0), this->Settings.SpecularPower);
    }
  }

  const DepthGrid& Grid;
  const ShadingSettings& Settings;
  Vec3 View;
  double Near;
  double Far;
  std::vector<ShaderLight> Lights;
};
}

double DepthIntensity(double u, DepthLaw law)
{
  const double d = 1 + std::min(std::max(u, 0.0), 1.0);
  return law == DepthLaw::InverseSquare ? (4 / (d * d) - 1) / 3 : 2 / d - 1;
}

void ShadingSettings::Describe(Properties& properties) const
{
  std::vector<double> lights;
  for (const ShaderLight& light : this->Lights)
  {
    lights.insert(lights.end(), light.Place.Elements.begin(), light.Place.Elements.end());
    lights.push_back(light.IsPosition ? 1 : 0);
    lights.push_back(light.Intensity);
  }
  properties.Add("Shading", static_cast<int>(this->Model), ShadingModelNames)
    .Add("Ambient", this->Ambient, Amount)
    .Add("Diffuse", this->Diffuse, Amount)
    .Add("Specular", this->Specular, Amount)
    .Add("SpecularPower", this->SpecularPower, ValueRange::Between(1e-3, 1e6))
    .Add("DepthCue", this->DepthCue, ValueRange::Between(0, 1))
    .Add("DepthLaw", static_cast<int>(this->Law), DepthLawNames)
    .Add("Lights", lights, ValueRange::Any())
    .Add("SurfaceColor", this->SurfaceColor.Elements, ValueRange::Between(0, 1))
    .Add("BackgroundColor", this->BackgroundColor.Elements, ValueRange::Between(0, 1));
}

void ShadingSettings::Check() const
{
  Properties properties;
  this->Describe(properties);
  properties.Check();
  for (std::size_t i = 0; i < this->Lights.size(); ++i)
  {
    const ShaderLight& light = this->Lights[i];
    const std::string name = "light " + std::to_string(i);
    if (!light.IsPosition && !HasDirection(light.Place))
    {
      throw std::invalid_argument(name +
        " has no direction (its vector is zero or too long); give the direction towards the light");
    }
    Amount.Check(("the intensity of " + name).c_str(), light.Intensity);
  }
}

void ShadeDepths(const DepthGrid& grid, const float* normals, const ShadingSettings& settings,
  const ShadowCaster& shadows, const std::array<int, 4>& extent, unsigned char* colors,
  Execution& execution)
{
  settings.Check();
  const PointShader shader(grid, settings);
  const std::int64_t columns = static_cast<std::int64_t>(extent[1]) - extent[0] + 1;
  const std::int64_t rows = static_cast<std::int64_t>(extent[3]) - extent[2] + 1;
  if (columns <= 0 || rows <= 0)
  {
    return;
  }
  execution.For(rows, RowGrain,
    [&](std::int64_t begin, std::int64_t end)
    {
      const ShadowProbe probe(shadows);
      for (std::int64_t i = begin * columns; i < end * columns; ++i)
      {
        const int column = static_cast<int>(extent[0] + i % columns);
        const int row = static_cast<int>(extent[2] + i / columns);
        if (!grid.IsDefined(column, row))
        {
          Store(settings.BackgroundColor, colors + 3 * i);
          continue;
        }
        const Vec3 normal = normals ? Vec3{ normals[3 * i], normals[3 * i + 1], normals[3 * i + 2] }
                                    : Vec3{ 0, 0, 0 };
        Store(shader.Color(grid.PointOf(column, row), grid.RayOf(column, row), normal, probe),
          colors + 3 * i);
      }
    });
}
}
