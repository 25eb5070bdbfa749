"""Finding an OpenGL, in processes of their own."""

from pathlib import Path

import pytest

from bikesim.errors import InputError
from bikesim.view.gl import Backend, find_backend


def test_finds_one_that_draws_large_pictures(backend: Backend):
    assert backend.largest >= 4096
    assert backend.renderer in backend.told


def test_modules_of_the_current_folder_are_not_its_own(tmp_path: Path, monkeypatch, backend):
    (tmp_path / "bikesim.py").write_text("raise SystemExit(1)\n")
    monkeypatch.chdir(tmp_path)
    assert find_backend() == backend


def test_takes_the_one_that_the_user_asks_for(monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "osmesa")
    found = find_backend()
    assert (found.name, found.software) == ("osmesa", True)


def test_a_display_that_is_not_there_is_one_line(monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "glfw")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(InputError, match="MUJOCO_GL=glfw does not work"):
        find_backend()


def test_a_name_that_mujoco_does_not_know_is_one_line(monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "nonsense")
    with pytest.raises(InputError, match="invalid value for environment variable MUJOCO_GL"):
        find_backend()


def test_a_user_who_wants_none_gets_none(monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "disable")
    with pytest.raises(InputError, match="forbids OpenGL"):
        find_backend()


@pytest.fixture
def no_library(monkeypatch, tmp_path: Path) -> None:
    """The libraries cannot be loaded: what loads them fails as it does then."""
    for package in (tmp_path / "OpenGL", tmp_path / "glfw"):
        package.mkdir()
        (package / "__init__.py").write_text("raise ImportError('no library found')")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delenv("MUJOCO_GL", raising=False)


def test_without_any_it_says_what_to_install(no_library):
    with pytest.raises(InputError, match=r"no OpenGL library works here.*apt install libegl1 .*"):
        find_backend()


def test_software_is_told_from_a_gpu():
    assert Backend("egl", "llvmpipe (LLVM 15.0.6, 256 bits)", 16384).software
    assert not Backend("egl", "NVIDIA GeForce RTX 4070/PCIe/SSE2", 32768).software
