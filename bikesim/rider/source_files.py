"""The files that a rider of the user's own is made of: what his torque depends on."""

import ast
from collections.abc import Iterator
from contextlib import suppress
from importlib.machinery import all_suffixes
from importlib.metadata import PackageNotFoundError, packages_distributions, version
from importlib.util import find_spec
from pathlib import Path


def source_files(name: str) -> dict[str, Path]:
    """The files of FILE.py:CLASS or package.module:CLASS, by the names that they are told by.

    That of the class, and those that it imports from beside it or from its own package, anywhere in
    its text; and so on from those. What is imported by a name made up at run time, or read as data,
    is not found. A rider who is not there has none.
    """
    place = name.rpartition(":")[0]
    if place.endswith(".py"):
        file = Path(place)
        return {str(one): one for one in _closure([file], file.parent) if one.is_file()}
    package = place.partition(".")[0]
    root = _root(package)
    if root is None:
        return {}
    files = _closure(_files_of(place, root), root, package)
    return {one.relative_to(root).as_posix(): one for one in files}


def package_version(name: str) -> str | None:
    """PROJECT VERSION of the package in package.module:CLASS; None where nothing installed it."""
    package = name.rpartition(":")[0].partition(".")[0]
    projects = sorted(set(packages_distributions().get(package, ())))
    with suppress(PackageNotFoundError):
        return ", ".join(f"{project} {version(project)}" for project in projects) or None
    return None


def _root(package: str) -> Path | None:
    """The folder in which a package or a module lies; None if there is no such one."""
    try:
        spec = find_spec(package)
    except (ImportError, ValueError):
        return None
    if spec is None:
        return None
    places = [*(spec.submodule_search_locations or ()), *([spec.origin] if spec.origin else [])]
    return Path(places[0]).parent if places else None


def _closure(begin: list[Path], root: Path, package: str = "") -> list[Path]:
    """These files, and those below `root` that they import; only of the package if one is named."""
    found: list[Path] = []
    left = list(begin)
    while left:
        file = left.pop(0)
        if file in found:
            continue
        found.append(file)
        for module in _imported(file, root):
            if not package or module.partition(".")[0] == package:
                left += _files_of(module, root)
    return found


def _files_of(module: str, root: Path) -> list[Path]:
    """The files that are read when a module is imported, those of the packages around it too."""
    parts = module.split(".")
    places = [root.joinpath(*parts[: i + 1]) for i in range(len(parts))]
    candidates = (
        candidate
        for place in places
        for suffix in all_suffixes()
        for candidate in (place.with_name(place.name + suffix), place / f"__init__{suffix}")
    )
    return [candidate for candidate in candidates if candidate.is_file()]


def _imported(file: Path, root: Path) -> Iterator[str]:
    """The modules that a file names in its imports; what is taken from one may be one itself."""
    for node in ast.walk(_tree(file)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            around = file.relative_to(root).parent.parts
            base = around[: len(around) + 1 - node.level] if node.level else ()
            of = ".".join([*base, *([node.module] if node.module else [])])
            yield from (f"{of}.{alias.name}".strip(".") for alias in node.names)


def _tree(file: Path) -> ast.AST:
    """Of Python's text; empty where it is none, which he is told who imports it."""
    if file.suffix == ".py":
        with suppress(OSError, SyntaxError, ValueError, RecursionError):
            return ast.parse(file.read_bytes())
    return ast.Module([], [])
