// SPDX-License-Identifier: BSD-3-Clause
#include "pqLacunaLiveToolbar.h"

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqLacunaLiveState.h"
#include "pqLacunaSpeedGauge.h"
#include "pqLacunaWindow.h"
#include "pqPipelineSource.h"
#include "pqServer.h"
#include "pqServerManagerModel.h"
#include "pqSettings.h"
#include "vtkPVDataInformation.h"
#include "vtkSMSession.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMTrace.h"

#include <QLabel>
#include <QMainWindow>
#include <QMenu>
#include <QMenuBar>
#include <QPainter>
#include <QToolButton>

#include <cstring>

namespace
{
constexpr int Interval = 200;   // ms
constexpr int EnoughToLook = 5; // slices, by which a camera is turned to them
constexpr const char* StopStyle =
  "QToolButton { background: #d32f2f; color: white; font-weight: bold; "
  "border-radius: 4px; padding: 2px 10px; }";

// ParaView keeps a shortcut by the words of the menu, so that these must not change.
constexpr const char* ActionText = "Start or Stop Live Acquisition";
constexpr const char* DefaultKeyProperty = "ParaViewDefaultKeySequence";

bool IsLive(const pqPipelineSource* source)
{
  return source && std::strcmp(source->getProxy()->GetXMLName(), "LacunaPolhemusVideoSource") == 0;
}

QIcon DrawIcon(bool isStop)
{
  constexpr int size = 64;
  QPixmap picture(size, size);
  picture.fill(Qt::transparent);
  QPainter painter(&picture);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(Qt::NoPen);
  painter.setBrush(isStop ? QColor(Qt::white) : QColor(0xd3, 0x2f, 0x2f));
  if (isStop)
  {
    painter.drawRoundedRect(12, 12, size - 24, size - 24, 4, 4);
  }
  else
  {
    painter.drawEllipse(8, 8, size - 16, size - 16);
  }
  painter.end();
  return QIcon(picture);
}

void Show(QLabel* label, const pqLacunaReadout& readout)
{
  label->setText(readout.Text);
  label->setToolTip(readout.ToolTip);
  const QString style = readout.Warning
    ? "background: #ffb300; color: black; font-weight: bold; border-radius: 3px; margin: 3px 0;"
    : "";
  if (label->styleSheet() != style)
  {
    label->setStyleSheet(style);
  }
  // as wide as the longest so far: what stands beside does not tremble while numbers change
  label->setMinimumWidth(qMax(label->minimumWidth(), label->sizeHint().width()));
}
}

//------------------------------------------------------------------------------
pqLacunaLiveToolbar::pqLacunaLiveToolbar(QWidget* parent)
  : Superclass(tr("Live Acquisition"), parent)
  , StartStop(new QAction(tr(ActionText), this))
  , StartIcon(DrawIcon(false))
  , StopIcon(DrawIcon(true))
{
  this->setObjectName("LacunaLiveToolbar");
  this->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  this->StartStop->setShortcut(QKeySequence(Qt::Key_F9));
  this->StartStop->setShortcutContext(Qt::ApplicationShortcut);
  this->StartStop->setAutoRepeat(false); // a foot stays on its switch
  QObject::connect(this->StartStop, &QAction::triggered, this, &pqLacunaLiveToolbar::Toggle);
  this->addAction(this->StartStop);
  this->widgetForAction(this->StartStop)->setObjectName("LiveStartStop");
  this->AddReadouts();
  // when the window has its menus and toolbars, and before ParaView restores where they were
  QTimer::singleShot(0, this, &pqLacunaLiveToolbar::SettleIn);

  this->Timer.setInterval(Interval);
  QObject::connect(&this->Timer, &QTimer::timeout, this, &pqLacunaLiveToolbar::Poll);
  auto* model = pqApplicationCore::instance()->getServerManagerModel();
  QObject::connect(
    model, &pqServerManagerModel::sourceAdded, this, &pqLacunaLiveToolbar::FindSource);
  // not before it is removed: the selection that changes with it would find it again
  QObject::connect(model, &pqServerManagerModel::sourceRemoved, this,
    [this](pqPipelineSource* source)
    {
      if (source == this->Source)
      {
        this->Source = nullptr;
        this->ShowNoSource();
        this->FindSource();
      }
    });
  QObject::connect(&pqActiveObjects::instance(), &pqActiveObjects::sourceChanged, this,
    &pqLacunaLiveToolbar::FindSource);
  this->ShowNoSource();
  this->FindSource();
}

//------------------------------------------------------------------------------
pqLacunaLiveToolbar::~pqLacunaLiveToolbar() = default;

//------------------------------------------------------------------------------
void pqLacunaLiveToolbar::AddReadouts()
{
  const auto add = [this](QWidget* widget, const char* name)
  {
    widget->setObjectName(name);
    this->Readouts.push_back(this->addSeparator());
    this->Readouts.push_back(this->addWidget(widget));
  };
  const auto addLabel = [&](const char* name)
  {
    auto* label = new QLabel(this);
    label->setContentsMargins(4, 0, 4, 0);
    add(label, name);
    return label;
  };
  this->Speed = new pqLacunaSpeedGauge(this);
  add(this->Speed, "LiveSpeed");
  this->Slices = addLabel("LiveSlices");
  this->Disk = addLabel("LiveDisk");
  this->Memory = addLabel("LiveMemory");
}

