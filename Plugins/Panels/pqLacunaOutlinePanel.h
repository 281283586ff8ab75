// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The panel in which outlines of a Slice Outliner are drawn.
#ifndef pqLacunaOutlinePanel_h
#define pqLacunaOutlinePanel_h

#include "pqLacunaOutlineCanvas.h"

#include <QDockWidget>
#include <QHash>
#include <QPointer>
#include <QPolygonF>
#include <QTimer>
#include <QVector>

#include "vtkSmartPointer.h"

class QButtonGroup;
class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QSlider;
class QSpinBox;
class QTableWidget;
class QToolButton;
class pqPipelineSource;
class pqView;
class vtkImageData;
class vtkPoints;

/// Opens itself when a Slice Outliner is applied or selected for the first time. What is drawn becomes the filter's properties at
/// once, and a filter Outlined Structures behind it makes surfaces and the table.
class pqLacunaOutlinePanel : public QDockWidget
{
  Q_OBJECT
  typedef QDockWidget Superclass;

public:
  explicit pqLacunaOutlinePanel(QWidget* parent);
  ~pqLacunaOutlinePanel() override;

private Q_SLOTS:
  void FindSource();
  void SourceUpdated();
  void ShowSlice(int slice);
  void Step(int slices);
  void AddOutline(const QPolygonF& points, bool isFreehand);
  void MoveOutline(int shown, const QPolygonF& handles);
  void TraceOutline(const QPointF& place, const QRectF& region);
  void CopyOutline();
  void DeleteOutline();
  void AddStructure();
  void ChooseColor();
  void Rename();
  void Undo();
  void Redo();
  void Save();
  void Load();

private:
  static constexpr int LevelSteps = 1000; ///< of the slider, over the window

  struct Outline
  {
    int Structure; ///< from 1 on
    int Number;
    int Slice;
    QPolygonF Handles;
    bool operator==(const Outline& other) const
    {
      return this->Structure == other.Structure && this->Number == other.Number &&
        this->Slice == other.Slice && this->Handles == other.Handles;
    }
  };
  struct Drawing ///< what Undo brings back
  {
    QVector<Outline> Outlines;
    QStringList Names;
    QVector<QColor> Colors;
  };

  void Build();
  QWidget* BuildTools(); ///< above the picture
  QLayout* BuildStructures(QWidget* box);
  QLayout* BuildToolButtons(QWidget* box, QButtonGroup* tools);
  void BuildLevel(QWidget* box);
  QWidget* BuildResults(); ///< below it
  QLayout* BuildSlices(QWidget* box);
  QLayout* BuildEditing();
  void BuildTable(QWidget* box); ///< and the summary
  QLayout* BuildFiles(QWidget* box);
  void Read();                          ///< the properties
  void Push(const Drawing& drawing);    ///< makes it the properties, and remembers what was
  void Replace(const Drawing& drawing); ///< the same without remembering
  void Follow(pqPipelineSource* surfaces);
  void Write(const Drawing& drawing);
  void ReadPicture();
  void ProposeLevel();
  void ShowPicture();
  void ShowOutlines();
  void ShowStructures();
  void ShowTable();
  void Attach(); ///< a filter of surfaces, and how both are shown
  void LookAtSlice(pqView* view);
  int GetStructure() const;
  static QColor GetOwnColor(int n);
  static int NextNumber(const Drawing& drawing, int structure);
  /// Reads what Save wrote; new structures go into the drawing. Returns what is wrong, or nothing.
  QString ReadOutlines(QString rows, Drawing& drawing, QVector<Outline>& found) const;
  /// Numbers outlines anew. Returns what is wrong, or nothing.
  static QString AddOutlines(QVector<Outline>& found, Drawing& drawing);
  void Tell(const QString& message, bool isReady = false);
  QPolygonF Snapped(const QPolygonF& handles) const;
  QPolygonF ToCanvas(const QPolygonF& places) const; ///< columns and rows to pixels of the picture
  QPolygonF FromCanvas(const QPolygonF& places) const;
  double GetLevel() const;
  void ShowLevel();
  void RetraceLast();
  static void ToPoints(const QPolygonF& places, vtkPoints* points);
  static QPolygonF ToPlaces(vtkPoints* points);

  QPointer<pqPipelineSource> Source;
  QPointer<pqPipelineSource> Surfaces;
  bool IsReady = false;  ///< Source was applied
  bool IsPlaced = false; ///< the camera sees the slice
  Drawing Now;
  struct History
  {
    QVector<Drawing> Before;
    QVector<Drawing> After;
  };
  QHash<pqPipelineSource*, History> Histories;
  struct
  {
    bool IsValid = false;
    QPointF Place; ///< of the canvas
    QRectF Region;
  } LastTrace;                           ///< which a change of the level does again
  QVector<int> Shown;                    ///< indices of the outlines in the picture
  int Slice = 0;                         ///< of the picture
  vtkSmartPointer<vtkImageData> Picture; ///< in columns and rows
  double Window[2] = { 0, 0 };           ///< darkest and brightest
  bool HasWindow = false;
  double LevelRange[2] = { 0, 1 }; ///< of the slider
  double Aspect = 1;
  QString Letters[2];
  bool IsWriting = false;
  QTimer SliceTimer;

  pqLacunaOutlineCanvas* Canvas = nullptr;
  QComboBox* Structures = nullptr;
  QToolButton* ColorButton = nullptr;
  QCheckBox* Snap = nullptr;
  QWidget* LevelRow = nullptr;
  QSlider* Level = nullptr;
  QLabel* LevelNumber = nullptr;
  QSlider* SliceSlider = nullptr;
  QSpinBox* SliceNumber = nullptr;
  QLabel* Summary = nullptr;
  QTableWidget* Table = nullptr;
  QDoubleSpinBox* RegistrationError = nullptr;
  QToolButton* UndoButton = nullptr;
  QToolButton* RedoButton = nullptr;
};
#endif
