// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaWindowWords.h"

#include <QAbstractButton>
#include <QAbstractItemModel>
#include <QAbstractItemView>
#include <QAction>
#include <QComboBox>
#include <QLabel>
#include <QMenu>
#include <QMenuBar>
#include <QTabBar>
#include <QTextDocument>

#include <algorithm>

namespace lacunaWindow
{
QString Plain(const QString& text)
{
  return QString(text).remove('&').remove(QString::fromUtf8("\u2026"));
}

QString Words(const QString& text)
{
  QString words = Plain(text.section('\t', 0, 0)).remove("...").simplified();
  if (Qt::mightBeRichText(text))
  {
    QTextDocument document;
    document.setHtml(text);
    words = document.toPlainText().simplified();
  }
  return words;
}

namespace
{
bool Is(const QString& text, const QString& wanted)
{
  return !text.isEmpty() && Words(text) == wanted;
}

Seen FindRow(QAbstractItemView* view, const QString& wanted)
{
  const QAbstractItemModel* model = view->model();
  if (!model)
  {
    return {};
  }
  for (int column = 0; column < model->columnCount(view->rootIndex()); ++column)
  {
    const QModelIndexList found = model->match(model->index(0, column, view->rootIndex()),
      Qt::DisplayRole, wanted, -1, Qt::MatchFixedString | Qt::MatchRecursive);
    for (const QModelIndex& index : found)
    {
      view->scrollTo(index);
      const QRect area = view->visualRect(index);
      if (area.isValid() && view->viewport()->rect().intersects(area))
      {
        return { view->viewport(),
          { std::min(area.left() + 40, area.center().x()), area.center().y() } };
      }
    }
  }
  return {};
}

Seen FindMenuEntry(QWidget* menu, const QString& wanted)
{
  for (QAction* action : menu->actions())
  {
    if (!Is(action->text(), wanted) || !action->isEnabled())
    {
      continue;
    }
    auto* bar = qobject_cast<QMenuBar*>(menu);
    auto* popup = qobject_cast<QMenu*>(menu);
    const QRect area = bar ? bar->actionGeometry(action)
      : popup              ? popup->actionGeometry(action)
                           : QRect();
    return { menu, area.center() };
  }
  return {};
}

}

Seen FindSeen(QWidget* top, const QString& wanted)
{
  QList<QWidget*> widgets = top->findChildren<QWidget*>();
  widgets.prepend(top);
  Seen other; // an icon whose words come up when the mouse rests on it, or a label
  for (QWidget* widget : widgets)
  {
    if (!widget->isVisible() || !widget->isEnabled() || widget->visibleRegion().isEmpty())
    {
      continue;
    }
    const QPoint center = widget->rect().center();
    const auto* button = qobject_cast<QAbstractButton*>(widget);
    const auto* list = qobject_cast<QComboBox*>(widget);
    if ((button && Is(button->text(), wanted)) || (list && Is(list->currentText(), wanted)))
    {
      return { widget, center };
    }
    if (auto* tabs = qobject_cast<QTabBar*>(widget))
    {
      for (int tab = 0; tab < tabs->count(); ++tab)
      {
        if (Is(tabs->tabText(tab), wanted))
        {
          return { tabs, tabs->tabRect(tab).center() };
        }
      }
    }
    Seen found;
    if (qobject_cast<QMenu*>(widget) || qobject_cast<QMenuBar*>(widget))
    {
      found = FindMenuEntry(widget, wanted);
    }
    else if (auto* view = qobject_cast<QAbstractItemView*>(widget))
    {
      found = FindRow(view, wanted);
    }
    if (found.Widget)
    {
      return found;
    }
    const auto* label = qobject_cast<QLabel*>(widget);
    if (!other.Widget &&
      ((button && Is(button->toolTip(), wanted)) || (label && Is(label->text(), wanted))))
    {
      other = { widget, center };
    }
  }
  return other;
}
}
