// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// pqLacunaOutlinePanel: outlines in CSV files.
#include "pqLacunaFetch.h"
#include "pqLacunaOutlinePanel.h"

#include "pqPipelineSource.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSMSourceProxy.h"
#include "vtkStringArray.h"

#include <QFile>
#include <QFileDialog>
#include <QMessageBox>
#include <QSaveFile>
#include <QSlider>
#include <QTextStream>

#include <algorithm>
#include <cmath>

namespace
{
// Columns of a file that Save wrote, and where they are in it.
constexpr int NumberOfColumns = 6;
constexpr const char* Wanted[NumberOfColumns] = { "structure", "outline", "slice", "column", "row",
  "handle" };
struct Columns
{
  explicit Columns(const QStringList& titles)
    : Count(titles.size())
    , Color(titles.indexOf("color"))
  {
    for (int c = 0; c < NumberOfColumns; ++c)
    {
      this->At[c] = titles.indexOf(Wanted[c]);
    }
  }
  int Count;
  int At[NumberOfColumns]; // -1: not there
  int Color;               // needs not be there
};

// A row of such a file: a point of an outline.
struct SavedPoint
{
  QString Structure;
  int Outline = 0;
  int Slice = 0;
  QPointF Place; // column, row
  bool IsHandle = false;
  QColor Color; // invalid: none
};

// Takes the name off a row, whose first column it is, with or without quotes.
QString TakeName(QString& row)
{
  QString name;
  if (row.startsWith('"'))
  {
    int end = 1;
    while (end < row.size() && (row[end] != '"' || (end + 1 < row.size() && row[end + 1] == '"')))
    {
      end += row[end] == '"' ? 2 : 1;
    }
    name = row.mid(1, end - 1).replace("\"\"", "\"");
    row = row.mid(end + 1);
  }
  else
  {
    name = row.section(',', 0, 0);
    row = row.mid(name.size());
  }
  return name;
}

// Whether a row has all columns, as finite numbers.
bool ReadPoint(QString row, const Columns& columns, SavedPoint& point)
{
  point.Structure = TakeName(row);
  const QStringList values = row.split(',');
  double number[NumberOfColumns] = { 0, 0, 0, 0, 0, 0 };
  bool isGood = values.size() == columns.Count && columns.At[0] == 0;
  for (int c = 1; c < NumberOfColumns && isGood; ++c)
  {
    number[c] = values[columns.At[c]].toDouble(&isGood);
    isGood = isGood && std::isfinite(number[c]) &&
      (c > 2 || (number[c] == std::floor(number[c]) && std::abs(number[c]) < 1 << 30));
  }
  if (isGood)
  {
    point.Outline = static_cast<int>(number[1]);
    point.Slice = static_cast<int>(number[2]);
    point.Place = { number[3], number[4] };
    point.IsHandle = number[5] != 0;
    point.Color = QColor(columns.Color >= 0 ? values[columns.Color] : QString());
  }
  return isGood;
}
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::Save()
{
  const vtkSmartPointer<vtkDataObject> data = pqLacunaFetch(this->Source->getSourceProxy(), 0);
  auto* lines = vtkPolyData::SafeDownCast(data);
  if (!lines || lines->GetNumberOfLines() == 0)
  {
    QMessageBox::information(this, tr("Save outlines"), tr("There is no outline yet."));
    return;
  }
  QString name =
    QFileDialog::getSaveFileName(this, tr("Save outlines"), "outlines.csv", tr("Outlines (*.csv)"));
  if (name.isEmpty())
  {
    return;
  }
  if (!name.endsWith(".csv", Qt::CaseInsensitive))
  {
    name += ".csv";
  }
  QSaveFile file(name);
  if (!file.open(QIODevice::WriteOnly | QIODevice::Text))
  {
    QMessageBox::critical(
      this, tr("Save outlines"), tr("%1 cannot be written: %2").arg(name, file.errorString()));
    return;
  }
  QString rows;
  QTextStream text(&rows); // written as UTF-8, with whatever version of Qt
  text.setRealNumberPrecision(12);
  text << "structure,outline,slice,column,row,x,y,z,handle,color\n";
  vtkDataArray* pixel = lines->GetPointData()->GetArray("Pixel");
  vtkDataArray* handle = lines->GetPointData()->GetArray("Handle");
  auto* names =
    vtkStringArray::SafeDownCast(lines->GetCellData()->GetAbstractArray("StructureName"));
  vtkDataArray* structures = lines->GetCellData()->GetArray("Structure");
  vtkDataArray* numbers = lines->GetCellData()->GetArray("Outline");
  vtkDataArray* slices = lines->GetCellData()->GetArray("SliceNumber");
  vtkCellArray* cells = lines->GetLines();
  for (vtkIdType cell = 0; cell < cells->GetNumberOfCells(); ++cell)
  {
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    cells->GetCellAtId(cell, count, ids);
    QString structure = QString::fromUtf8(names->GetValue(cell).c_str());
    structure.replace('"', "\"\"");
    const int of = static_cast<int>(structures->GetComponent(cell, 0)) - 1;
    const QString color =
      of >= 0 && of < this->Now.Colors.size() ? this->Now.Colors[of].name() : QString();
    for (vtkIdType i = 0; i + 1 < count; ++i)
    {
      double x[3];
      lines->GetPoint(ids[i], x);
      text << '"' << structure << "\"," << numbers->GetComponent(cell, 0) << ','
           << slices->GetComponent(cell, 0) << ',' << pixel->GetComponent(ids[i], 0) << ','
           << pixel->GetComponent(ids[i], 1) << ',' << x[0] << ',' << x[1] << ',' << x[2] << ','
           << handle->GetComponent(ids[i], 0) << ',' << color << '\n';
    }
  }
  text.flush();
  file.write(rows.toUtf8());
  if (!file.commit())
  {
    QMessageBox::critical(
      this, tr("Save outlines"), tr("%1 cannot be written: %2").arg(name, file.errorString()));
    return;
  }
  const auto without = this->Now.Outlines.size() - cells->GetNumberOfCells();
  if (without > 0)
  {
    QMessageBox::warning(this, tr("Save outlines"),
      tr("%1 outlines are not in the file: their slices have no usable pose, so they have no place "
         "in mm. A "
         "state file keeps them.")
        .arg(without));
  }
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::Load()
{
  const QString name = QFileDialog::getOpenFileName(
    this, tr("Load outlines"), QString(), tr("Outlines of Lacuna (*.csv)"));
  if (name.isEmpty())
  {
    return;
  }
  QFile file(name);
  QString failure;
  Drawing drawing = this->Now;
  QVector<Outline> found;
  if (!file.open(QIODevice::ReadOnly | QIODevice::Text))
  {
    failure = file.errorString();
  }
  else
  {
    failure = this->ReadOutlines(QString::fromUtf8(file.readAll()), drawing, found);
  }
  if (failure.isEmpty())
  {
    failure = AddOutlines(found, drawing);
  }
  if (!failure.isEmpty())
  {
    QMessageBox::critical(this, tr("Load outlines"), tr("%1: %2").arg(name, failure));
    return;
  }
  this->Push(drawing);
}

//------------------------------------------------------------------------------
QString pqLacunaOutlinePanel::ReadOutlines(
  QString rows, Drawing& drawing, QVector<Outline>& found) const
{
  QTextStream text(&rows);
  const Columns columns(text.readLine().split(','));
  for (int c = 0; c < NumberOfColumns; ++c)
  {
    if (columns.At[c] < 0)
    {
      return tr(
        "it has no column '%1'. This panel reads what it saved; Outline Reader (File > Open) reads "
        "outlines of other programs, for the filter Outlined Structures")
        .arg(Wanted[c]);
    }
  }
  for (int line = 2; !text.atEnd(); ++line)
  {
    SavedPoint point;
    if (!ReadPoint(text.readLine(), columns, point))
    {
      return tr("line %1 has not the columns of the first line, as finite numbers").arg(line);
    }
    int n = static_cast<int>(drawing.Names.indexOf(point.Structure));
    if (n < 0)
    {
      n = static_cast<int>(drawing.Names.size());
      drawing.Names.push_back(point.Structure);
      drawing.Colors.push_back(point.Color.isValid() ? point.Color : GetOwnColor(n));
    }
    if (point.Slice < this->SliceSlider->minimum() || point.Slice > this->SliceSlider->maximum())
    {
      return tr("line %1 is of slice %2, which is not there").arg(line).arg(point.Slice);
    }
    if (found.isEmpty() || found.back().Structure != n + 1 || found.back().Number != point.Outline)
    {
      found.push_back({ n + 1, point.Outline, point.Slice, {} });
    }
    if (found.back().Slice != point.Slice)
    {
      return tr("line %1: outline %2 of %3 is in slice %4, too")
        .arg(line)
        .arg(point.Outline)
        .arg(point.Structure)
        .arg(found.back().Slice);
    }
    if (point.IsHandle)
    {
      found.back().Handles.push_back(point.Place);
    }
  }
  return {};
}

//------------------------------------------------------------------------------
QString pqLacunaOutlinePanel::AddOutlines(QVector<Outline>& found, Drawing& drawing)
{
  for (Outline& outline : found)
  {
    if (outline.Handles.size() < 3)
    {
      return tr("an outline in slice %1 has fewer than three points with 'handle' 1")
        .arg(outline.Slice);
    }
    outline.Number = NextNumber(drawing, outline.Structure);
    drawing.Outlines.push_back(outline);
  }
  return {};
}
