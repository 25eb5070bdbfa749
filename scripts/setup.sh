#!/usr/bin/env bash
# Makes .venv: a Python >= 3.11, the packages of requirements.lock, and bikesim from this folder.
# Uses uv where it is present, else venv and pip. PYTHON names the interpreter to take.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_INPUT=1 PIP_USER=0

say() { echo "setup: $*"; }
die() { echo "setup: $*" >&2; exit 1; }

recent() { "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; }

find_python() {
  local name names=(python3 python3.14 python3.13 python3.12 python3.11)
  if [ -n "${PYTHON:-}" ]; then names=("$PYTHON"); fi
  for name in "${names[@]}"; do
    if recent "$name"; then echo "$name"; return; fi
  done
  die "no Python 3.11 or newer: tried ${names[*]}; name one: make PYTHON=/path/to/python3"
}

make_with_uv() {
  say "making .venv with uv"
  uv venv --quiet --no-project --python "${PYTHON:->=3.11}" .venv
}

make_with_venv() {
  local python version
  python=$(find_python)
  say "making .venv with $("$python" --version)"
  if ! "$python" -c 'import ensurepip' 2>/dev/null; then
    version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    bash scripts/apt.sh "python$version-venv" || exit 1
  fi
  "$python" -m venv .venv
}

if command -v uv >/dev/null; then
  make_venv=make_with_uv
  install=(uv pip install --quiet --python .venv/bin/python)
  usable() { recent .venv/bin/python; }
else
  make_venv=make_with_venv
  install=(.venv/bin/python -m pip install --quiet)
  usable() { recent .venv/bin/python && .venv/bin/python -m pip --version >/dev/null 2>&1; }
fi

if ! usable; then
  rm -rf .venv # moved, half made, or of a Python that is gone
  "$make_venv"
fi
say "installing the packages of requirements.lock (the first time some 360 MB to download, 1.3 GB on disk)"
"${install[@]}" --require-hashes -r requirements.lock
say "installing bikesim from this folder"
"${install[@]}" --no-deps --no-build-isolation --editable .
say "done"
