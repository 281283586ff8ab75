// SPDX-License-Identifier: BSD-3-Clause
#include "pqLacunaOutlineCanvas.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <QWheelEvent>

#include <algorithm>
#include <cmath>
#include <limits>

namespace
{
constexpr double Near = 8; // widget pixels
constexpr double HandleRadius = 4;

QPointF GetPlace(const QMouseEvent* event)
{
#if QT_VERSION < QT_VERSION_CHECK(6, 0, 0)
  return event->localPos();
#else
  return event->position();
#endif
}

double Distance(const QPointF& a, const QPointF& b)
{
  return std::hypot(b.x() - a.x(), b.y() - a.y());
}

double DistanceFromSegment(const QPointF& x, const QPointF& a, const QPointF& b)
{
  const QPointF d = b - a;
  const double square = QPointF::dotProduct(d, d);
  const double t = square > 0 ? std::clamp(QPointF::dotProduct(x - a, d) / square, 0.0, 1.0) : 0;
  return Distance(x, a + t * d);
}
}

//------------------------------------------------------------------------------
pqLacunaOutlineCanvas::pqLacunaOutlineCanvas(QWidget* parent)
  : Superclass(parent)
{
  this->setObjectName("OutlineCanvas");
  this->setFocusPolicy(Qt::StrongFocus);
  this->setMouseTracking(true);
  this->setMinimumSize(240, 200);
  this->setCursor(Qt::CrossCursor);
}

//------------------------------------------------------------------------------
void pqLacunaOutlineCanvas::SetPicture(
  const QImage& picture, double aspect, const QString letters[2])
{
  if (picture.size() != this->Picture.size() || aspect != this->Aspect)
  {
    this->Zoom = 1;
    this->Pan = QPointF();
  }
  this->Picture = picture;
  this->Aspect = aspect;
  this->Letters[0] = letters[0];
  this->Letters[1] = letters[1];
  this->update();
}

void pqLacunaOutlineCanvas::SetOutlines(const QVector<Outline>& outlines)
{
  this->Outlines = outlines;
  this->DraggedOutline = -1;
  this->update();
}

void pqLacunaOutlineCanvas::SetTool(Tools tool)
{
  this->Tool = tool;
  this->Forget();
}

void pqLacunaOutlineCanvas::SetColor(const QColor& color)
{
  this->Color = color;
  this->update();
}

void pqLacunaOutlineCanvas::SetCaption(const QString& caption)
{
  this->Caption = caption;
  this->update();
}

void pqLacunaOutlineCanvas::SetMessage(const QString& message)
{
  this->Message = message;
  this->update();
}

void pqLacunaOutlineCanvas::Forget()
{
  this->Pending.clear();
  this->Region = QRectF();
  this->IsDrawing = false;
  this->update();
}

//------------------------------------------------------------------------------
QPointF pqLacunaOutlineCanvas::ToWidget(const QPointF& place) const
{
  const double w = this->Picture.width();
  const double h = this->Picture.height() * this->Aspect;
  const double scale = this->Zoom * std::min(this->width() / w, this->height() / h);
  return QPointF(0.5 * this->width(), 0.5 * this->height()) + this->Pan +
    scale * QPointF(place.x() + 0.5 - 0.5 * w, (place.y() + 0.5) * this->Aspect - 0.5 * h);
}

QPointF pqLacunaOutlineCanvas::ToPicture(const QPointF& at) const
{
  const double w = this->Picture.width();
  const double h = this->Picture.height() * this->Aspect;
  const double scale = this->Zoom * std::min(this->width() / w, this->height() / h);
  const QPointF x = (at - QPointF(0.5 * this->width(), 0.5 * this->height()) - this->Pan) / scale;
  return { x.x() + 0.5 * w - 0.5, (x.y() + 0.5 * h) / this->Aspect - 0.5 };
}

//------------------------------------------------------------------------------
bool pqLacunaOutlineCanvas::FindHandle(const QPointF& at, int& outline, int& handle) const
{
  double best = Near;
  outline = -1;
  for (int o = 0; o < this->Outlines.size(); ++o)
  {
    for (int i = 0; i < this->Outlines[o].Handles.size(); ++i)
    {
      const double away = Distance(at, this->ToWidget(this->Outlines[o].Handles[i]));
      // of those that lie on each other, one of the structure that is being drawn
      if (away < best || (away == best && this->Outlines[o].IsCurrent))
      {
        best = away;
        outline = o;
        handle = i;
      }
    }
  }
  return outline >= 0;
}

