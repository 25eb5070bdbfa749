# On a fresh machine with Python 3.11 or newer: make run, make test.
# Both first make .venv, once; PYTHON names the interpreter to take, ARGS goes to pytest.

SHELL := /bin/bash
export PYTHON
unexport PYTHONPATH PYTHONHOME

# A TMPDIR that is relative or gone breaks the tools that change folder.
export TMPDIR := $(shell cd "$${TMPDIR:-/tmp}" 2>/dev/null && [ -w . ] && pwd || echo /tmp)

PY := .venv/bin/python

# A monitor that is not there, and what a window needs on it; for tests.
SCREEN := xvfb libx11-6 libxcursor1 libxi6 libxinerama1 libxrandr2
READY := .venv/ready

.PHONY: run test check lint types format bench gallery lock gl clean

run: $(READY)
	$(PY) -m bikesim run --output runs/first.h5 --force --figure --video

test: $(READY)
	@bash scripts/apt.sh $(SCREEN) || echo "test: without them the tests of the live display fail" >&2
	$(PY) -m pytest --numprocesses auto --maxprocesses 4 --dist loadscope \
		--no-loadscope-reorder $(ARGS)

check: lint types

lint: $(READY)
	$(PY) -m ruff check
	$(PY) -m ruff format --check

types: $(READY)
	PYRIGHT_PYTHON_IGNORE_WARNINGS=1 $(PY) -m pyright

format: $(READY)
	$(PY) -m ruff check --fix
	$(PY) -m ruff format

bench: $(READY)
	$(PY) -m benchmarks

# Stills, the clip of haptics on and off, and the paper's figures, all from fixed seeds.
gallery: $(READY)
	@bash scripts/gallery.sh renders

# The newest versions that pyproject.toml allows, for every platform and Python; no address gets in.
lock: $(READY)
	$(PY) -m uv pip compile --quiet --upgrade --universal --python-version 3.11 --all-extras \
		--generate-hashes --no-emit-index-url --no-emit-find-links --no-config \
		--custom-compile-command "make lock" --output-file requirements.lock pyproject.toml

# System libraries with which MuJoCo draws without a display.
gl:
	@bash scripts/apt.sh libegl1 libgl1 libgl1-mesa-dri libosmesa6

clean:
	rm -rf .venv dist runs .pytest_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(READY): pyproject.toml requirements.lock scripts/setup.sh
	@bash scripts/setup.sh
	@$(MAKE) --no-print-directory gl || echo "setup: without them there are no videos" >&2
	@touch $@
