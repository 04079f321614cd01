# `make demo` computes the paper's 7.62 mm optimum, `make test` runs the checks and the tests, `make lowest` a part of
# them with the lowest versions of the dependencies. They create the virtual environments .venv and .venv/lowest.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
LOWEST := $(VENV)/lowest

# What is imported is compiled then, once: pip would compile all that it installs.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: build demo test quick lowest check site format docs bench campaigns coverage mutants release clean

demo: $(VENV)/installed
	$(BIN)/armour optimise scenarios/paper/optimum_7.62mm_AP.toml

# Compile the numerical code again after a change of it, in half a minute.
build: $(VENV)/developing
	$(BIN)/python hatch_build.py

test: check build
	$(BIN)/pytest -n auto

# The tests of what is computed, without those that take long: for daily work.
quick: build
	$(BIN)/pytest -n auto -m 'not slow'

# Types are not checked here: they are those of the newest libraries.
lowest: $(LOWEST)/installed
	$(LOWEST)/bin/ruff format --check .
	$(LOWEST)/bin/ruff check .
	$(LOWEST)/bin/lint-imports
	$(LOWEST)/bin/pytest -n auto -m 'not slow' tests/test_*.py tests/cli tests/engine tests/reporting tests/scenario tests/sweeps tests/statistics/test_own_tests.py

check: $(VENV)/developing
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m tools.budget

# Build the site of the documentation in site/, strictly; `make site && .venv/bin/mkdocs serve` shows it.
site: $(VENV)/developing
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet

format: $(VENV)/developing
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

# Write the generated pages and pictures of docs/.
docs: $(VENV)/developing
	$(BIN)/python -m tools.lists
	$(BIN)/python -m tools.published
	$(BIN)/python tools/notebook.py docs/study.ipynb
	$(BIN)/python -m tools.pictures
	$(BIN)/python -m tests.cli.test_docs
	$(BIN)/armour figures docs/figures --only fig09 --force
	$(BIN)/armour figures docs/figures --only parity --force
	rm docs/figures/*.csv

# Run the benchmarks and write the tables of docs/performance.md: some minutes.
bench: $(VENV)/developing
	$(BIN)/python -m tools.benchmarks

# Measure which lines and branches the tests run; less than 97 % fails.
coverage: $(VENV)/developing
	rm -rf .coverage
	mkdir .coverage
	$(BIN)/coverage run -m pytest -n auto
	$(BIN)/coverage combine --quiet
	$(BIN)/coverage report --skip-covered

# Build sdist and the wheels of all systems, and check them in a clean environment; dist/ then has them.
release: $(VENV)/developing
	$(BIN)/pip install --quiet --disable-pip-version-check ziglang
	$(BIN)/python tools/release.py

# Run the campaigns, one on each core, and write their results into docs/evidence/campaigns.md: about two hours of one core.
# `make campaigns CAMPAIGN=inputs` or, with options, `CAMPAIGN="coverage curves"` runs a single one.
campaigns: $(VENV)/developing $(VENV)/mutating
	$(BIN)/python -m tools.campaigns $(if $(CAMPAIGN),"$(CAMPAIGN)")

# Run the mutation tests of core/ alone: about half an hour. tools/mutants.md summarises the results.
mutants: $(VENV)/developing $(VENV)/mutating
	$(BIN)/python -m tools.campaigns mutants

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/installed: pyproject.toml | $(VENV)/bin/python
	$(BIN)/pip install --quiet --disable-pip-version-check --no-compile -e .
	touch $@

$(VENV)/developing: pyproject.toml | $(VENV)/bin/python
	$(BIN)/pip install --quiet --disable-pip-version-check --no-compile -e '.[dev,docs]'
	touch $@ $(VENV)/installed

# Its functions for making mutants are not public: other versions may differ.
$(VENV)/mutating: | $(VENV)/developing
	$(BIN)/pip install --quiet --disable-pip-version-check --no-compile mutmut==3.8.1
	touch $@

$(LOWEST)/installed: pyproject.toml tools/lowest.py
	$(PYTHON) -m venv --clear $(LOWEST)
	$(PYTHON) tools/lowest.py > $(LOWEST)/versions.txt
	$(LOWEST)/bin/pip install --quiet --disable-pip-version-check --no-compile -e '.[cluster,dev]' -c $(LOWEST)/versions.txt
	touch $@

clean:
	rm -rf $(VENV) .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis .coverage dist site
