// SPDX-License-Identifier: BSD-3-Clause
#include "pqLacunaSpeedGauge.h"

#include "pqLacunaLiveState.h"

#include <QPainter>

#include <algorithm>
#include <cmath>

namespace
{
constexpr qint64 HoldTime = 1000;    // ms
constexpr double ScaleAnyhow = 46;   // mm/s at the end of the bar when there is no limit
const QColor Calm(0x43, 0xa0, 0x47); // green
const QColor Alarm(0xc6, 0x28, 0x28);
}

//------------------------------------------------------------------------------
pqLacunaSpeedGauge::pqLacunaSpeedGauge(QWidget* parent)
  : Superclass(parent)
{
  this->setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Preferred);
}

//------------------------------------------------------------------------------
QSize pqLacunaSpeedGauge::sizeHint() const
{
  const QFontMetrics metrics = this->fontMetrics();
  return { metrics.horizontalAdvance(tr("888 mm/s: too fast")) + metrics.height(),
    metrics.height() + metrics.height() / 2 };
}

//------------------------------------------------------------------------------
void pqLacunaSpeedGauge::SetState(const pqLacunaLiveState& state)
{
  const pqLacunaReadout readout = state.DescribeSpeed();
  this->HasLimit = state.SpeedLimit > 0;
  const bool isKnown = readout.Text.isEmpty() && !std::isnan(state.Speed);
  // a slice may have been too fast and its moment have passed since the last look
  if (this->HasLimit && isKnown &&
    (state.Speed > state.SpeedLimit || state.TooFast > this->TooFast))
  {
    this->Warned.start();
  }
  this->TooFast = state.TooFast;
  const bool isTooFast =
    isKnown && this->Warned.isValid() && this->Warned.elapsed() < HoldTime && this->HasLimit;
  this->Warning = readout.Warning || isTooFast;
  this->Length = isKnown
    ? std::clamp(state.Speed / (this->HasLimit ? 2 * state.SpeedLimit : ScaleAnyhow), 0.0, 1.0)
    : 0;
  this->Text = !readout.Text.isEmpty() ? readout.Text
    : !isKnown                         ? tr("speed unknown")
                                       : tr("%1 mm/s").arg(state.Speed, 0, 'f', 0);
  if (isTooFast)
  {
    this->Text = tr("%1: too fast").arg(this->Text);
  }
  this->setToolTip(readout.ToolTip);
  this->update();
}

//------------------------------------------------------------------------------
void pqLacunaSpeedGauge::paintEvent(QPaintEvent*)
{
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  const QPalette& colors = this->palette();
  const QRectF frame = QRectF(this->rect()).adjusted(0.5, 2.5, -0.5, -2.5);
  const double radius = 3;
  painter.setPen(Qt::NoPen);
  painter.setBrush(this->Warning ? Alarm : colors.color(QPalette::Base));
  painter.drawRoundedRect(frame, radius, radius);
  if (!this->Warning && this->Length > 0)
  {
    QColor color = Calm;
    color.setAlpha(110); // the text stands on it
    painter.setBrush(color);
    painter.save();
    painter.setClipRect(
      QRectF(frame.left(), frame.top(), frame.width() * this->Length, frame.height()));
    painter.drawRoundedRect(frame, radius, radius);
    painter.restore();
  }
  if (this->HasLimit && this->isEnabled())
  {
    // above and below the text
    constexpr double length = 4;
    painter.setPen(QPen(this->Warning ? Qt::white : Alarm, 2));
    const double x = std::floor(frame.center().x());
    painter.drawLine(QPointF(x, frame.top() + 1), QPointF(x, frame.top() + length));
    painter.drawLine(QPointF(x, frame.bottom() - length), QPointF(x, frame.bottom() - 1));
  }
  painter.setBrush(Qt::NoBrush);
  painter.setPen(colors.color(QPalette::Mid));
  painter.drawRoundedRect(frame, radius, radius);
  painter.setPen(this->Warning ? QColor(Qt::white) : colors.color(QPalette::WindowText));
  QFont bold = this->font();
  bold.setBold(this->Warning);
  painter.setFont(bold);
  painter.drawText(frame, Qt::AlignCenter, this->Text);
}