//------------------------------------------------------------------------------
void pqLacunaLiveToolbar::SettleIn()
{
  auto* window = qobject_cast<QMainWindow*>(this->parentWidget());
  if (!window)
  {
    return;
  }
  window->addToolBar(this); // moves it to the last row, where there is room for the readouts
  for (QAction* entry : window->menuBar()->actions())
  {
    if (entry->menu() && entry->text().remove('&') == "Tools")
    {
      entry->menu()->addAction(this->StartStop);
    }
  }
  // ParaView has given the shortcuts that were chosen to the actions that were there before
  if (!this->StartStop->property(DefaultKeyProperty).isValid())
  {
    this->StartStop->setProperty(DefaultKeyProperty, this->StartStop->shortcut());
    const QVariant chosen = pqApplicationCore::instance()->settings()->value(
      "pqCustomShortcuts/Tools/" + QString(ActionText).remove(' '));
    if (chosen.canConvert<QKeySequence>())
    {
      this->StartStop->setShortcut(chosen.value<QKeySequence>());
    }
  }
}

//------------------------------------------------------------------------------
void pqLacunaLiveToolbar::FindSource()
{
  pqPipelineSource* active = pqActiveObjects::instance().activeSource();
  if (IsLive(active))
  {
    this->Source = active;
  }
  else if (!this->Source)
  {
    auto* model = pqApplicationCore::instance()->getServerManagerModel();
    for (pqPipelineSource* source : model->findItems<pqPipelineSource*>())
    {
      if (!this->Source && IsLive(source))
      {
        this->Source = source;
      }
    }
  }
  if (this->Source)
  {
    this->Timer.start();
    this->Poll();
  }
}

//------------------------------------------------------------------------------
void pqLacunaLiveToolbar::Poll()
{
  if (!this->Source)
  {
    this->ShowNoSource();
    return;
  }
  pqServer* server = this->Source->getServer();
  if (server->isProcessingPending() || server->session()->GetPendingProgress())
  {
    return; // it would be waited for
  }
  const pqLacunaLiveState state = pqLacunaLiveState::Read(this->Source->getProxy());
  this->ShowState(state);
  const int* extent = this->Source->getSourceProxy()->GetDataInformation(0)->GetExtent();
  if (extent[5] - extent[4] + 1 < EnoughToLook) // in the views
  {
    this->Seen = nullptr;
  }
  else if (this->Seen != this->Source)
  {
    this->Seen = this->Source;
    const QString identity = QString::number(this->Source->getProxy()->GetGlobalID());
    pqLacunaWindow::Run("look_live(" + identity + ")");
  }
}

//------------------------------------------------------------------------------
void pqLacunaLiveToolbar::Toggle()
{
  if (!this->Source)
  {
    return;
  }
  vtkSMProxy* proxy = this->Source->getProxy();
  // the stylus, or a script, may have been quicker than the timer
  const char* command = pqLacunaLiveState::Read(proxy).Capturing ? "Stop" : "Start";
  {
    SM_SCOPED_TRACE(CallMethod).arg("proxy", proxy).arg("InvokeCommand").arg(command);
    proxy->InvokeCommand(command);
  }
  this->Source->renderAllViews();
  this->Poll();
}

//------------------------------------------------------------------------------
void pqLacunaLiveToolbar::ShowNoSource()
{
  this->Timer.stop();
  this->StartStop->setEnabled(false);
  this->StartStop->setIcon(this->StartIcon);
  this->StartStop->setIconText(tr("Start"));
  this->widgetForAction(this->StartStop)->setStyleSheet("");
  this->StartStop->setToolTip(
    tr("Live acquisition: there is no Polhemus Video Source; Sources > Lacuna makes one."));
  for (QAction* readout : this->Readouts)
  {
    readout->setVisible(false);
  }
}

//------------------------------------------------------------------------------
void pqLacunaLiveToolbar::ShowState(const pqLacunaLiveState& state)
{
  const bool isNew = this->Source->modifiedState() == pqProxy::UNINITIALIZED;
  this->StartStop->setEnabled(!isNew);
  this->StartStop->setIcon(state.Capturing ? this->StopIcon : this->StartIcon);
  this->StartStop->setIconText(state.Capturing ? tr("Stop") : tr("Start"));
  QWidget* button = this->widgetForAction(this->StartStop);
  if (button->styleSheet().isEmpty() == state.Capturing)
  {
    button->setStyleSheet(state.Capturing ? StopStyle : "");
  }
  const QString key = this->StartStop->shortcut().toString(QKeySequence::NativeText);
  QString tip = isNew ? tr("%1: set its devices and press Apply first")
    : state.Capturing ? tr("%1: stop taking slices")
                      : tr("%1: take slices from now on");
  tip = tip.arg(this->Source->getSMName());
  tip += key.isEmpty() ? "" : tr(" (%1; a key is chosen by Tools > Customize Shortcuts)").arg(key);
  this->StartStop->setToolTip(state.Message.isEmpty() ? tip : tip + "\n\n" + state.Message);
  this->Speed->SetState(state);
  Show(this->Slices, state.DescribeSlices());
  Show(this->Disk, state.DescribeDisk());
  Show(this->Memory, state.DescribeMemory());
  for (QAction* readout : this->Readouts)
  {
    readout->setVisible(true);
  }
}
