# Everything goes through the folder .venv, which make sets up by itself and keeps up to date.
# Written for GNU make 3.81, the one that macOS ships.

PYTHON =
ARGS =

SHELL = /bin/sh
VENV = .venv
VENV_PYTHON = $(VENV)/bin/python
INSTALLED = $(VENV)/installed
PIP = $(VENV_PYTHON) -m pip --disable-pip-version-check install
PYTHONS = $(PYTHON) python3.13 python3.12 python3.11 python3.14 python3 python
SUITABLE = import sys, venv, ensurepip; sys.exit(not (3, 11) <= sys.version_info < (3, 15))
# The lock names the newest versions that still run on the oldest Python.
OLDEST_PYTHON = 3.11
LOCK_VENV = build/lock
# Whoever is idle takes over tests of a busy one: ARGS="-n 0" runs them one by one. Threads of the
# linear algebra would only take each other's processors.
PYTEST = OPENBLAS_NUM_THREADS=1 $(VENV_PYTHON) -m pytest -n auto --maxprocesses 4 --dist worksteal
# What builds the project where it is editable; the lock holds both.
BUILDS_EDITABLE = hatchling editables

.DEFAULT_GOAL = help
.PHONY: help run install test coverage check format bench soak faults fuzz peers opensmc docs pictures lock clean always libgomp

help:  ## Show this list
	@echo 'make run      then open the address that it prints'
	@echo
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  %-8s  %s\n", $$1, $$2 }' Makefile
	@echo
	@echo 'ARGS passes options on: make run ARGS="--port 9000", make test ARGS="-k network".'
	@echo 'PYTHON chooses another Python for .venv: make install PYTHON=/path/to/python3'

run: $(INSTALLED)  ## Run the dashboard
	$(VENV_PYTHON) -m slidetune serve $(ARGS)

install: $(INSTALLED)  ## Set up .venv with everything that run, test and check need
	@echo '.venv is ready: make run starts the dashboard.'

test: $(INSTALLED)  ## Run all tests, including those in a real Chromium
	CHROMIUM=`$(VENV_PYTHON) -m tests.browser.chromium` && export CHROMIUM && \
	$(PYTEST) $(ARGS)

coverage: $(INSTALLED)  ## Run the tests and list the lines and branches not reached
	CHROMIUM=`$(VENV_PYTHON) -m tests.browser.chromium` && export CHROMIUM && \
	$(PYTEST) --cov --cov-report=term-missing:skip-covered $(ARGS)

check: $(INSTALLED)  ## Check style (ruff) and types (mypy)
	$(VENV_PYTHON) -m ruff check .
	$(VENV_PYTHON) -m ruff format --check .
	$(VENV_PYTHON) -m mypy

format: $(INSTALLED)  ## Format the code and sort its imports
	$(VENV_PYTHON) -m ruff check --select I --fix .
	$(VENV_PYTHON) -m ruff format .

bench: $(INSTALLED)  ## Measure the time of a control step
	$(VENV_PYTHON) -m slidetune bench $(ARGS)

soak: $(INSTALLED)  ## Serve many clients, then run for half an hour: ARGS="--minutes 2"
	$(VENV_PYTHON) -m tests.trust.soak $(ARGS)

faults: $(INSTALLED)  ## Kill and suspend processes, fill the disk, check that nothing is lost
	$(VENV_PYTHON) -m tests.trust.faults $(ARGS)

fuzz: $(INSTALLED)  ## Send it more than 100,000 malformed inputs
	$(VENV_PYTHON) -m tests.trust.fuzz $(ARGS)

peers: $(INSTALLED)  ## Time the same closed loop in other simulators (1.6 GB in build/)
	$(VENV_PYTHON) -m tests.peers.compare $(ARGS)
	$(VENV_PYTHON) -m tests.peers.search $(ARGS)

opensmc: $(INSTALLED)  ## Run the laws that OpenSMC has too, there and here
	$(VENV_PYTHON) -m tests.peers.opensmc $(ARGS)

docs: $(INSTALLED)  ## Build the documentation site, which works offline, in build/site
	$(VENV_PYTHON) -m docs.site $(ARGS)

