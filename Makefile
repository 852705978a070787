# Everything sets itself up from nothing but Python 3.11 or later: its own virtual environment in
# .venv, versions pinned in requirements.txt.
.PHONY: help setup demo test hunt lint bench bench-against same-as docs golden firmware clean

VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
# The first Python that is new enough and can make virtual environments.
PYTHON ?= $(shell for p in python3.11 python3.12 python3.13 python3.14 python3; do \
  $$p -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' 2>/dev/null \
  && { echo $$p; break; }; done)

# Real drawings for tests, where they lie beside the project.
CORPUS := $(wildcard ../shared/corpus/dev)
ifneq ($(CORPUS),)
export WEDMCAM_CORPUS ?= $(abspath $(CORPUS))
endif

help:
	@echo "make demo    compile, prove and draw a sample"
	@echo "make test    run the tests"
	@echo "make hunt    run the property tests on new random examples"
	@echo "make lint    ruff and mypy"
	@echo "make bench   measure, as ratios side by side"
	@echo "make bench-against REV=..  this tree against a revision, row by row"
	@echo "make same-as REV=..        what a move must not change: programs, certificates, --json, plans"
	@echo "make docs    write the reference pages anew (docs/codes.md, docs/profiles.md)"
	@echo "make firmware  assemble the machine code of the ZD-065, build/zd065.bin"
	@echo "make golden  write the golden programs anew (look at the difference!)"

setup: $(READY)

$(READY): requirements.txt pyproject.toml
	@test -n "$(PYTHON)" || { echo "Python 3.11 or later with venv is needed"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install -q --disable-pip-version-check -r requirements.txt
	$(BIN)/python -m pip install -q --disable-pip-version-check --no-deps --no-build-isolation -e .
	$(BIN)/python -m compileall -q src/wedmcam
	@touch $(READY)

demo: $(READY)
	@mkdir -p demo
	$(BIN)/wedmcam compile samples/plate.dxf -o demo/plate.3b --offset 0.1 \
	  --certificate demo/plate.json --plot demo/plate.svg
	$(BIN)/wedmcam verify demo/plate.3b --certificate demo/plate.json
	$(BIN)/wedmcam plot demo/plate.3b -o demo/plate.png
	@echo "the program demo/plate.3b is proven; look at demo/plate.svg (or .png)"

test: $(READY)
	$(BIN)/python -m pytest -n 2

hunt: $(READY)
	HYPOTHESIS_PROFILE=hunt $(BIN)/python -m pytest -n 2 tests/property

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench-against: $(READY)
	$(BIN)/python benchmarks/against.py $(REV)

same-as: $(READY)
	$(BIN)/python tests/snapshot.py --against $(REV) $(if $(CORPUS),--corpus $(CORPUS) --plans)

bench: $(READY)
	$(BIN)/python benchmarks/report.py docs/benchmarks.md
	@echo "docs/benchmarks.md is written anew"

docs: $(READY)
	$(BIN)/python benchmarks/pages.py

golden: $(READY)
	$(BIN)/python -m pytest -q tests/golden --update-golden

firmware: $(READY)
	@mkdir -p build
	$(BIN)/ophis -q --no-branch-extend -m build/zd065.map -o build/zd065.bin firmware/zd065/main.s
	@echo "build/zd065.bin is the image of \$$E000..\$$FFFF; build/zd065.map has its labels"

clean:
	rm -rf $(VENV) demo build
