# Everything a person does here. Each target sets up what it needs: system packages, .venv, the build.
SHELL := /bin/bash
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help
.PHONY: help train policies test asan tsan bench accuracy realfiles scripted absurd interop docs wheels platforms lint format build clean

TASK ?= PandaReach
SEED ?= 0
SEEDS ?= 1
PYTHON ?= python3
JOBS ?= $(shell nproc)
export PYTHON JOBS

VENV := .venv
USER_PATH := $(PATH)
export PATH := $(CURDIR)/$(VENV)/bin:$(PATH)

help:  ## This list
	@echo "manyhands: robot manipulation, simulation and reinforcement learning"
	@echo
	@sed -nE 's/^([a-z]+):.*## (.*)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 16
	@echo
	@echo "  Variables: TASK=PandaReach SEED=0 PYTHON=python3 JOBS=$(JOBS)"

train: $(VENV)/.core $(VENV)/.installed  ## Learn a task from nothing: make train TASK=PandaReach SEED=0
	@echo "$(VENV)/bin/manyhands train $(TASK) --seed $(SEED)"
	@PATH='$(USER_PATH)' $(VENV)/bin/manyhands train $(TASK) --seed $(SEED)

policies: $(VENV)/.core $(VENV)/.installed  ## Train and pack the policies that ship: make policies ENVS=PandaStack SEEDS=5
	python tools/package_policies.py $(ENVS) --seeds $(SEEDS) --jobs $(JOBS)

test: $(VENV)/.test $(VENV)/.installed  ## C++ and Python tests, formatting, types, layers
	tools/test.sh

asan: $(VENV)/.cpp  ## C++ tests of what handles memory, under address and undefined-behaviour sanitizers
	tools/cpp_tests.sh asan

tsan: $(VENV)/.cpp  ## C++ tests with threads under the thread sanitizer
	tools/cpp_tests.sh tsan

bench: $(VENV)/.test $(VENV)/.installed  ## Benchmarks: a table, and build/bench.json
	cmake --preset release >build/configure.log || { cat build/configure.log; exit 1; }
	cmake --build --preset release -j $(JOBS) --target benchmarks
	python -m benchmarks

accuracy: $(VENV)/.test $(VENV)/.installed  ## How right the physics is: a table, curves, and build/accuracy.json
	python -m benchmarks.accuracy

realfiles: $(VENV)/.test $(VENV)/.installed  ## Real robots' files beside MuJoCo: build/realfiles.json (SAMPLE=60 for a part)
	python -m benchmarks.realfiles --jobs $(JOBS) $(if $(SAMPLE),--sample $(SAMPLE),--composed) $(REALFILES)

scripted: $(VENV)/.test $(VENV)/.installed  ## Tasks of robosuite and metaworld, replayed here and in MuJoCo: build/scripted.json
	python -m benchmarks.scripted

absurd: $(VENV)/.test $(VENV)/.installed  ## 10,000 random scenes without reason: build/absurd.json
	python -m benchmarks.absurd --jobs $(JOBS) $(ABSURD)

interop: $(VENV)/.core $(VENV)/.installed  ## Stable-Baselines3, RL Zoo, panda-gym, Minari, LeRobot and Ray beside our package, in an environment of their own (5 GB)
	tools/interop.sh

docs: $(VENV)/.docs $(VENV)/.installed  ## The documentation as a site, links checked: build/docs/html (EXTERNAL=1 for others' pages too)
	python -m tools.site $(if $(EXTERNAL),--external)

wheels: $(VENV)/.core $(VENV)/.wheels  ## Wheels for Linux on this processor, into dist/: Python 3.10, 3.11, and one from 3.12 on
	tools/wheels/make.sh

platforms: $(VENV)/.core $(VENV)/.wheels  ## Golden hashes with Clang and on ARM (qemu); the library compiled for macOS, Windows
	tools/cross/compile.sh
	tools/cross/goldens.sh

lint: $(VENV)/.test $(VENV)/.installed  ## All checks that run no program, with clang-tidy (slow)
	tools/lint.sh --tidy

format: $(VENV)/.test  ## Format C++ and Python
	tools/lint.sh --fix

build: $(VENV)/.core $(VENV)/.installed  ## The Python package, built and installed into .venv

clean:  ## Remove what was built; .venv too
	rm -rf build $(VENV)

# ---- Set-up, each step once ------------------------------------------------------------------------------------
# Packages are fetched while the compiler runs.
MAKEFLAGS += --jobs=2
LIBRARIES := libeigen3-dev libpugixml-dev libqhull-dev libpng-dev ccache
SOURCES := CMakeLists.txt $(shell find cmake manyhands bindings python assets -type f -not -path '*/__pycache__/*')

$(VENV)/.build: tools/setup.sh
	@tools/setup.sh system $(LIBRARIES)
	@tools/setup.sh venv
	@touch $@

$(VENV)/.cpp: $(VENV)/.build
	@tools/setup.sh system $(LIBRARIES) libgtest-dev
	@touch $@

$(VENV)/.core: $(VENV)/.build pyproject.toml
	@tools/setup.sh python build core all
	@touch $@

$(VENV)/.test: $(VENV)/.core $(VENV)/.cpp pyproject.toml
	@tools/setup.sh python test dev
	@tools/setup.sh browser
	@touch $@

$(VENV)/.docs: $(VENV)/.core pyproject.toml
	@tools/setup.sh python docs
	@touch $@

$(VENV)/.wheels: $(VENV)/.build pyproject.toml
	@tools/setup.sh python wheels
	@touch $@

$(VENV)/.installed: $(VENV)/.build $(SOURCES)
	@echo "==> Building the Python package (about three minutes the first time)"
	@CMAKE_BUILD_PARALLEL_LEVEL=$(JOBS) pip install --quiet --no-build-isolation --no-deps .
	@touch $@
