// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The window of the ParaView application, for scripts that run in it (lacuna_window.py). Names are
/// those of Qt's objects, wherever they are (a/b: b within a), in the dialog that is open or else in the
/// main window; functions return nothing (0) where there is none.
#include "lacunaWindowWords.h"

#include <QAbstractButton>
#include <QAbstractItemModel>
#include <QAbstractItemView>
#include <QAction>
#include <QApplication>
#include <QComboBox>
#include <QDialog>
#include <QDockWidget>
#include <QEventLoop>
#include <QImage>
#include <QItemSelectionModel>
#include <QLabel>
#include <QLineEdit>
#include <QMainWindow>
#include <QMenu>
#include <QMenuBar>
#include <QPainter>
#include <QPixmap>
#include <QPointer>
#include <QScreen>
#include <QTest>
#include <QTextEdit>
#include <QTimer>
#include <QVariant>
#include <QWindow>

#include <algorithm>

using namespace lacunaWindow;

namespace
{
QMainWindow* GetMainWindow()
{
  for (QWidget* widget : QApplication::topLevelWidgets())
  {
    if (auto* window = qobject_cast<QMainWindow*>(widget))
    {
      return window;
    }
  }
  return nullptr;
}

// What has no name: a button by its words, or a widget by its class.
QObject* FindNameless(const QObject* parent, const QString& text)
{
  const auto widgets = parent->findChildren<QWidget*>();
  const auto found = std::find_if(widgets.begin(), widgets.end(),
    [&](const QWidget* one)
    {
      const auto* button = qobject_cast<const QAbstractButton*>(one);
      return one->isVisible() &&
        (text == one->metaObject()->className() || (button && Plain(button->text()) == text));
    });
  return found != widgets.end() ? *found : nullptr;
}

// The first one of a name that is seen, or else the first; with slashes one within another.
QObject* Find(const char* path)
{
  QObject* object = QApplication::activeModalWidget();
  if (!object)
  {
    object = GetMainWindow();
  }
  for (const QString& name : QString::fromUtf8(path).split('/', Qt::SkipEmptyParts))
  {
    const QObjectList found = object ? object->findChildren<QObject*>(name) : QObjectList();
    const auto seen = std::find_if(found.begin(), found.end(),
      [](const QObject* one) { return one->isWidgetType() && one->property("visible").toBool(); });
    object = seen != found.end() ? *seen
      : !found.isEmpty()         ? found[0]
      : object                   ? FindNameless(object, name)
                                 : nullptr;
  }
  return object;
}

// A child of a child by their names: the Python shell has a console, too.
QWidget* FindWithin(const QWidget* window, const char* part, const char* name)
{
  const auto* parent = window ? window->findChild<QWidget*>(part) : nullptr;
  return parent ? parent->findChild<QWidget*>(name) : nullptr;
}

// An action by the words of the menus, as "Filters/Lacuna/Mirror".
QAction* FindAction(const char* path)
{
  QMainWindow* window = GetMainWindow();
  QWidget* menu = window ? window->menuBar() : nullptr;
  QAction* action = nullptr;
  for (const QString& text : QString::fromUtf8(path).split('/'))
  {
    if (auto* popup = qobject_cast<QMenu*>(menu))
    {
      emit popup->aboutToShow(); // fills it, and greys out what has no fitting input
    }
    const QList<QAction*> actions = menu ? menu->actions() : QList<QAction*>();
    const auto found = std::find_if(actions.begin(), actions.end(),
      [&](const QAction* one) { return Plain(one->text()) == text; });
    action = found != actions.end() ? *found : nullptr;
    menu = action ? action->menu() : nullptr;
  }
  return action;
}

// Dialogs hold up whoever has opened them. So what is to be done in one is a function that is called
// when it is there; one that nobody expects is closed, and told of.
using Handler = void (*)();
Handler handler = nullptr;
Handler ticked = nullptr; // called again and again, and sees to dialogs itself
QPointer<QWidget> handled;
QByteArray unexpected;

void CloseDialog(QWidget* dialog)
{
  QStringList words{ dialog->windowTitle() };
  for (const QLabel* label : dialog->findChildren<QLabel*>())
  {
    words << label->text();
  }
  unexpected += words.join(" ").toUtf8() + "\n";
  if (auto* box = qobject_cast<QDialog*>(dialog))
  {
    box->reject();
  }
  else
  {
    dialog->close();
  }
}

void WatchDialogs()
{
  QTimer::singleShot(50, qApp, &WatchDialogs);
  static int turns = 0;
  QWidget* dialog = QApplication::activeModalWidget();
  if (!dialog || dialog == handled || ticked)
  {
    turns = 0;
  }
  else if (handler)
  {
    handled = dialog;
    const Handler call = handler;
    handler = nullptr;
    call();
  }
  else if (++turns == 20)
  {
    CloseDialog(dialog);
  }
}

Seen clicked; // found last

void Tick()
{
  QTimer::singleShot(50, qApp, &Tick);
  if (ticked)
  {
    ticked();
  }
}

// The part of the screen that the main window takes, with what lies over it.
QImage Grab()
{
  const QMainWindow* window = GetMainWindow();
  const QRect area = window ? window->geometry() : QRect();
  return window ? window->screen()
                    ->grabWindow(0, area.x(), area.y(), area.width(), area.height())
                    .toImage()
                    .convertToFormat(QImage::Format_RGB32)
                : QImage();
}

void Describe(const QObject* object, int depth, QByteArray& text)
{
  const auto* widget = qobject_cast<const QWidget*>(object);
  if (widget ? widget->isVisible() : object->inherits("QAction"))
  {
    text += QByteArray(2 * depth, ' ') + object->metaObject()->className() + " " +
      object->objectName().toUtf8() + "\n";
    for (const QObject* child : object->children())
    {
      Describe(child, depth + 1, text);
    }
  }
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

  /// From now on dialogs that nobody expects are closed.
  void lacuna_watch()
  {
    WatchDialogs();
  }

  /// Calls the function once when a dialog has come up; null: none is expected.
  void lacuna_expect(Handler function)
  {
    handler = function;
  }

  /// The words of dialogs that nobody expected; until the next call.
  const char* lacuna_unexpected()
  {
    static QByteArray text;
    text = unexpected;
    unexpected.clear();
    return text.constData();
  }

  /// Closes the dialog that is open.
  void lacuna_reject()
  {
    if (QWidget* dialog = QApplication::activeModalWidget())
    {
      dialog->close();
    }
  }

  /// What the window Output Messages holds, until the next call. Closes it: since ParaView 5.13 it floats over the view.
  const char* lacuna_messages()
  {
    static QByteArray text;
    const QMainWindow* window = GetMainWindow();
    auto* console = FindWithin(window, "outputWidgetDock", "consoleWidget");
    const auto* edit = console ? console->findChild<QTextEdit*>() : nullptr;
    text = edit ? edit->toPlainText().trimmed().toUtf8() : "there is no window Output Messages";
    for (QWidget* part = console; part; part = part->parentWidget())
    {
      if (auto* dock = qobject_cast<QDockWidget*>(part))
      {
        dock->close();
        break;
      }
    }
    return text.constData();
  }

  /// Classes and names of an object and of what is seen in it; until the next call.
  const char* lacuna_describe(const char* name)
  {
    static QByteArray text;
    const QObject* object = Find(name);
    text.clear();
    if (object)
    {
      Describe(object, 0, text);
    }
    return text.constData();
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

  /// Whether the menus have an action: 0 no, 1 greyed out, 2 yes.
  int lacuna_menu_has(const char* path)
  {
    const QAction* action = FindAction(path);
    return !action ? 0 : action->isEnabled() ? 2 : 1;
  }

  /// Chooses an action by the words of the menus, unless it is disabled.
  int lacuna_menu(const char* path)
  {
    QAction* action = FindAction(path);
    if (!action || !action->isEnabled())
    {
      return 0;
    }
    action->trigger();
    return 1;
  }

  /// The entries of a list, one a line; until the next call.
  const char* lacuna_entries(const char* name)
  {
    static QByteArray text;
    const QObject* object = Find(name);
    const auto* box = qobject_cast<const QComboBox*>(object);
    const auto* selection = object ? object->findChild<QItemSelectionModel*>() : nullptr;
    const QAbstractItemModel* model = box ? box->model() : selection ? selection->model() : nullptr;
    text.clear();
    for (int row = 0; model && row < model->rowCount(); ++row)
    {
      text += model->index(row, 0).data().toString().toUtf8() + "\n";
    }
    return text.constData();
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

  /// Selects what is called so in a list or tree; ParaView's own trees are no QAbstractItemView.
  int lacuna_select(const char* name, const char* text)
  {
    const QObject* view = Find(name);
    auto* selection = view ? view->findChild<QItemSelectionModel*>() : nullptr;
    const QAbstractItemModel* model = selection ? selection->model() : nullptr;
    const QModelIndexList found = model
      ? model->match(model->index(0, 0), Qt::DisplayRole, QString::fromUtf8(text), 1,
          Qt::MatchExactly | Qt::MatchRecursive)
      : QModelIndexList();
    if (found.isEmpty())
    {
      return 0;
    }
    selection->setCurrentIndex(found[0], QItemSelectionModel::ClearAndSelect);
    return 1;
  }

  /// Types a text into a field instead of what is there.
  int lacuna_type(const char* name, const char* text)
  {
    auto* field = qobject_cast<QLineEdit*>(Find(name));
    if (!field || !field->isEnabled() || !field->isVisible())
    {
      return 0;
    }
    field->window()->activateWindow(); // as no window manager does
    field->setFocus();
    field->selectAll();
    QTest::keyClick(field, Qt::Key_Delete);
    QTest::keyClicks(field, QString::fromUtf8(text));
    QTest::keyClick(field, Qt::Key_Tab);
    return 1;
  }

  /// Puts text into a field at once, as from the clipboard: of any language, and without completions.
  int lacuna_paste(const char* name, const char* text)
  {
    auto* field = qobject_cast<QLineEdit*>(Find(name));
    if (!field || !field->isEnabled() || !field->isVisible())
    {
      return 0;
    }
    field->selectAll();
    field->insert(QString::fromUtf8(text));
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

  /// The left mouse button at a place of a widget, in pixels from its upper left corner. action: 0
  /// pressed, 1 moved there while pressed, 2 released, 3 moved there without it. It goes to the window,
  /// which finds who gets it, as it does with a real mouse.
  int lacuna_mouse(const char* name, int x, int y, int action)
  {
    auto* widget = qobject_cast<QWidget*>(Find(name));
    if (!widget)
    {
      return 0;
    }
    QWidget* window = widget->window();
    const QPoint place = widget->mapTo(window, QPoint(x, y));
    const bool held = action < 2;
    const bool moved = action % 2 == 1;
    static int time = 1000;
    time += 600; // more than a double click
    qt_handleMouseEvent(window->windowHandle(), place, window->mapToGlobal(place),
      held ? Qt::LeftButton : Qt::NoButton, moved ? Qt::NoButton : Qt::LeftButton,
      moved    ? QEvent::MouseMove
        : held ? QEvent::MouseButtonPress
               : QEvent::MouseButtonRelease,
      Qt::NoModifier, time);
    return 1;
  }

  /// Writes a picture of a widget, "" for the whole window, as it is on the screen.
  int lacuna_save(const char* name, const char* fileName)
  {
    auto* widget = qobject_cast<QWidget*>(Find(name));
    if (!widget)
    {
      return 0;
    }
    QWidget* window = widget->window();
    const QPoint corner = widget->mapTo(window, QPoint(0, 0));
    return window->screen()
             ->grabWindow(
               window->winId(), corner.x(), corner.y(), widget->width(), widget->height())
             .save(QString::fromUtf8(fileName))
      ? 1
      : 0;
  }

  /// Calls the function every 50 ms from whatever event loop runs, those of dialogs too; null: no more.
  void lacuna_every(Handler function)
  {
    static bool runs = false;
    ticked = function;
    QApplication::setCursorFlashTime(0); // a cursor that blinks would be a change on the screen
    if (function && !runs)
    {
      runs = true;
      Tick();
    }
  }

  /// Looks for words on the screen: on menus, buttons, tabs, rows, closed lists and labels, or the words of an icon; a name with a slash is Qt's, for
  /// an icon without words. 0: they are nowhere.
  int lacuna_see(const char* words)
  {
    const QString wanted = QString::fromUtf8(words);
    clicked = {};
    if (wanted.contains('/'))
    {
      auto* widget = qobject_cast<QWidget*>(Find(words));
      if (widget && widget->isVisible() && widget->isEnabled())
      {
        clicked = { widget, widget->rect().center() };
      }
    }
    else if (QWidget* popup = QApplication::activePopupWidget())
    {
      clicked = FindSeen(popup, wanted);
    }
    else if (QWidget* dialog = QApplication::activeModalWidget())
    {
      clicked = FindSeen(dialog, wanted);
    }
    else
    {
      for (QWidget* window : QApplication::topLevelWidgets())
      {
        if (!clicked.Widget && window->isVisible())
        {
          clicked = FindSeen(window, wanted);
        }
      }
    }
    return clicked.Widget ? 1 : 0;
  }

  /// The mouse at what lacuna_see found; actions as those of lacuna_mouse. The event loop brings it there later.
  int lacuna_seen(int action)
  {
    if (!clicked.Widget || !clicked.Widget->window()->windowHandle())
    {
      return 0;
    }
    QWidget* window = clicked.Widget->window();
    const QPoint place = clicked.Widget->mapTo(window, clicked.Place);
    static int time = 1000000;
    time += 600; // more than a double click
    const Qt::MouseButtons held = action == 0 ? Qt::LeftButton : Qt::NoButton;
    const Qt::MouseButton button = action == 3 ? Qt::NoButton : Qt::LeftButton;
    const QEvent::Type type = action == 3 ? QEvent::MouseMove
      : action == 0                       ? QEvent::MouseButtonPress
                                          : QEvent::MouseButtonRelease;
    // not at once: whoever is called may open a dialog, and return when that is closed
    QTimer::singleShot(0, window,
      [window, place, held, button, type, now = time]
      {
        qt_handleMouseEvent(window->windowHandle(), place, window->mapToGlobal(place), held, button,
          type, Qt::NoModifier, now);
      });
    return 1;
  }

  /// Types a text where the cursor is.
  int lacuna_keys(const char* text)
  {
    QWidget* dialog = QApplication::activeModalWidget();
    if (dialog)
    {
      dialog->activateWindow(); // as no window manager does
    }
    QWidget* field =
      dialog && dialog->focusWidget() ? dialog->focusWidget() : QApplication::focusWidget();
    if (!field)
    {
      return 0;
    }
    QTest::keyClicks(field, QString::fromUtf8(text));
    return 1;
  }

  /// Whether the screen has changed since the last call.
  int lacuna_changed()
  {
    static QImage before;
    const QImage now = Grab();
    const bool changed = now != before;
    before = now;
    return changed ? 1 : 0;
  }

  /// Writes a picture of the screen; number > 0: with a ring of this number around what lacuna_see found.
  int lacuna_picture(const char* fileName, int number)
  {
    QImage picture = Grab();
    const QMainWindow* window = GetMainWindow();
    if (number > 0 && clicked.Widget && window)
    {
      const QPoint place =
        clicked.Widget->mapToGlobal(clicked.Place) - window->geometry().topLeft();
      QPainter painter(&picture);
      painter.setRenderHint(QPainter::Antialiasing);
      painter.setPen(QPen(Qt::white, 2));
      painter.setBrush(QColor(216, 50, 31));
      const QPoint aside(
        std::min(place.x() + 26, picture.width() - 20), std::max(place.y() - 4, 18));
      painter.drawEllipse(aside, 15, 15);
      QFont font = painter.font();
      font.setPixelSize(18);
      font.setBold(true);
      painter.setFont(font);
      painter.drawText(
        QRect(aside.x() - 15, aside.y() - 15, 30, 30), Qt::AlignCenter, QString::number(number));
      painter.setBrush(Qt::NoBrush);
      painter.setPen(QPen(QColor(216, 50, 31), 3));
      painter.drawEllipse(place, 9, 9);
    }
    return picture.save(QString::fromUtf8(fileName)) ? 1 : 0;
  }

  /// All words that are seen now, one line for each widget; until the next call.
  const char* lacuna_words()
  {
    static QByteArray text;
    text.clear();
    for (QWidget* widget : QApplication::allWidgets())
    {
      if (!widget->isVisible() || widget->visibleRegion().isEmpty())
      {
        continue;
      }
      QString words;
      const auto* view = qobject_cast<const QAbstractItemView*>(widget);
      if (const auto* edit = qobject_cast<const QTextEdit*>(widget))
      {
        words = edit->toPlainText();
      }
      else if (const auto* field = qobject_cast<const QLineEdit*>(widget))
      {
        words = field->text();
      }
      else if (view && view->model())
      {
        for (const QModelIndex& index : view->model()->match(view->model()->index(0, 0),
               Qt::DisplayRole, "*", -1, Qt::MatchWildcard | Qt::MatchRecursive))
        {
          QStringList row;
          for (int column = 0; column < view->model()->columnCount(index.parent()); ++column)
          {
            row << index.sibling(index.row(), column).data().toString();
          }
          words += row.join(" | ") + "\n";
        }
      }
      else
      {
        const int which = widget->metaObject()->indexOfProperty("text");
        words = which >= 0 ? Words(widget->property("text").toString()) : QString();
      }
      text += words.isEmpty() ? QByteArray() : words.toUtf8() + "\n";
    }
    return text.constData();
  }

  void lacuna_resize(int width, int height)
  {
    if (QWidget* window = GetMainWindow())
    {
      window->resize(width, height);
    }
  }
}
