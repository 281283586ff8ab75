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
  const auto fail = [&](const QString& why)
  { QMessageBox::critical(this, tr("Load outlines"), tr("%1: %2").arg(name, why)); };
  if (!file.open(QIODevice::ReadOnly | QIODevice::Text))
  {
    fail(file.errorString());
    return;
  }
  QString rows = QString::fromUtf8(file.readAll());
  QTextStream text(&rows);
  const QStringList titles = text.readLine().split(',');
  int at[7];
  const char* const wanted[6] = { "structure", "outline", "slice", "column", "row", "handle" };
  at[6] = titles.indexOf("color"); // needs not be there
  for (int c = 0; c < 6; ++c)
  {
    at[c] = titles.indexOf(wanted[c]);
    if (at[c] < 0)
    {
      fail(tr(
        "it has no column '%1'. This panel reads what it saved; Outline Reader (File > Open) reads "
        "outlines of other programs, for the filter Outlined Structures")
             .arg(wanted[c]));
      return;
    }
  }
  Drawing drawing = this->Now;
  QVector<Outline> found;
  int line = 1;
  while (!text.atEnd())
  {
    ++line;
    QString row = text.readLine();
    // the name is the first column, in quotes
    QString structure;
    if (row.startsWith('"'))
    {
      int end = 1;
      while (end < row.size() && (row[end] != '"' || (end + 1 < row.size() && row[end + 1] == '"')))
      {
        end += row[end] == '"' ? 2 : 1;
      }
      structure = row.mid(1, end - 1).replace("\"\"", "\"");
      row = row.mid(end + 1);
    }
    else
    {
      structure = row.section(',', 0, 0);
      row = row.mid(structure.size());
    }
    const QStringList values = row.split(',');
    double number[6] = { 0, 0, 0, 0, 0, 0 };
    bool isGood = values.size() == titles.size() && at[0] == 0;
    for (int c = 1; c < 6 && isGood; ++c)
    {
      number[c] = values[at[c]].toDouble(&isGood);
      isGood = isGood && std::isfinite(number[c]) &&
        (c > 2 || (number[c] == std::floor(number[c]) && std::abs(number[c]) < 1 << 30));
    }
    if (!isGood)
    {
      fail(tr("line %1 has not the columns of the first line, as finite numbers").arg(line));
      return;
    }
    int n = static_cast<int>(drawing.Names.indexOf(structure));
    if (n < 0)
    {
      n = static_cast<int>(drawing.Names.size());
      drawing.Names.push_back(structure);
      const QColor color(at[6] >= 0 ? values[at[6]] : QString());
      drawing.Colors.push_back(color.isValid() ? color : GetOwnColor(n));
    }
    const int outline = static_cast<int>(number[1]);
    const int slice = static_cast<int>(number[2]);
    if (slice < this->SliceSlider->minimum() || slice > this->SliceSlider->maximum())
    {
      fail(tr("line %1 is of slice %2, which is not there").arg(line).arg(slice));
      return;
    }
    if (found.isEmpty() || found.back().Structure != n + 1 || found.back().Number != outline)
    {
      found.push_back({ n + 1, outline, slice, {} });
    }
    if (found.back().Slice != slice)
    {
      fail(tr("line %1: outline %2 of %3 is in slice %4, too")
             .arg(line)
             .arg(outline)
             .arg(structure)
             .arg(found.back().Slice));
      return;
    }
    if (number[5] != 0)
    {
      found.back().Handles.push_back({ number[3], number[4] });
    }
  }
  for (Outline& outline : found)
  {
    if (outline.Handles.size() < 3)
    {
      fail(tr("an outline in slice %1 has fewer than three points with 'handle' 1")
             .arg(outline.Slice));
      return;
    }
    int number = 0;
    for (const Outline& other : drawing.Outlines)
    {
      number = other.Structure == outline.Structure ? std::max(number, other.Number + 1) : number;
    }
    outline.Number = number;
    drawing.Outlines.push_back(outline);
  }
  this->Push(drawing);
}
