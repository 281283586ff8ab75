// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class pqLacunaSliders
 * @brief sliders at the top of the Properties panel whose effect is seen while they are dragged
 *
 * For numbers that one finds by looking: the level of a surface, the margin of a hole filler, the place
 * of a cut. They are there for what is selected and was applied; other changes still wait for Apply.
 */
#ifndef pqLacunaSliders_h
#define pqLacunaSliders_h

#include <QVector>
#include <QWidget>

class QLabel;
class QSlider;
class QVBoxLayout;
class pqPipelineSource;
class vtkSMProperty;
class vtkSMProxy;

class pqLacunaSliders : public QWidget
{
  Q_OBJECT
  typedef QWidget Superclass;

public:
  /// Puts itself at the top of ParaView's Properties panel, where there is one.
  pqLacunaSliders(QWidget* window);
  ~pqLacunaSliders() override;

private:
  struct Row
  {
    vtkSMProxy* Proxy;
    vtkSMProperty* Property;
    double Low, High;
    QSlider* Slider;
    QLabel* Value;
  };

  void Show(pqPipelineSource* source);
  void Add(vtkSMProxy* proxy, const char* property, const QString& text, double low, double high);
  void Follow(const Row& row); ///< the property, when it was changed elsewhere
  void Drag(const Row& row, int step);

  QVBoxLayout* Rows;
  pqPipelineSource* Source = nullptr;
};
#endif
