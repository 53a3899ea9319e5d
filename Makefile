# Every target sets up what it needs: a virtual environment in .venv with locked dependencies, and a release build of
# the extension. The second call is fast.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
RUST_SOURCES := $(shell find crates -name '*.rs' -o -name 'Cargo.toml') Cargo.toml Cargo.lock

.PHONY: demo test lint bench wheel format lock setup clean

# A round robin of data sets that the project makes itself; the report is demo/report.html, and demo/report.pdf.
demo: setup
	$(BIN)/python -m clerestory.demo demo

# Every test, Rust and Python.
test: setup
	cargo test --locked --profile checked --package clerestory
	$(BIN)/pytest -n 2 --dist loadfile

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	cargo fmt --check
	cargo clippy --locked --workspace --all-targets -- -D warnings

# Side-by-side timings against Radiance's programs; writes docs/validation.md.
bench: setup
	$(BIN)/python benchmarks/run.py

# A stable-ABI wheel in dist/.
wheel: $(VENV)/.deps
	$(BIN)/maturin build --release --locked --out dist

format: $(VENV)/.deps
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	cargo fmt

# Renews requirements.lock and requirements-peers.lock from pyproject.toml.
COMPILE = $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-header --no-annotate

lock: $(VENV)/.deps
	$(BIN)/pip install --quiet uv
	$(COMPILE) --group build --group lint --group test pyproject.toml -o requirements.lock
	$(COMPILE) --group peers -c requirements.lock -o requirements-peers.lock

setup: $(VENV)/.built

$(VENV)/.deps: requirements.lock
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	touch $@

$(VENV)/.built: $(VENV)/.deps pyproject.toml $(RUST_SOURCES)
	VIRTUAL_ENV=$(CURDIR)/$(VENV) $(BIN)/maturin develop --release --locked --quiet
	touch $@

clean:
	rm -rf $(VENV) target dist demo
