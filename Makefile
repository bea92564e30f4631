# `make compare` runs the main job, `make test` everything that checks the code. Both install what they need.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

# Installs system packages where it may.
apt = { command -v apt-get >/dev/null && echo "installing the system packages $(1)" && { \
	if [ "$$(id -u)" = 0 ]; then as=env; else as="sudo -n env"; fi; $$as apt-get update -qq && \
	$$as DEBIAN_FRONTEND=noninteractive apt-get install -y -qq $(1); } >/dev/null 2>&1; }

.PHONY: compare test test-slow fuzz browser graphics gains fitted pictures peers clean

compare: $(VENV)/.installed
	$(BIN)/dynabot compare

test: $(VENV)/.installed browser graphics
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache
	OMP_NUM_THREADS=1 $(BIN)/pytest -n auto --dist loadfile

# A real browser for the test of the report, which is skipped without one.
browser:
	@command -v chromium >/dev/null || command -v google-chrome >/dev/null || $(call apt,chromium) || \
	  echo "no browser: the test of the report in one is skipped; install the system package chromium"

# OpenGL without a display for films and their tests, which are skipped without it.
graphics: $(VENV)/.installed
	@$(BIN)/python -c 'from dynabot_mj.host import opengl; opengl.backend()' 2>/dev/null || \
	  $(call apt,libegl1 libgl1-mesa-dri) || \
	  echo "no OpenGL: films cannot be drawn; install the system packages libegl1 libgl1-mesa-dri"

# Checks that take minutes: the statistics of Table III on fresh seeds, and the rigid plant against the particle.
test-slow: $(VENV)/.installed
	OMP_NUM_THREADS=1 $(BIN)/pytest -n auto -m slow

# Broken configurations, logs, studies and models: 10,000 of them in place of the 300 of `make test`.
FUZZ_INPUTS ?= 10000
fuzz: $(VENV)/.installed
	DYNABOT_FUZZ=$(FUZZ_INPUTS) OMP_NUM_THREADS=1 $(BIN)/pytest -n auto --dist load tests/test_fuzz.py

# The gain set that all studies use by default: tuned from the first one, and adopted only where it beats it.
gains: $(VENV)/.installed
	$(BIN)/dynabot tune traction --out out/gains --overwrite
	cp out/gains/gains.toml controllers/gains/tuned.toml

# The fitted surrogate's default: what the filters err by in the loop, on the seed and the trials that its file names.
# To try it: make fitted FITTED_TRIALS=2 FITTED_FILE=out/try.toml
FITTED_TRIALS ?= 100
FITTED_FILE ?= dynabot_mj/perception/fitted.toml
FITTED = dynabot compare --perception filter --plants particle --estimators gps decoupled coupled --seed 0 \
  --trials $(FITTED_TRIALS)
fitted: $(VENV)/.installed
	$(BIN)/$(FITTED) --out out/fitted --overwrite
	@{ echo "# The fitted surrogate's default: the filters' errors in the loop. \`make fitted\` writes this file anew, from" && \
	  echo "# $(FITTED)" && \
	  $(BIN)/python -c 'from dynabot_mj.study import provenance; print("#", provenance.versions())' && \
	  echo && cat out/fitted/fitted.toml; } >out/fitted.toml
	cp out/fitted.toml $(FITTED_FILE)

# The pictures of the README and of docs/; takes about half an hour.
pictures: $(VENV)/.installed graphics
	$(BIN)/dynabot compare --out out/pictures/compare --overwrite
	$(BIN)/dynabot compare --sensitivity --out out/pictures/sensitivity --overwrite
	$(BIN)/dynabot tune traction --out out/pictures/tune --overwrite
	$(BIN)/dynabot track --out out/pictures/track --overwrite
	$(BIN)/dynabot circle --out out/pictures/circle --overwrite
	$(BIN)/dynabot compare --perception gauss-markov filter fitted --out out/pictures/perception --overwrite
	$(BIN)/dynabot video --beside particle --still 34 --out out/pictures/fleet.png
	$(BIN)/python -c 'import re; print(re.search("```toml\n(.*?)```", open("docs/campaigns.md").read(), re.S).group(1))' \
	  >out/pictures/campaign.toml
	$(BIN)/dynabot study out/pictures/campaign.toml --out out/pictures/study --overwrite
	mkdir -p docs/images
	cp out/pictures/fleet.png docs/images/
	cp out/pictures/compare/trajectories_decoupled.png out/pictures/compare/table_iii.png docs/images/
	cp out/pictures/compare/outcomes.png out/pictures/compare/incidence.png docs/images/
	cp out/pictures/sensitivity/sensitivity.png docs/images/
	cp out/pictures/study/campaign.png docs/images/
	cp out/pictures/circle/fig_3.png docs/images/
	cp out/pictures/circle/errors.png docs/images/circle_errors.png
	cp out/pictures/perception/errors.png docs/images/loop_errors.png
	cp out/pictures/perception/outcomes.png docs/images/perceptions.png
	cp out/pictures/tune/tuning.png out/pictures/tune/parity.png out/pictures/track/tracking.png docs/images/

# What the package is compared with, in an environment of its own; see benchmarks/peers/README.md.
PEERS := benchmarks/peers
PEERS_PIP ?=
peers: $(PEERS)/.venv/.installed
	OMP_NUM_THREADS=1 $(PEERS)/.venv/bin/python $(PEERS)/bodies.py
	OMP_NUM_THREADS=1 $(PEERS)/.venv/bin/python $(PEERS)/particles.py

$(PEERS)/.venv/.installed: pyproject.toml requirements.lock $(PEERS)/requirements.txt
	$(PYTHON) -m venv --clear $(PEERS)/.venv
	$(PEERS)/.venv/bin/python -m pip install --quiet --disable-pip-version-check $(PEERS_PIP) \
	  -r requirements.lock -r $(PEERS)/requirements.txt
	$(PEERS)/.venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --editable .
	@touch $@

# The lock file pins what is tested; the package itself is installed in place.
$(VENV)/.installed: pyproject.toml requirements.lock
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "Python 3.11 or newer is needed, $(PYTHON) is $$($(PYTHON) --version 2>&1); try: make PYTHON=python3.12 $(MAKECMDGOALS)"; exit 1; }
	@$(PYTHON) -c 'import ensurepip' 2>/dev/null || $(call apt,python3-venv) || \
	  { echo "Python's venv module is missing; install the system package python3-venv"; exit 1; }
	$(PYTHON) -m venv --clear $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --editable .
	@touch $@

clean:
	rm -rf $(VENV) $(PEERS)/.venv out build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache
