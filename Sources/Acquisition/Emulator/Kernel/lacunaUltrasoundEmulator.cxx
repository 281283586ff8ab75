// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaUltrasoundEmulator.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace lacuna
{
UltrasoundEmulator::UltrasoundEmulator(
  std::unique_ptr<PhantomScene> scene, const UltrasoundSettings& settings)
  : Scene(std::move(scene))
  , Screen(settings.Layout)
  , Speckle(settings.Seed)
  , SpeckleLevel(settings.SpeckleLevel)
{
  if (!(settings.SpeckleLevel >= 0 && settings.SpeckleLevel <= 1))
  {
    std::ostringstream message;
    message << "the speckle's level is " << settings.SpeckleLevel << "; it must be from 0 to 1";
    throw std::invalid_argument(message.str());
  }
}

void UltrasoundEmulator::Render(
  const Matrix4& imageToScene, double time, std::int64_t number, std::uint8_t* pixels) const
{
  const std::vector<std::uint8_t>& ground = this->Screen.GetGround();
  std::copy(ground.begin(), ground.end(), pixels);
  const int columns = this->Screen.GetLayout().Columns;
  const Vec3 step = imageToScene.Column(0);
  std::vector<double> levels(static_cast<std::size_t>(columns));
  for (const ScannerScreen::Run& run : this->Screen.GetRuns())
  {
    const Vec3 start = imageToScene.Point({ 0, static_cast<double>(run.Row), 0 });
    const int count = run.Last - run.First + 1;
    this->Scene->SampleRow(start, step, run.First, count, levels.data());
    if (this->SpeckleLevel > 0)
    {
      this->Speckle.Apply(start + static_cast<double>(run.First) * step, step, count,
        this->SpeckleLevel, levels.data());
    }
    std::uint8_t* row = pixels + static_cast<std::int64_t>(run.Row) * columns + run.First;
    for (int i = 0; i < count; ++i)
    {
      // truncation rounds half up
      row[i] = static_cast<std::uint8_t>(
        std::clamp(levels[static_cast<std::size_t>(i)], 0.0, 255.0) + 0.5);
    }
  }
  this->Screen.DrawFrameNumber(time, number, pixels);
}
}
