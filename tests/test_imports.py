"""What may import what, and what a light start must not."""

import ast
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

import bikesim

PACKAGE = Path(bikesim.__file__).parent
FILES = sorted(PACKAGE.rglob("*.py"))

# Arrows point one way: each room, and the rooms that it may import from.
BASE = {"errors", "settings", "data", "textfile", "child"}
PARTS = {
    "model", "bicycles", "path", "haptics", "rider", "rig", "record", "guard", "clock", "loop",
}  # fmt: skip
ALLOWED = {
    "errors": set[str](),
    "child": set[str](),
    "settings": {"errors"},
    "data": {"errors"},
    "textfile": {"errors"},
    "model": {"errors"},
    "bicycles": BASE | {"model"},
    "path": BASE,
    "haptics": BASE | {"model"},
    "rider": BASE | {"model", "path"},
    "clock": set[str](),
    "realtime": set[str](),
    "guard": BASE | {"model"},
    "record": BASE | {"model"},
    "rig": BASE | {"model", "rider", "record", "clock"},
    "loop": BASE | {"model", "rig", "record", "guard"},
    "identify": BASE | {"model", "bicycles", "rider", "record"},
    "experiment": BASE | PARTS | {"identify"},
    "report": BASE | PARTS | {"experiment", "identify", "bench"},
    "bench": BASE | PARTS | {"realtime", "experiment"},
    "view": BASE | {"model", "bicycles", "path", "record", "rig", "bench"},
    "cli": BASE | PARTS | {"experiment", "identify", "bench", "report", "view"},
    "__main__": {"cli"},
    "__init__": set[str](),
}

HEAVY = {
    "numpy", "scipy", "mujoco", "glfw", "cv2", "matplotlib", "h5py", "pandas", "pyarrow", "av",
    "dask", "distributed", "statsmodels", "jinja2", "can", "cantools", "canopen", "msgpack",
}  # fmt: skip


def imported(file: Path) -> Iterator[str]:
    """The modules that a file imports anywhere, functions included."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}:{node.lineno}: imports are absolute here"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def room(file: Path) -> str:
    return file.relative_to(PACKAGE).with_suffix("").parts[0]


def rooms_imported(file: Path) -> set[str]:
    ours = [name.split(".")[1] for name in imported(file) if name.startswith("bikesim.")]
    return {name for name in ours if name != "__version__"} - {room(file)}


@pytest.mark.parametrize("file", FILES, ids=lambda f: str(f.relative_to(PACKAGE)))
def test_arrows_between_rooms_point_one_way(file: Path):
    assert room(file) in ALLOWED, f"{room(file)} is a new room: say what it may import"
    assert rooms_imported(file) <= ALLOWED[room(file)]


def test_the_allowed_arrows_have_no_cycle():
    done: set[str] = set()
    while free := {name for name, to in ALLOWED.items() if name not in done and to <= done}:
        done |= free
    assert done == set(ALLOWED)


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["run", "--help"]], ids=" ".join)
def test_help_imports_nothing_heavy(arguments: list[str]):
    code = (
        "import sys\n"
        "from bikesim.cli.main import main\n"
        "try: main(sys.argv[1:])\n"
        "except SystemExit: pass\n"
        "print('\\nMODULES', *sys.modules)"
    )
    ran = subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=True
    )
    modules = ran.stdout.rpartition("MODULES ")[2].split()
    assert "tyro" in modules
    assert HEAVY.isdisjoint(modules)


def test_each_package_imported_is_declared(repository: Path):
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    lines = project["dependencies"]
    declared = {re.split(r"[^\w-]", line)[0].replace("-", "_") for line in lines}
    declared.add("pydantic_core")  # the other half of pydantic, pinned by it
    declared.add("OpenGL")  # what MuJoCo's renderer is made on, and requires
    if "opencv_python_headless" in declared:
        declared.add("cv2")
    if "python_can" in declared:
        declared.add("can")
    used = {name.split(".")[0] for file in FILES for name in imported(file)}
    assert used - sys.stdlib_module_names - {"bikesim"} <= declared
