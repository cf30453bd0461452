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
	$(BIN)/pip install --quiet --editable '.[engines]'
	touch $@

$(VENV)/.test: pyproject.toml $(VENV)/bin/pip
	$(BIN)/pip install --quiet --editable '.[test]'
	touch $@

# Debian and Ubuntu keep venv in a package of its own; root may install it, others are told
$(VENV)/bin/pip:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "simcompare needs Python 3.11 or newer; $(PYTHON) is older. Set PYTHON=..."; exit 1; }
	@$(PYTHON) -c 'import ensurepip' 2>/dev/null || { \
	  package=$$($(PYTHON) -c 'import sys; print("python3.%d-venv" % sys.version_info[1])'); \
	  if [ "$$(id -u)" = 0 ]; then apt-get update -qq && apt-get install -y -qq $$package; \
	  else echo "Python's venv is missing; cure: sudo apt-get install $$package"; exit 1; fi; }
	$(PYTHON) -m venv $(VENV)

clean:
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
