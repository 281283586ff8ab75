# SPDX-License-Identifier: BSD-3-Clause
"""Clicks at words that are seen in ParaView's window, as a user makes them, with a picture and the seconds of each.

    def job(screen):
        yield from screen.click("File")
        yield from screen.click("Open")
        yield from screen.click("skull.mha")

    Screen(window, folder).run(job)

A job is a generator: it goes on between the events of the window, also while a dialog is open. The mouse goes to the place of the
words, so that what is hidden, greyed out or not yet there cannot be clicked.
"""
import ctypes
import json
import os
import time

STILL = 0.8  # s without a change on the screen: it is ready
WINDOW = 1440, 900  # a small laptop
PRESS, DRAG, RELEASE, MOVE = range(4)


class Screen:
    """folder: where the pictures go, 01.png and so on, with clicks.json; none without."""

    def __init__(self, window, folder=None):
        self.window, self.library, self.folder = window, window.library, folder
        self.library.lacuna_words.restype = ctypes.c_char_p
        self.clicks = []  # [words, seconds until the screen rests]
        self.job = self.failure = None
        self.is_busy = False
        self.call = ctypes.CFUNCTYPE(None)(self.tick)
        if folder:
            os.makedirs(folder, exist_ok=True)

    def run(self, job):
        """Does a job, to its end."""
        self.job = job(self)
        self.library.lacuna_every(self.call)
        while self.job:
            self.library.lacuna_wait(50)
        self.library.lacuna_every(None)
        if self.failure:
            raise self.failure

    def tick(self):
        if self.is_busy or not self.job:
            return
        self.is_busy = True
        try:
            next(self.job)
        except StopIteration:
            self.job = None
        except BaseException as error:  # not through Qt
            self.failure, self.job = error, None
            self.library.lacuna_picture(os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "clicks-failed.png").encode(), 0)
            self.library.lacuna_reject()
        self.is_busy = False

    def click(self, words, name=None):
        """Clicks at words. name: what the list of clicks calls them, such as an icon's words or a file's."""
        yield from self.until(f"'{words}' is to be seen", lambda: self.library.lacuna_see(words.encode()), 30)
        self.clicks.append([name or words, 0])
        self.picture()
        assert self.library.lacuna_seen(MOVE), words
        yield
        begin = self.begin()
        for action in (PRESS, RELEASE):
            assert self.library.lacuna_seen(action), words
            yield
        yield from self.rest(begin)

    def type(self, text):
        """Types where the cursor is. It counts as a click."""
        self.clicks.append([f"type {text}", 0])
        self.picture(mark=False)
        begin = self.begin()
        assert self.library.lacuna_keys(text.encode()), "there is no cursor"
        yield from self.rest(begin)

    def slide(self, widget, name):
        """Drags the handle of a slider a quarter of its length to the left."""
        width, height = (float(self.window.get(widget, attribute)) for attribute in ("width", "height"))
        self.clicks.append([name, 0])
        self.picture(mark=False)
        begin = self.begin()
        yield from self.mouse(widget, [(0.5 * width, height / 2), (0.25 * width, height / 2)])
        yield from self.rest(begin)

    def mouse(self, widget, way):
        for (x, y), action in zip([way[0], way[0], way[1], way[1]], (MOVE, PRESS, DRAG, RELEASE)):
            assert self.library.lacuna_mouse(widget.encode(), round(x), round(y), action), widget
            yield

    def sees(self, words):
        """Whether there is something to click with these words."""
        return bool(self.library.lacuna_see(words.encode()))

    def words_of(self, part):
        """The lines that have a part in them, of all that is seen."""
        return "\n".join(line for line in self.words().splitlines() if part in line)

    def begin(self):
        self.library.lacuna_changed()
        return time.monotonic()

    def rest(self, begin):
        """Until the screen has not changed for a while; the last click took until its last change."""
        last, ticks = begin, 0
        while time.monotonic() - last < STILL or ticks < 8:
            yield
            ticks += 1
            if self.library.lacuna_changed():
                last, ticks = time.monotonic(), 0
        self.clicks[-1][1] = last - begin

    def until(self, what, condition, seconds):
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, f"not within {seconds} s: {what}; seen are:\n{self.words()}"
            yield

    def words(self):
        """All words that are seen, a line for each."""
        return self.library.lacuna_words().decode()

    def picture(self, mark=True):
        """Of the screen, with the number of the click that comes."""
        if self.folder:
            number = len(self.clicks)
            path = os.path.join(self.folder, f"{number:02}.png")
            assert self.library.lacuna_picture(path.encode(), number if mark else 0), path

    def end(self):
        """The picture after the last click, and the list of clicks."""
        if self.folder:
            assert self.library.lacuna_picture(os.path.join(self.folder, "end.png").encode(), 0)
            with open(os.path.join(self.folder, "clicks.json"), "w", encoding="utf-8") as file:
                json.dump(self.clicks, file, indent=1)