bool pqLacunaOutlineCanvas::FindCurve(const QPointF& at, int& outline, int& before) const
{
  double best = Near;
  outline = -1;
  for (int o = 0; o < this->Outlines.size(); ++o)
  {
    const QPolygonF& handles = this->Outlines[o].Handles;
    const QPolygonF& curve = this->Outlines[o].Curve;
    for (int i = 0; i < curve.size(); ++i)
    {
      const double away = DistanceFromSegment(
        at, this->ToWidget(curve[i]), this->ToWidget(curve[(i + 1) % curve.size()]));
      if (away < best)
      {
        best = away;
        outline = o;
        before = static_cast<int>(i * handles.size() / curve.size());
      }
    }
  }
  return outline >= 0;
}

//------------------------------------------------------------------------------
void pqLacunaOutlineCanvas::Close()
{
  if (this->Pending.size() >= 3)
  {
    const QPolygonF points = this->Pending;
    const bool isFreehand = this->Tool == Freehand;
    this->Forget();
    Q_EMIT this->drawn(points, isFreehand);
  }
}

//------------------------------------------------------------------------------
void pqLacunaOutlineCanvas::mousePressEvent(QMouseEvent* event)
{
  if (this->Picture.isNull() || !this->Message.isEmpty()) // there is nothing to draw in
  {
    return;
  }
  this->setFocus();
  const QPointF at = GetPlace(event);
  this->Last = at;
  if (event->button() == Qt::MiddleButton)
  {
    this->IsPanning = true;
    return;
  }
  if (event->button() == Qt::RightButton)
  {
    if (this->Tool == Points && this->Pending.size() >= 3)
    {
      this->Close();
    }
    else
    {
      this->IsWindowing = true;
    }
    return;
  }
  if (event->button() != Qt::LeftButton)
  {
    return;
  }
  int outline = -1;
  int handle = -1;
  if (this->Pending.isEmpty() && this->FindHandle(at, outline, handle))
  {
    if (event->modifiers() & Qt::ControlModifier)
    {
      QPolygonF handles = this->Outlines[outline].Handles;
      if (handles.size() > 3)
      {
        handles.remove(handle);
        Q_EMIT this->moved(outline, handles);
      }
      return;
    }
    this->DraggedOutline = outline;
    this->DraggedHandle = handle;
    return;
  }
  if (event->modifiers() & Qt::ShiftModifier)
  {
    if (this->FindCurve(at, outline, handle))
    {
      QPolygonF handles = this->Outlines[outline].Handles;
      handles.insert(handle + 1, this->ToPicture(at));
      Q_EMIT this->moved(outline, handles);
    }
    return;
  }
  if (this->Tool == Points)
  {
    if (this->Pending.size() >= 3 && Distance(at, this->ToWidget(this->Pending[0])) < Near)
    {
      this->Close();
      return;
    }
    this->Pending.push_back(this->ToPicture(at));
  }
  else if (this->Tool == Freehand)
  {
    this->IsDrawing = true;
    this->Pending = QPolygonF({ this->ToPicture(at) });
  }
  else
  {
    this->IsDrawing = true;
    this->Region = QRectF(this->ToPicture(at), QSizeF(0, 0));
  }
  this->update();
}

//------------------------------------------------------------------------------
void pqLacunaOutlineCanvas::mouseMoveEvent(QMouseEvent* event)
{
  const QPointF at = GetPlace(event);
  const QPointF step = at - this->Last;
  this->Cursor = at;
  if (this->Picture.isNull())
  {
    return;
  }
  if (this->IsPanning)
  {
    this->Pan += step;
    this->Last = at;
  }
  else if (this->IsWindowing)
  {
    this->Last = at;
    Q_EMIT this->windowDragged(step.y() / 300, step.x() / 300);
  }
  else if (this->DraggedOutline >= 0 && this->DraggedOutline < this->Outlines.size())
  {
    Outline& outline = this->Outlines[this->DraggedOutline];
    outline.Handles[this->DraggedHandle] = this->ToPicture(at);
    outline.Curve = outline.Handles; // until the button is let go
  }
  else if (this->IsDrawing && this->Tool == Freehand)
  {
    const QPointF place = this->ToPicture(at);
    if (Distance(place, this->Pending.back()) >= 0.5)
    {
      this->Pending.push_back(place);
    }
  }
  else if (this->IsDrawing)
  {
    this->Region.setBottomRight(this->ToPicture(at));
  }
  this->update();
}