pictures: $(INSTALLED)  ## Take the pictures of the documentation anew, in a real Chromium
	CHROMIUM=`$(VENV_PYTHON) -m tests.browser.chromium` && export CHROMIUM && \
	$(VENV_PYTHON) -m tests.browser.pictures $(ARGS)

lock:  ## Regenerate requirements.lock with the current versions
	$(or $(PYTHON),python3) -m venv --clear $(LOCK_VENV)
	$(LOCK_VENV)/bin/python -m pip install --disable-pip-version-check uv
	printf '%s\n' $(BUILDS_EDITABLE) | $(LOCK_VENV)/bin/uv pip compile --quiet --universal \
	  --python-version $(OLDEST_PYTHON) --fork-strategy fewest --generate-hashes \
	  --no-header --no-annotate --extra test --extra check --extra docs \
	  --output-file $(LOCK_VENV)/versions pyproject.toml -
	{ grep '^#' requirements.lock; cat $(LOCK_VENV)/versions; } > $(LOCK_VENV)/requirements.lock
	mv $(LOCK_VENV)/requirements.lock requirements.lock

clean:  ## Remove .venv and everything else that was generated
	rm -rf $(VENV) build dist test-results .pytest_cache .mypy_cache .ruff_cache .hypothesis .coverage
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# A .venv whose Python is gone (after an upgrade of the system, say) is set up anew.
always:
BROKEN := $(shell $(VENV_PYTHON) -c '' 2>/dev/null || echo always)

$(INSTALLED): pyproject.toml requirements.lock $(BROKEN)
	@rm -f $@; \
	if ! $(VENV_PYTHON) -c '$(SUITABLE)' 2>/dev/null; then \
	  for candidate in $(PYTHONS); do \
	    if "$$candidate" -c '$(SUITABLE)' 2>/dev/null; then found=$$candidate; break; fi; \
	  done; \
	  if [ -z "$$found" ]; then \
	    echo 'Slidetune needs Python 3.11, 3.12, 3.13 or 3.14 with its venv module: found none.' >&2; \
	    echo '  Debian, Ubuntu:  sudo apt install python3 python3-venv' >&2; \
	    echo '  Fedora:          sudo dnf install python3' >&2; \
	    echo '  macOS:           brew install python@3.13' >&2; \
	    echo '  One elsewhere:   make $(or $(MAKECMDGOALS),install) PYTHON=/path/to/python3' >&2; \
	    exit 1; \
	  fi; \
	  echo "Setting up .venv with $$("$$found" --version) …"; \
	  "$$found" -m venv --clear $(VENV) || exit 1; \
	fi
	$(PIP) --no-deps --require-hashes --requirement requirements.lock
	@echo 'Setting up the project itself …'; \
	$(PIP) --quiet --no-index --no-build-isolation --editable '.[test,check,docs]' || { \
	  echo 'If requirements.lock lacks what pyproject.toml asks for: make lock' >&2; exit 1; \
	}
	@if ! problem=`$(VENV_PYTHON) -c 'import pinocchio' 2>&1`; then \
	  case "$$problem" in \
	    *libgomp*) $(MAKE) --no-print-directory libgomp;; \
	    *) echo "$$problem" >&2; exit 1;; \
	  esac; \
	fi
	@touch $@

# Pinocchio leaves one library to the system. Nearly all have it, a bare server doesn't. Only root
# gets it without being asked; everybody else reads which command does.
libgomp:
	@echo "Pinocchio needs GCC's library libgomp, which this system lacks." >&2; \
	if command -v apt-get >/dev/null; then \
	  install='apt-get install -y libgomp1'; \
	elif command -v dnf >/dev/null; then install='dnf install -y libgomp'; \
	elif command -v pacman >/dev/null; then install='pacman -S --noconfirm gcc-libs'; \
	fi; \
	if [ -n "$$install" ] && [ "`id -u`" -eq 0 ]; then \
	  set -x; \
	  if command -v apt-get >/dev/null; then apt-get update; fi; \
	  DEBIAN_FRONTEND=noninteractive $$install; \
	else \
	  echo "Install it ($${install:+sudo }$${install:-Debian: libgomp1}), then run make again." >&2; \
	  exit 1; \
	fi
