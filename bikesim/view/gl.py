"""Which OpenGL there is to draw with."""

import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass

from bikesim.child import child_command
from bikesim.errors import InputError

_INSTALL = "install one, on Debian or Ubuntu: apt install libegl1 libgl1 libgl1-mesa-dri libosmesa6"
_SECONDS = 60.0
_SOFTWARE = re.compile("llvmpipe|softpipe|swrast|software|swiftshader", re.IGNORECASE)
_WORDS = {"egl": "EGL", "osmesa": "OSMesa", "glfw": "GLFW", "cgl": "CGL", "": "OpenGL"}


@dataclass(frozen=True)
class Backend:
    """An OpenGL that works here.

    `name` is what MUJOCO_GL calls it, `renderer` what it calls itself, `largest` the most pixels
    that a picture may have in either direction.
    """

    name: str
    renderer: str
    largest: int

    @property
    def software(self) -> bool:
        """Whether the processor draws."""
        return is_software(self.renderer)

    @property
    def told(self) -> str:
        """In words."""
        how = "in software" if self.software else "on the GPU"
        return f"{_WORDS.get(self.name, self.name)} {how} ({self.renderer})"

    def environment(self, threads: int) -> dict[str, str]:
        """For a process that draws with it, in software with so many threads."""
        return _environment(self.name) | {"LP_NUM_THREADS": str(threads)}


def is_software(renderer: str) -> bool:
    """Whether an OpenGL that calls itself so draws with the processor."""
    return bool(_SOFTWARE.search(renderer))


def find_backend() -> Backend:
    """The first that works of EGL, OSMesa and a display; only MUJOCO_GL where that is set.

    Raises InputError that says what to install.
    """
    asked = os.environ.get("MUJOCO_GL", "").strip().lower()
    if asked in ("disable", "disabled", "off", "false", "0"):
        raise InputError(f"MUJOCO_GL={asked} forbids OpenGL, without which nothing can be drawn")
    why = ""
    for name in (asked,) if asked else _candidates():
        found = _try(name)
        if isinstance(found, Backend):
            return found
        why = why or found
    if asked:
        raise InputError(f"MUJOCO_GL={asked} does not work ({why[:120]}); unset it, or {_INSTALL}")
    raise InputError(f"no OpenGL library works here; {_INSTALL}")


def _candidates() -> tuple[str, ...]:
    if not sys.platform.startswith("linux"):
        return ("",)
    return ("egl", "osmesa", "glfw") if os.environ.get("DISPLAY") else ("egl", "osmesa")


def _try(name: str) -> Backend | str:
    """The backend, or why it does not work."""
    try:
        ran = subprocess.run(
            child_command("bikesim.view.gl_probe"),
            env=_environment(name),
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"it did not answer within {_SECONDS:g} s"
    try:
        told = json.loads(ran.stdout.strip().splitlines()[-1])
    except (IndexError, ValueError):
        return f"it ended with status {ran.returncode}"
    if "error" in told:
        return told["error"]
    return Backend(name, told["renderer"], told["largest"])


def _environment(name: str) -> dict[str, str]:
    # MuJoCo sets PyOpenGL's platform itself, and refuses another one that it finds.
    kept = {key: value for key, value in os.environ.items() if key != "PYOPENGL_PLATFORM"}
    return kept | {"MUJOCO_GL": name}