//------------------------------------------------------------------------------
void pqLacunaOutlineCanvas::mouseReleaseEvent(QMouseEvent* event)
{
  this->IsPanning = this->IsWindowing = false;
  if (event->button() != Qt::LeftButton)
  {
    return;
  }
  if (this->DraggedOutline >= 0)
  {
    const int outline = this->DraggedOutline;
    this->DraggedOutline = -1;
    if (GetPlace(event) != this->Last)
    {
      const QPolygonF handles = this->Outlines[outline].Handles;
      Q_EMIT this->moved(outline, handles);
    }
    return;
  }
  if (!this->IsDrawing)
  {
    return;
  }
  if (this->Tool == Freehand)
  {
    if (this->Pending.size() >= 8)
    {
      this->Close();
    }
    this->Forget();
  }
  else
  {
    const QRectF region = this->Region.normalized();
    const QPointF place = this->Region.topLeft();
    const bool isClick = Distance(GetPlace(event), this->Last) < Near;
    this->Forget();
    Q_EMIT this->traceWanted(place, isClick ? QRectF() : region);
  }
}

//------------------------------------------------------------------------------
void pqLacunaOutlineCanvas::mouseDoubleClickEvent(QMouseEvent* event)
{
  if (this->Tool == Points && event->button() == Qt::LeftButton && !this->Pending.isEmpty())
  {
    this->Close(); // the first of the two clicks has set the last point
  }
  else
  {
    this->mousePressEvent(event);
  }
}

//------------------------------------------------------------------------------
void pqLacunaOutlineCanvas::wheelEvent(QWheelEvent* event)
{
  const double steps = event->angleDelta().y() / 120.0;
  if (event->modifiers() & Qt::ControlModifier)
  {
    const QPointF at = event->position();
    const QPointF place = this->ToPicture(at);
    this->Zoom = std::clamp(this->Zoom * std::pow(1.2, steps), 0.5, 40.0);
    this->Pan += at - this->ToWidget(place);
    this->update();
  }
  else if (steps != 0)
  {
    Q_EMIT this->stepped(steps > 0 ? -1 : 1);
  }
  event->accept();
}

//------------------------------------------------------------------------------
// The window's own Undo has this key, too: of outlines the picture takes it first.
bool pqLacunaOutlineCanvas::event(QEvent* event)
{
  if (event->type() == QEvent::ShortcutOverride)
  {
    auto* key = static_cast<QKeyEvent*>(event);
    if (key->matches(QKeySequence::Undo) || key->matches(QKeySequence::Redo))
    {
      event->accept();
      return true;
    }
  }
  return this->Superclass::event(event);
}

//------------------------------------------------------------------------------
void pqLacunaOutlineCanvas::keyPressEvent(QKeyEvent* event)
{
  if (event->matches(QKeySequence::Undo) || event->matches(QKeySequence::Redo))
  {
    Q_EMIT this->undoWanted(event->matches(QKeySequence::Redo));
    return;
  }
  switch (event->key())
  {
    case Qt::Key_Return:
    case Qt::Key_Enter:
      this->Close();
      break;
    case Qt::Key_Escape:
      this->Forget();
      break;
    case Qt::Key_Backspace:
      if (this->Tool == Points && !this->Pending.isEmpty())
      {
        this->Pending.removeLast();
        this->update();
      }
      break;
    case Qt::Key_Left:
    case Qt::Key_Up:
      Q_EMIT this->stepped(-1);
      break;
    case Qt::Key_Right:
    case Qt::Key_Down:
      Q_EMIT this->stepped(1);
      break;
    case Qt::Key_PageUp:
      Q_EMIT this->stepped(-10);
      break;
    case Qt::Key_PageDown:
      Q_EMIT this->stepped(10);
      break;
    case Qt::Key_0:
      this->Zoom = 1;
      this->Pan = QPointF();
      this->update();
      break;
    default:
      this->Superclass::keyPressEvent(event);
  }
}

void pqLacunaOutlineCanvas::resizeEvent(QResizeEvent* event)
{
  this->Superclass::resizeEvent(event);
  this->update();
}

