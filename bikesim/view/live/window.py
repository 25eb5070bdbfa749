"""A window with OpenGL in it, for a monitor or a projector before the rider."""

import contextlib
import ctypes
import os
import re
from collections.abc import Callable, Iterator
from typing import Any

from bikesim.errors import InputError
from bikesim.view.live.wanted import SMALLEST

_GL_RENDERER = 0x1F01
_TITLE = "bikesim"

Press = Callable[[str], object]


def prepare_opengl() -> None:
    """Before MuJoCo is imported: it loads the OpenGL of a window. Raises InputError."""
    asked = os.environ.get("MUJOCO_GL", "").strip().lower()
    if asked in ("disable", "disabled", "off", "false", "0"):
        raise InputError(f"MUJOCO_GL={asked} forbids OpenGL, without which nothing can be drawn")
    os.environ["MUJOCO_GL"] = "glfw"
    # Of a processor that draws, half the cores stay the ride's.
    os.environ.setdefault("LP_NUM_THREADS", str(max(1, (os.cpu_count() or 1) // 2)))


class Window:
    """One window, its OpenGL current in this thread; F, Esc and Q are its own keys."""

    def __init__(
        self, size: tuple[int, int], monitor: int | None, *, full_screen: bool, press: Press
    ) -> None:
        """`size` in pixels; `monitor` from 1, None: the main one; `press` is told other keys.

        Raises InputError where there is no window system, no OpenGL, or no such monitor.
        """
        import glfw

        self._glfw = glfw
        self._press = press
        with _telling() as told:
            if not glfw.init():
                raise InputError(f"display: no window can be opened here: {_why(told)}")
            try:
                self._monitor = self._chosen(monitor)
                self._window = self._made(size)
                if not self._window:
                    raise InputError(f"display: no window with OpenGL here: {_why(told)}")
            except InputError:
                glfw.terminate()
                raise
        glfw.make_context_current(self._window)
        glfw.swap_interval(1)
        glfw.set_key_callback(self._window, self._on_key)
        self._before_full = self._place()
        self.full_screen = False
        if full_screen:
            self.toggle_full_screen()

    @property
    def closed(self) -> bool:
        """Whether a person wants it closed."""
        return bool(self._glfw.window_should_close(self._window))

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels; zeros while it is an icon."""
        return self._glfw.get_framebuffer_size(self._window)

    @property
    def refresh_rate(self) -> float:
        """Of its monitor [Hz]."""
        mode = self._glfw.get_video_mode(self._monitor)
        return float(mode.refresh_rate or 60) if mode else 60.0

    @property
    def renderer(self) -> str:
        """What its OpenGL calls itself."""
        found: Any = self._glfw.get_proc_address("glGetString")
        address = ctypes.cast(found, ctypes.c_void_p).value
        if address is None:
            return "OpenGL"
        said = ctypes.CFUNCTYPE(ctypes.c_char_p, ctypes.c_uint)(address)(_GL_RENDERER)
        return said.decode(errors="replace") if said else "OpenGL"

    def swap(self) -> None:
        """Shows what was drawn, with the monitor's next picture, and takes the keys."""
        self._glfw.swap_buffers(self._window)
        self._glfw.poll_events()

    def title(self, text: str) -> None:
        self._glfw.set_window_title(self._window, f"{_TITLE}: {text}")

    def close(self) -> None:
        self._glfw.terminate()

    def toggle_full_screen(self) -> None:
        """And back to where it was."""
        glfw = self._glfw
        if self.full_screen:
            nowhere: Any = None
            glfw.set_window_monitor(self._window, nowhere, *self._before_full, 0)
        else:
            self._before_full = self._place()
            mode = glfw.get_video_mode(self._monitor)
            width, height = mode.size
            glfw.set_window_monitor(
                self._window, self._monitor, 0, 0, width, height, mode.refresh_rate
            )
        self.full_screen = not self.full_screen
        glfw.swap_interval(1)
        hidden = glfw.CURSOR_HIDDEN if self.full_screen else glfw.CURSOR_NORMAL
        glfw.set_input_mode(self._window, glfw.CURSOR, hidden)

    def _chosen(self, number: int | None) -> Any:
        monitors = self._glfw.get_monitors()
        if not monitors:
            raise InputError("display: no monitor is connected")
        if number is not None and not 1 <= number <= len(monitors):
            raise InputError(f"--monitor {number}: there are {len(monitors)}, counted from 1")
        return monitors[(number or 1) - 1]

    def _made(self, size: tuple[int, int]) -> Any:
        glfw = self._glfw
        glfw.window_hint(glfw.VISIBLE, glfw.FALSE)
        window = glfw.create_window(*size, _TITLE, None, None)
        if window:
            glfw.set_window_size_limits(window, *SMALLEST, glfw.DONT_CARE, glfw.DONT_CARE)
            x, y, width, height = glfw.get_monitor_workarea(self._monitor)
            left, top = x + max(0, (width - size[0]) // 2), y + max(0, (height - size[1]) // 2)
            glfw.set_window_pos(window, left, top)
            glfw.show_window(window)
        return window

    def _place(self) -> tuple[int, int, int, int]:
        glfw = self._glfw
        return (*glfw.get_window_pos(self._window), *glfw.get_window_size(self._window))

    def _on_key(self, window: Any, key: int, scancode: int, action: int, mods: int) -> None:
        del scancode, mods
        glfw = self._glfw
        if action != glfw.PRESS:
            return
        if key in (glfw.KEY_ESCAPE, glfw.KEY_Q):
            glfw.set_window_should_close(window, True)
        elif key == glfw.KEY_F:
            self.toggle_full_screen()
        elif glfw.KEY_A <= key <= glfw.KEY_Z:
            self._press(chr(key).lower())


@contextlib.contextmanager
def _telling() -> Iterator[list[str]]:
    """What GLFW says of errors meanwhile, in place of warnings."""
    import glfw

    told: list[str] = []

    def hear(code: int, text: bytes | str) -> None:
        del code
        told.append(text.decode(errors="replace") if isinstance(text, bytes) else str(text))

    glfw.ERROR_REPORTING = "ignore"
    glfw.set_error_callback(hear)
    yield told


def _why(told: list[str]) -> str:
    said = re.sub(r"\s+", " ", told[-1]) if told else "GLFW does not say why"
    return said.removeprefix("X11: ")
