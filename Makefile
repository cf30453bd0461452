# The two commands of the README. VENV and PYTHON may be set from outside.
VENV ?= .venv
PYTHON ?= $(shell command -v python3.11 || command -v python3)
BIN := $(VENV)/bin

.PHONY: run test bench lint clean

# sets up and runs the main job
run: $(VENV)/.engines
	$(BIN)/simcompare run ball --engine all

# sets up and passes the tests
test: $(VENV)/.test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/python -m pytest -n 2

# cost beside each engine's own bare loop, as ratios; never part of the tests
bench: $(VENV)/.test
	$(BIN)/python -m pytest tests/benchmarks --benchmark-enable --benchmark-only -p no:xdist -q
	$(BIN)/python tests/benchmarks/commands.py

$(VENV)/.engines: pyproject.toml $(VENV)/bin/pip
	$(BIN)/pip install --quiet --editable '.[all]'
	@$(libraries)
	touch $@

$(VENV)/.test: pyproject.toml $(VENV)/bin/pip
	$(BIN)/pip install --quiet --editable '.[test]'
	@$(libraries)
	@$(checker)
	touch $@

# Debian and Ubuntu keep venv in a package of its own
$(VENV)/bin/pip:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "simcompare needs Python 3.11 or newer; $(PYTHON) is older. Set PYTHON=..."; exit 1; }
	@$(PYTHON) -c 'import ensurepip' 2>/dev/null || \
	  { package=$$($(PYTHON) -c 'import sys; print("python3.%d-venv" % sys.version_info[1])'); $(install); }
	$(PYTHON) -m venv $(VENV)

# dartpy's wheel needs libGL, which a machine without a screen may lack
libraries = $(PYTHON) -c 'import ctypes; ctypes.CDLL("libGL.so.1")' 2>/dev/null || \
  ! command -v apt-get >/dev/null || { package=libgl1; $(install); }

# Gazebo's checker of SDF, for the tests
checker = ign sdf -d >/dev/null 2>&1 || gz sdf -d >/dev/null 2>&1 || \
  ! command -v apt-get >/dev/null || { package='ignition-tools libsdformat-dev'; $(install); }

# installs $$package where that is allowed, else says what to do
install = if [ "$$(id -u)" = 0 ]; then as=; else as="sudo -n"; fi; \
  echo "installing the Debian package $$package"; \
  { $$as apt-get update -qq && $$as env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq $$package; } \
  >/dev/null 2>&1 || echo "not allowed; cure: sudo apt-get install $$package"

clean:
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
