// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The picture of a slice, to draw outlines in with the mouse.
#ifndef pqLacunaOutlineCanvas_h
#define pqLacunaOutlineCanvas_h

#include <QColor>
#include <QImage>
#include <QPainterPath>
#include <QPointF>
#include <QPolygonF>
#include <QRectF>
#include <QString>
#include <QVector>
#include <QWidget>

/// Places are (column, row) of the picture; the middle of its first pixel is (0, 0). Row 0 is at the top, as on the
/// screen of a scanner.
class pqLacunaOutlineCanvas : public QWidget
{
  Q_OBJECT
  typedef QWidget Superclass;

public:
  enum Tools
  {
    Points,   ///< a click sets a point
    Freehand, ///< a line is drawn while a button is held
    Trace     ///< a click or a rectangle says what shall be traced
  };

  struct Outline
  {
    QPolygonF Handles;
    QPolygonF Curve;
    QColor Color;
    bool IsCurrent; ///< of the structure that is being drawn
  };

  explicit pqLacunaOutlineCanvas(QWidget* parent);

  /// aspect: height of a pixel by its width. letters: what the right and the upper edge of the picture are in the
  /// patient ("L", "A"), or empty.
  void SetPicture(const QImage& picture, double aspect, const QString letters[2]);
  void SetOutlines(const QVector<Outline>& outlines);
  void SetTool(Tools tool);
  void SetColor(const QColor& color); ///< of what is being drawn
  void SetCaption(const QString& caption);
  void SetMessage(const QString& message); ///< instead of a picture
  void Forget();                           ///< the outline that was begun
  bool HasPending() const { return !this->Pending.isEmpty(); }

  QPointF ToWidget(const QPointF& place) const;
  QSize sizeHint() const override { return { 440, 380 }; }

Q_SIGNALS:
  void drawn(const QPolygonF& points, bool isFreehand);
  void moved(int outline,
    const QPolygonF& handles); ///< points of an outline were moved, added or taken away
  void traceWanted(const QPointF& place, const QRectF& region); ///< an empty region: at the place
  void stepped(int slices);
  void undoWanted(bool isRedo);
  void windowDragged(double level, double width); ///< in parts of the present width

protected:
  bool event(QEvent* event) override;
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

private:
  void Close();
  bool FindHandle(const QPointF& at, int& outline, int& handle) const;
  bool FindCurve(const QPointF& at, int& outline, int& before) const;
  QPointF ToPicture(const QPointF& at) const;
  QString GetHint() const;
  QPainterPath GetPath(const QPolygonF& places, bool isClosed) const; ///< in the widget
  void DrawOutlines(QPainter& painter) const;
  void DrawPending(QPainter& painter) const;
  void DrawTexts(QPainter& painter) const;

  QImage Picture;
  double Aspect = 1;
  QString Letters[2];
  QVector<Outline> Outlines;
  Tools Tool = Points;
  QColor Color = Qt::yellow;
  QString Caption;
  QString Message;
  QPolygonF Pending;
  QPointF Cursor;
  QRectF Region;
  double Zoom = 1; // 1: fits
  QPointF Pan;     // of the picture's middle, widget pixels
  int DraggedOutline = -1;
  int DraggedHandle = -1;
  bool IsDrawing = false;
  bool IsPanning = false;
  bool IsWindowing = false;
  QPointF Last;
};
#endif
