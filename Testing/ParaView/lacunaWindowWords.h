// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What is on the screen, by its words.
#ifndef lacunaWindowWords_h
#define lacunaWindowWords_h

#include <QPoint>
#include <QPointer>
#include <QString>
#include <QWidget>

namespace lacunaWindow
{
struct Seen
{
  QPointer<QWidget> Widget; ///< that takes the click
  QPoint Place;             ///< in it
};

/// Without the marks of keys and dots of menus.
QString Plain(const QString& text);

/// As they are read: without marks, keys and formats.
QString Words(const QString& text);

/// What is called so within a window: an entry, a button, a tab, a row; else an icon of this name, or a label.
Seen FindSeen(QWidget* top, const QString& wanted);
}
#endif
