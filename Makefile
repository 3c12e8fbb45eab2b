# SPDX-License-Identifier: BSD-3-Clause
# One target for each habit, in the environment that is active; .ci/run calls the same.

.DEFAULT_GOAL := help
.PHONY: help install hooks test slow lint format types layers docs check ci clean

help:  ## list the targets
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "%-10s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

install:  ## install the package in place, with all that the other targets need
	python -m pip install -e ".[all,test,docs]"

hooks:  ## check at every commit what .pre-commit-config.yaml lists
	python -m pip install pre-commit
	pre-commit install

test:  ## run the short part of the tests, with nearly every example of a docstring
	python -m pytest

slow:  ## run the rest of the tests, those marked slow
	python -m pytest -m slow

lint:  ## find mistakes and untidy lines; changes nothing
	ruff check .
	ruff format --check .

format:  ## tidy every file
	ruff check --fix .
	ruff format .

types:  ## check the type hints
	mypy

layers:  ## check that each folder imports only from those before it
	lint-imports --no-cache

docs:  ## build the site into docs/_build/html; a warning is an error
	python -m sphinx -W --keep-going -b html docs docs/_build/html

check: lint types layers test slow docs  ## all of these in the environment at hand

ci:  ## all of these as CI does, in environments of its own
	.ci/run

clean:  ## remove what was built, and every cache
	rm -rf build dist docs/_build docs/auto_examples docs/generated .coverage .hypothesis
	rm -rf .pytest_cache .mypy_cache .ruff_cache .import_linter_cache
	find sklvalve tests benchmarks docs -name __pycache__ -type d -prune -exec rm -rf {} +
