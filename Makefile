# The two commands of the README. VENV, PYTHON and ENGINES may be set from outside.
VENV ?= .venv
PYTHON ?= $(shell command -v python3.11 || command -v python3)
# engines to install and run: all, or names with commas
ENGINES ?= all
BIN := $(VENV)/bin
comma := ,
engines := $(subst $(comma), ,$(ENGINES))
# one stamp for every choice of engines
INSTALLED := $(VENV)/.installed-$(subst $(comma),-,$(ENGINES))

.PHONY: run test lab browser bench lint clean

# sets up and runs the main job
run: $(INSTALLED)
	$(BIN)/simcompare run ball --engine $(ENGINES)

# sets up and passes the tests; these start hundreds of processes, which read what is compiled
test: export PYTHONDONTWRITEBYTECODE =
test: $(INSTALLED)-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/python -m pytest -n 2

# sets up and opens the lab to everybody in the room
lab: $(INSTALLED)-web
	$(BIN)/simcompare lab --share

# the lab in a real browser, in real time: Debian's chromium, on a machine that does nothing else
browser: $(INSTALLED)-test
	$(BIN)/pip install -q playwright axe-core-python
	SIMCOMPARE_BROWSER=1 $(BIN)/python -m pytest tests/test_lab_page.py

# cost beside each engine's own bare loop, as ratios; never part of the tests
bench: $(INSTALLED)-test
	$(BIN)/python -m pytest tests/benchmarks --benchmark-enable --benchmark-only -p no:xdist -q
	$(BIN)/python tests/benchmarks/commands.py

$(INSTALLED): pyproject.toml tools/install.py $(BIN)/pip
	@$(BIN)/python tools/install.py $(ENGINES) check
	@$(libraries)
	@$(BIN)/python tools/install.py $(ENGINES) $(if $(filter all,$(ENGINES)),hardware)
	@touch $@

$(INSTALLED)-web: $(INSTALLED)
	@$(BIN)/python tools/install.py $(ENGINES) web
	@touch $@

$(INSTALLED)-test: pyproject.toml tools/install.py $(BIN)/pip
	@$(BIN)/python tools/install.py $(ENGINES) check
	@$(libraries)
	@$(checker)
	@$(BIN)/python tools/install.py $(ENGINES) hardware web gym test
	@touch $@

# Debian and Ubuntu keep venv in a package of its own; Ubuntu 22.04 keeps a newer Python beside its own
$(BIN)/pip:
	@python="$(PYTHON)"; \
	if ! "$$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then \
	  package='python3.11 python3.11-venv'; $(install); python=python3.11; \
	  command -v python3.11 >/dev/null || \
	    { echo "simcompare needs Python 3.11 or newer; cure: install one and run make PYTHON=..."; exit 1; }; \
	fi; \
	"$$python" -c 'import ensurepip' 2>/dev/null || \
	  { package=$$("$$python" -c 'import sys; print("python3.%d-venv" % sys.version_info[1])'); $(install); }; \
	echo "$$("$$python" --version), environment in $(VENV)"; "$$python" -m venv $(VENV)

# dartpy's wheel needs libGL, which a machine without a screen may lack; ODE is a library itself
libraries = for needed in libGL.so.1:libgl1 $(if $(filter all ode,$(engines)),libode.so.8:libode8); do \
    $(BIN)/python -c "import ctypes; ctypes.CDLL('$${needed%:*}')" 2>/dev/null || \
    ! command -v apt-get >/dev/null || { package=$${needed\#*:}; $(install); }; done

# Gazebo's checker of SDF, for the tests; newer Debian has none, and its tests skip
checker = ign sdf -d >/dev/null 2>&1 || gz sdf -d >/dev/null 2>&1 || \
  ! apt-cache show ignition-tools >/dev/null 2>&1 || { package='ignition-tools libsdformat-dev'; $(install); }

# installs $$package where that is allowed, else says what to do
install = if [ "$$(id -u)" = 0 ]; then as=; else as="sudo -n"; fi; \
  echo "installing the Debian package $$package"; \
  { $$as apt-get update -qq && $$as env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq $$package; } \
  >/dev/null 2>&1 || echo "not possible here; cure: sudo apt-get install $$package"

clean:
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
