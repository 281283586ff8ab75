// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class pqLacunaViewDirection
 * @brief editor of a ray caster's ViewDirection, with a button that takes the active view's camera
 *
 * A new caster of volumes starts to look as the active view does.
 * From Camera gives all properties that place the map the values that lacuna.views.copy_camera gives
 * them; of these, Projection, EyePosition and ViewAngle only to proxies that have them. As with any
 * editor, the values count when they are applied. Resolution divides the number of the map's rows and
 * columns, at once if a camera was taken before: for a quick look while the view is chosen.
 */
#ifndef pqLacunaViewDirection_h
#define pqLacunaViewDirection_h

#include "pqPropertyWidget.h"

#include <array>

class QComboBox;
class QPushButton;

class pqLacunaViewDirection : public pqPropertyWidget
{
  Q_OBJECT
  typedef pqPropertyWidget Superclass;

public:
  pqLacunaViewDirection(vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent = nullptr);
  ~pqLacunaViewDirection() override;

  void apply() override;
  void reset() override;

private:
  void TakeCamera();
  void SetResolution();
  void StartFromCamera();
  void UpdateButton(pqView* view);

  pqPropertyWidget* Direction;
  QPushButton* FromCamera;
  QComboBox* Resolution;
  std::array<int, 2> WindowSize{}; ///< of the view whose camera was taken; 0: none
  double ShownHeight = 0;          ///< mm from the top to the bottom of that view
};
#endif
