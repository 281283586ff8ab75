// SPDX-License-Identifier: BSD-3-Clause
#include "pqLacunaViewDirection.h"

#include "pqApplicationCore.h"
#include "pqDoubleVectorPropertyWidget.h"
#include "pqProxy.h"
#include "pqRenderView.h"
#include "pqServerManagerModel.h"
#include "vtkCamera.h"
#include "vtkMath.h"
#include "vtkSMProxy.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkSMUncheckedPropertyHelper.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QPushButton>
#include <QTimer>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>

namespace
{
/// Changes what the panel shows, not yet the proxy; nothing when it has no such property.
template <class T>
void Show(vtkSMProxy* proxy, const char* name, const T* values, unsigned int count)
{
  if (proxy->GetProperty(name))
  {
    vtkSMUncheckedPropertyHelper(proxy, name).Set(values, count);
  }
}
}

//------------------------------------------------------------------------------
pqLacunaViewDirection::pqLacunaViewDirection(
  vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent)
  : Superclass(proxy, parent)
  , Direction(new pqDoubleVectorPropertyWidget(property, proxy, this))
  , FromCamera(new QPushButton(tr("From Camera"), this))
  , Resolution(new QComboBox(this))
{
  this->setChangeAvailableAsChangeFinished(false);
  this->FromCamera->setObjectName("FromCamera");
  this->FromCamera->setToolTip(
    tr("Look as the active 3-D view does: direction, projection, place and size of the map."));
  this->Resolution->setObjectName("Resolution");
  this->Resolution->setToolTip(
    tr("Rows and columns of the map, as a part of the view's: few for a quick preview."));
  for (const int divisor : { 1, 2, 4, 8 })
  {
    this->Resolution->addItem(divisor == 1 ? tr("Full") : tr("1/%1").arg(divisor), divisor);
  }
  auto* row = new QHBoxLayout;
  row->setContentsMargins(0, 0, 0, 0);
  row->addWidget(this->FromCamera, 1);
  row->addWidget(this->Resolution);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(this->Direction);
  layout->addLayout(row);

  QObject::connect(
    this->Direction, &pqPropertyWidget::changeAvailable, this, &pqPropertyWidget::changeAvailable);
  QObject::connect(
    this->Direction, &pqPropertyWidget::changeFinished, this, &pqPropertyWidget::changeFinished);
  QObject::connect(
    this->FromCamera, &QPushButton::clicked, this, &pqLacunaViewDirection::TakeCamera);
  QObject::connect(this->Resolution, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
    &pqLacunaViewDirection::SetResolution);
  QObject::connect(
    this, &pqPropertyWidget::viewChanged, this, &pqLacunaViewDirection::UpdateButton);
  this->UpdateButton(this->view());
  // by then the proxy is said to be new, and the panel has its view
  QTimer::singleShot(0, this, &pqLacunaViewDirection::StartFromCamera);
}

//------------------------------------------------------------------------------
pqLacunaViewDirection::~pqLacunaViewDirection() = default;

//------------------------------------------------------------------------------
void pqLacunaViewDirection::apply()
{
  this->Superclass::apply();
  this->Direction->apply();
}

//------------------------------------------------------------------------------
void pqLacunaViewDirection::reset()
{
  this->Superclass::reset();
  this->Direction->reset();
}

//------------------------------------------------------------------------------
void pqLacunaViewDirection::UpdateButton(pqView* view)
{
  this->FromCamera->setEnabled(qobject_cast<pqRenderView*>(view) != nullptr);
}

//------------------------------------------------------------------------------
void pqLacunaViewDirection::StartFromCamera()
{
  auto* view = qobject_cast<pqRenderView*>(this->view());
  auto* caster =
    pqApplicationCore::instance()->getServerManagerModel()->findItem<pqProxy*>(this->proxy());
  // slices are shown in pixels, where the camera says nothing about the frame that they lie in
  const bool ofVolumes = this->proxy()->GetProperty("Projection") != nullptr;
  if (!view || !ofVolumes || !caster || caster->modifiedState() != pqProxy::UNINITIALIZED)
  {
    return;
  }
  vtkCamera* camera = view->getRenderViewProxy()->GetActiveCamera();
  Show(this->proxy(), "ViewDirection", camera->GetDirectionOfProjection(), 3);
  Show(this->proxy(), "ViewUp", camera->GetViewUp(), 3);
}

//------------------------------------------------------------------------------
void pqLacunaViewDirection::TakeCamera()
{
  auto* view = qobject_cast<pqRenderView*>(this->view());
  if (!view)
  {
    return;
  }
  vtkSMProxy* caster = this->proxy();
  vtkCamera* camera = view->getRenderViewProxy()->GetActiveCamera();
  vtkSMPropertyHelper(view->getProxy(), "ViewSize").Get(this->WindowSize.data(), 2);
  const double* position = camera->GetPosition();
  const double* focus = camera->GetFocalPoint();
  double direction[3];
  vtkMath::Subtract(focus, position, direction);
  const double distance = vtkMath::Norm(direction);
  const bool isParallel = camera->GetParallelProjection() != 0;
  double slope = std::tan(vtkMath::RadiansFromDegrees(camera->GetViewAngle()) / 2);
  if (camera->GetUseHorizontalViewAngle() && this->WindowSize[0] > 0)
  {
    slope *= static_cast<double>(this->WindowSize[1]) / this->WindowSize[0];
  }
  this->ShownHeight = 2 * (isParallel ? camera->GetParallelScale() : distance * slope);

  Show(caster, "ViewDirection", direction, 3);
  Show(caster, "ViewUp", camera->GetViewUp(), 3);
  Show(caster, "FocalPoint", focus, 3);
  const bool hasPerspective = caster->GetProperty("Projection") != nullptr;
  const int projection = isParallel ? 0 : 1;
  Show(caster, "Projection", &projection, 1);
  if (hasPerspective && !isParallel)
  {
    // the map's plane goes through the focal point, where the spacing of its pixels holds
    const double angle = 2 * vtkMath::DegreesFromRadians(std::atan(slope));
    Show(caster, "PlaneOrigin", focus, 3);
    Show(caster, "EyePosition", position, 3);
    Show(caster, "ViewAngle", &angle, 1);
  }
  else
  {
    Show(caster, "PlaneOrigin", position, 3);
  }
  this->SetResolution();
}

//------------------------------------------------------------------------------
void pqLacunaViewDirection::SetResolution()
{
  vtkSMProxy* caster = this->proxy();
  const double width = this->WindowSize[0];
  const double height = this->WindowSize[1];
  if (!(width > 0 && height > 0))
  {
    return; // no camera was taken: the map's size is the data's, or given
  }
  const double rows =
    std::max(1.0, std::round(height / this->Resolution->currentData().toDouble()));
  const double columns = std::max(1.0, std::round(width * rows / height));
  const int size[2] = { static_cast<int>(columns), static_cast<int>(rows) };
  const double spacing = this->ShownHeight / rows;
  Show(caster, "ImageSize", size, 2);
  Show(caster, "PixelSpacing", &spacing, 1);
  Q_EMIT this->changeAvailable();
  Q_EMIT this->changeFinished();
}
