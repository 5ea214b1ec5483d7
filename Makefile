# Everything a newcomer needs; each target installs what is missing, builds and runs. `make help`.
BUILD ?= build
JOBS ?= $(shell nproc)
program := $(BUILD)/bin/underbrush
ccache := $(if $(shell command -v ccache),-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
configure = cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release $(ccache)
# Shows a command's output only if it fails.
quiet = log=$$(mktemp); if $(1) > $$log 2>&1; then rm $$log; else cat $$log; rm $$log; exit 1; fi

.DEFAULT_GOAL := help
.PHONY: help setup build test demo bench docs clean

help:     ## This list
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):[^#]*## /  make \1\t/' | expand -t 16

setup:    ## Install what is missing (apt, as root or through sudo)
	@scripts/setup.sh build test

# The program alone needs no test packages: a first configuration leaves tests and benchmarks out.
build:    ## Build the program in Release: build/bin/underbrush
	@scripts/setup.sh build
	@test -f $(BUILD)/CMakeCache.txt && first= || first="-DUNDERBRUSH_TESTS=OFF -DUNDERBRUSH_BENCH=OFF"; \
	  $(call quiet,$(configure) $$first)
	@cmake --build $(BUILD) --target underbrush -j $(JOBS)
	@echo "built $(program)"

test: setup    ## Build everything and pass all tests
	@$(call quiet,$(configure) -DUNDERBRUSH_TESTS=ON -DUNDERBRUSH_BENCH=ON)
	@cmake --build $(BUILD) -j $(JOBS)
	@ctest --test-dir $(BUILD) --output-on-failure --progress -j $(JOBS)

demo: build    ## The whole pipeline on a generated test site; ends with a report in demo/
	@$(program) demo -o demo

bench: setup   ## Build and run the benchmarks
	@$(call quiet,$(configure) -DUNDERBRUSH_TESTS=ON -DUNDERBRUSH_BENCH=ON)
	@cmake --build $(BUILD) -j $(JOBS)
	@set -e; for b in $$(find $(BUILD)/bin -maxdepth 1 -name 'bench_*' -type f | sort); do echo "== $$b"; $$b; done

docs: setup    ## The library's reference: build/docs/html/index.html
	@$(call quiet,BUILD=$(BUILD) python3 tests/rules/docs.py --html $(BUILD)/docs)
	@echo "written $(BUILD)/docs/html/index.html"

clean:    ## Remove what was built and the demo's output
	@rm -rf $(BUILD) demo
