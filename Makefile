# Everything a newcomer needs; each target installs what is missing, builds and runs. `make help`.
BUILD ?= build
.DEFAULT_GOAL := help
.PHONY: help setup build demo test bench clean

help:     ## This list
	@grep -hE '^[a-z]+: .*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):[^#]*## /  make \1\t/' | expand -t 16

setup:    ## Install what is missing (apt, as root or through sudo)
	@scripts/setup.sh

build: setup    ## Build the program in Release: build/bin/underbrush
	@cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release > $(BUILD).log 2>&1 || (cat $(BUILD).log; false)
	@cmake --build $(BUILD) --target underbrush

test: setup     ## Build everything and pass the tests
	@cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release
	@cmake --build $(BUILD)
	@ctest --test-dir $(BUILD) --output-on-failure -j 2

demo: build     ## The whole pipeline on a generated test site; ends with a report in demo/
	@$(BUILD)/bin/underbrush demo -o demo
