// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The window of the ParaView application, for scripts that run in it (lacuna_window.py). Names are
/// those of Qt's objects, wherever they are (a/b: b within a); functions return nothing (0) where there is none.
#include <QAbstractButton>
#include <QAction>
#include <QApplication>
#include <QComboBox>
#include <QEventLoop>
#include <QMainWindow>
#include <QPixmap>
#include <QScreen>
#include <QTest>
#include <QTimer>
#include <QVariant>
#include <QWindow>

#include <algorithm>

namespace
{
QWidget* GetMainWindow()
{
  for (QWidget* widget : QApplication::topLevelWidgets())
  {
    if (qobject_cast<QMainWindow*>(widget))
    {
      return widget;
    }
  }
  return nullptr;
}

// The first one of a name that is seen, or else the first; with slashes one within another.
QObject* Find(const char* path)
{
  QObject* object = GetMainWindow();
  for (const QString& name : QString(path).split('/'))
  {
    const QObjectList found = object ? object->findChildren<QObject*>(name) : QObjectList();
    const auto seen = std::find_if(found.begin(), found.end(),
      [](const QObject* one) { return one->isWidgetType() && one->property("visible").toBool(); });
    object = seen != found.end() ? *seen : found.value(0);
  }
  return object;
}
}

extern "C"
{
  /// Lets the application go on for so many milliseconds.
  void lacuna_wait(int milliseconds)
  {
    QEventLoop loop;
    QTimer::singleShot(milliseconds, &loop, &QEventLoop::quit);
    loop.exec();
  }

  /// A property's value as UTF-8, until the next call.
  const char* lacuna_get(const char* name, const char* property)
  {
    static QByteArray text;
    const QObject* object = Find(name);
    if (!object || object->metaObject()->indexOfProperty(property) < 0)
    {
      return nullptr;
    }
    text = object->property(property).toString().toUtf8();
    return text.constData();
  }

  /// Presses a button or chooses an action, unless it is disabled.
  int lacuna_press(const char* name)
  {
    QObject* object = Find(name);
    auto* button = qobject_cast<QAbstractButton*>(object);
    if (button && button->isEnabled())
    {
      button->click();
      return 1;
    }
    auto* action = qobject_cast<QAction*>(object);
    if (action && action->isEnabled())
    {
      action->trigger();
      return 1;
    }
    return 0;
  }

  /// Chooses what is called so in a list.
  int lacuna_choose(const char* name, const char* text)
  {
    auto* list = qobject_cast<QComboBox*>(Find(name));
    const int index = list ? list->findText(QString::fromUtf8(text)) : -1;
    if (index < 0)
    {
      return 0;
    }
    list->setCurrentIndex(index);
    return 1;
  }

  /// Presses a key, one of Qt::Key, in the main window, and holds it for so many repeats.
  int lacuna_key(int key, int repeats)
  {
    QWidget* window = GetMainWindow();
    if (!window)
    {
      return 0;
    }
    window->activateWindow(); // as no window manager does
    if (!QTest::qWaitForWindowActive(window))
    {
      return 0;
    }
    const auto code = static_cast<Qt::Key>(key);
    QTest::keyPress(window->windowHandle(), code);
    for (int i = 0; i < repeats; ++i)
    {
      lacuna_wait(500); // the toolbar looks at its source five times a second
      qt_handleKeyEvent(window->windowHandle(), QEvent::KeyPress, code, Qt::NoModifier, {}, true);
    }
    QTest::keyRelease(window->windowHandle(), code);
    return 1;
  }

  /// Writes a picture of the main window as it is on the screen.
  int lacuna_save(const char* fileName)
  {
    const QWidget* window = GetMainWindow();
    return window && window->screen()->grabWindow(window->winId()).save(QString::fromUtf8(fileName))
      ? 1
      : 0;
  }

  void lacuna_resize(int width, int height)
  {
    if (QWidget* window = GetMainWindow())
    {
      window->resize(width, height);
    }
  }
}
