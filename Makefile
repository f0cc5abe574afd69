# The house: one command each, from a bare Python 3.11 or newer with venv.
#
#   make demo      30 s of the whole system, then the report   (DURATION=60 ARGS="--wind gust")
#   make setup     .venv with pinned dependencies and compiled kernels
#   make test      every check but the slow ones               (ARGS="-k wind")
#   make test-all  lint, and every test
#   make lint      style, types, layers
#   make bench     speed and accuracy on this machine; the nodes measured live  (ARGS="--config FILE")
#   make soak      the whole suite for hours, each node restarted once  (HOURS=0.1)
#   make peers     other people's chaos indicators, which bench then measures beside ours
#   make docs      generated tables, then HTML in build/docs

PYTHON ?= python3
DURATION ?= 30
HOURS ?= 1
ARGS ?=

VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
COMPILED := $(VENV)/.compiled
NODE_MODULES := test/node/node_modules/.package-lock.json

.DEFAULT_GOAL := help
.PHONY: help setup demo test test-all lint format bench soak peers docs lock clean

help:
	@sed -n 's/^#   //p' Makefile

setup: $(COMPILED)

$(INSTALLED): requirements/lock.txt setup.py setup.cfg pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "nw_gear needs Python 3.11 or newer; choose one with PYTHON=...")'
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --requirement requirements/lock.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	touch $@

# Compiling takes a minute once; without this the first run would pay for it.
$(COMPILED): $(INSTALLED)
	$(BIN)/python scripts/compile_kernels.py
	touch $@

demo: $(COMPILED)
	$(BIN)/nw_gear demo --duration $(DURATION) $(ARGS)

# What only computes runs on all cores, file by file; nodes, which keep time, run by themselves.
# Exit code 5: ARGS selects none of these tests.
COMPUTE := $(BIN)/python -m pytest -n auto --dist loadfile test/common test/sim test/monitor
SYSTEM := $(BIN)/python -m pytest test/system

test: $(COMPILED)
	$(COMPUTE) $(ARGS) || test $$? -eq 5
	$(SYSTEM) $(ARGS) || test $$? -eq 5

test-all: lint $(COMPILED) $(NODE_MODULES)
	$(COMPUTE) -m "" $(ARGS) || test $$? -eq 5
	$(SYSTEM) -m "" $(ARGS) || test $$? -eq 5

# The recordings are also read on Node.js; where there is none those tests say so and are skipped.
$(NODE_MODULES): test/node/package-lock.json
	if command -v npm > /dev/null; then cd test/node && npm ci --silent --no-audit --no-fund; fi

lint: $(INSTALLED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(INSTALLED)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: $(COMPILED)
	$(BIN)/nw_gear bench $(ARGS)
	mkdir -p build
	$(BIN)/python benchmark/live.py -o build/live.json

soak: $(COMPILED)
	$(BIN)/python benchmark/soak/run.py --hours $(HOURS) $(ARGS)

PEER := $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint requirements/lock.txt --requirement

# Where there is no compiler bench goes without the second ones.
peers: $(INSTALLED)
	$(PEER) requirements/bench.txt
	-$(PEER) requirements/bench-compiled.txt

docs: $(INSTALLED)
	$(BIN)/python scripts/generate.py
	$(BIN)/python -m sphinx -q -W -b html docs build/docs
	@echo build/docs/index.html

lock: $(INSTALLED)
	$(BIN)/python scripts/lock.py

clean:
	rm -rf build install log $(VENV)