//------------------------------------------------------------------------------
QString pqLacunaOutlineCanvas::GetHint() const
{
  if (!this->Pending.isEmpty() && this->Tool == Points)
  {
    return this->Pending.size() < 3
      ? tr("Click along the border")
      : tr("Click the first point, or press Enter, to close; Esc: forget");
  }
  switch (this->Tool)
  {
    case Points:
      return this->Outlines.isEmpty()
        ? tr("Click points along the border of the structure")
        : tr("Drag points; Shift+click the line: add one; Ctrl+click: remove");
    case Freehand:
      return tr("Draw around the structure with the left button held");
    default:
      return tr("Click into the structure, or drag a rectangle around it");
  }
}

//------------------------------------------------------------------------------
void pqLacunaOutlineCanvas::paintEvent(QPaintEvent*)
{
  QPainter painter(this);
  painter.fillRect(this->rect(), Qt::black);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setRenderHint(QPainter::SmoothPixmapTransform);
  if (this->Picture.isNull() || !this->Message.isEmpty())
  {
    painter.setPen(Qt::lightGray);
    painter.drawText(
      this->rect().adjusted(12, 12, -12, -12), Qt::AlignCenter | Qt::TextWordWrap, this->Message);
    return;
  }
  const QPointF corner = this->ToWidget({ -0.5, -0.5 });
  const QPointF opposite =
    this->ToWidget({ this->Picture.width() - 0.5, this->Picture.height() - 0.5 });
  painter.drawImage(QRectF(corner, opposite), this->Picture);

  this->DrawOutlines(painter);
  if (!this->Pending.isEmpty())
  {
    this->DrawPending(painter);
  }
  if (!this->Region.isNull())
  {
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(this->Color, 1, Qt::DashLine));
    painter.drawRect(
      QRectF(this->ToWidget(this->Region.topLeft()), this->ToWidget(this->Region.bottomRight())));
  }
  this->DrawTexts(painter);
}

//------------------------------------------------------------------------------
QPainterPath pqLacunaOutlineCanvas::GetPath(const QPolygonF& places, bool isClosed) const
{
  QPainterPath line;
  for (int i = 0; i < places.size(); ++i)
  {
    const QPointF at = this->ToWidget(places[i]);
    i == 0 ? line.moveTo(at) : line.lineTo(at);
  }
  if (isClosed)
  {
    line.closeSubpath();
  }
  return line;
}

//------------------------------------------------------------------------------
void pqLacunaOutlineCanvas::DrawOutlines(QPainter& painter) const
{
  for (const Outline& outline : this->Outlines)
  {
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(Qt::black, 4));
    painter.drawPath(this->GetPath(outline.Curve, true));
    painter.setPen(QPen(outline.Color, outline.IsCurrent ? 2 : 1.4));
    painter.drawPath(this->GetPath(outline.Curve, true));
    painter.setPen(QPen(Qt::black, 1));
    painter.setBrush(outline.Color);
    for (const QPointF& handle : outline.Handles)
    {
      painter.drawEllipse(this->ToWidget(handle), HandleRadius, HandleRadius);
    }
  }
}

//------------------------------------------------------------------------------
void pqLacunaOutlineCanvas::DrawPending(QPainter& painter) const
{
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(this->Color, 2));
  QPainterPath line = this->GetPath(this->Pending, false);
  if (this->Tool == Points)
  {
    line.lineTo(this->Cursor);
  }
  painter.drawPath(line);
  if (this->Tool == Points)
  {
    painter.setBrush(this->Color);
    painter.setPen(QPen(Qt::black, 1));
    for (const QPointF& place : this->Pending)
    {
      painter.drawEllipse(this->ToWidget(place), HandleRadius, HandleRadius);
    }
  }
}

//------------------------------------------------------------------------------
void pqLacunaOutlineCanvas::DrawTexts(QPainter& painter) const
{
  const auto write = [&](int flags, const QString& text)
  {
    const QRect area = this->rect().adjusted(8, 5, -8, -5);
    painter.setPen(Qt::black);
    painter.drawText(area.translated(1, 1), flags, text);
    painter.setPen(Qt::white);
    painter.drawText(area, flags, text);
  };
  write(Qt::AlignTop | Qt::AlignLeft, this->Caption);
  write(Qt::AlignBottom | Qt::AlignHCenter | Qt::TextWordWrap, this->GetHint());
  write(Qt::AlignVCenter | Qt::AlignRight, this->Letters[0]);
  write(Qt::AlignTop | Qt::AlignHCenter, this->Letters[1]);
}
