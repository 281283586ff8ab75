// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The scene of a plate as that of a model.
#ifndef lacunaDefectModelScene_h
#define lacunaDefectModelScene_h

#include "lacunaDefectModel.h"
#include "lacunaPlateScene.h"
#include "lacunaReliefSurface.h"

struct DefectModelScene
{
  PlateScene& Plate;
  lacuna::DefectScene Scene;

  explicit DefectModelScene(PlateScene& plate)
    : Plate(plate)
  {
    this->Scene.MapSize = this->Scene.Size = plate.Size;
    this->Scene.Spacing = plate.Spacing;
    this->Scene.MapDepths = this->Scene.Fitted = plate.Depths;
    this->Scene.Mask = plate.Mask;
  }

  lacuna::DefectModel Make(const lacuna::DefectModelOptions& options)
  {
    const lacuna::ReliefSurface surface(
      this->Plate.Execution, this->Scene.Size, this->Scene.Fitted, this->Scene.Spacing);
    return lacuna::MakeDefectModel(this->Plate.Execution, this->Scene, surface, options);
  }
};
#endif
