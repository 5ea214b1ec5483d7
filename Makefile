# Everything a newcomer needs; each target installs what is missing, builds and runs. `make help`.
BUILD ?= build
JOBS ?= $(shell nproc)
# The real logs, and where `make results` keeps what it made. TABLES=NAME makes one table only.
DATA ?= $(or $(UNDERBRUSH_DATA),../shared/data)
WORK ?= $(BUILD)/results
program := $(BUILD)/bin/underbrush
ccache := $(if $(shell command -v ccache),-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
configure = cmake -S . -B $(BUILD) -G Ninja -DCMAKE_BUILD_TYPE=Release $(ccache)
everything = -DUNDERBRUSH_TESTS=ON -DUNDERBRUSH_BENCH=ON -DUNDERBRUSH_STUDIES=ON
program_only = -DUNDERBRUSH_TESTS=OFF -DUNDERBRUSH_BENCH=OFF -DUNDERBRUSH_STUDIES=OFF
# Shows a command's output only if it fails.
quiet = log=$$(mktemp); if $(1) > $$log 2>&1; then rm $$log; else cat $$log; rm $$log; exit 1; fi

.DEFAULT_GOAL := help
.PHONY: help setup build pictures test attack fuzz fuzz-long tsan fmu check-fmu validation demo bench gates results docs live deb \
        check-deb wheel check-wheel check-users check-pythons asan-python clean

help:     ## This list
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):[^#]*## /  make \1\t/' | expand -t 16

setup:    ## Install what is missing (apt, as root or through sudo)
	@scripts/setup.sh build test

# The program alone needs no test packages: a first configuration leaves tests, benchmarks and studies out.
build:    ## Build the program in Release: build/bin/underbrush
	@scripts/setup.sh build
	@test -f $(BUILD)/CMakeCache.txt && first= || first="$(program_only)"; \
	  $(call quiet,$(configure) $$first)
	@cmake --build $(BUILD) --target underbrush -j $(JOBS)
	@echo "built $(program)"

# Without the Python packages that build the module, as offline, its tests are left out; one line says so.
# One test more than cores runs, since some wait.
test: setup    ## Build everything and pass all tests
	@with=ON; python3 python/tests/environment.py maker --build $(BUILD) > /dev/null || with=OFF; \
	  $(call quiet,$(configure) $(everything) -DUNDERBRUSH_PYTHON=$$with)
	@scripts/with_scratch.sh cmake --build $(BUILD) -j $(JOBS)
	@scripts/with_scratch.sh ctest --test-dir $(BUILD) --output-on-failure --progress -j $$(($(JOBS) + 1))

fuzz: setup    ## Mutate inputs of every kind, 10 000 a kind (hours)
	@$(call quiet,$(configure) $(everything))
	@cmake --build $(BUILD) --target underbrush -j $(JOBS)
	@tests/fuzz/mutate.py --program $(program) --mutants 10000 --jobs $(JOBS) --keep $(BUILD)/mutants

# KIND=files, killed, lies, server, live, fmus, package or units runs one kind; MOMENTS=100 kills each command as often.
attack: fmu    ## Full disks, kill -9, lies in files, hostile calls and wrong units (an hour); KIND=NAME runs one kind
	@cmake --build $(BUILD) --target underbrush -j $(JOBS)
	@$(if $(filter units,$(KIND)),,tests/fuzz/attack/attack.py --program $(program) --jobs $(JOBS) \
	  $(if $(MOMENTS),--moments $(MOMENTS)) $(if $(KIND),--kind $(KIND)))
	@$(if $(filter-out units,$(KIND)),,tests/fuzz/units.py --program $(program) --jobs $(JOBS))

# READER=NAME runs one reader.
fuzz-long: setup ## Every C++ reader and the FMU's messages under ASan and UBSan, 10^8 executions in all (hours)
	@$(call quiet,$(configure) $(everything))
	@cmake --build $(BUILD) --target underbrush -j $(JOBS)
	@tests/fuzz/readers.py --program $(program) --build $(BUILD)/fuzz --jobs $(JOBS) --executions 100000000 \
	  $(if $(READER),--only $(READER))

# The modules that have loops on several threads, and the server.
threaded := core io ground movers trace sensor surface credit keyframes likelihood simulate calibrate fit primitives \
            test_site metrics osi serve
tsan: setup    ## The tests of what runs on several threads, under ThreadSanitizer: build/tsan (an hour)
	@$(call quiet,cmake -S . -B $(BUILD)/tsan -G Ninja -DCMAKE_BUILD_TYPE=None $(ccache) -DUNDERBRUSH_TSAN=ON \
	  -DUNDERBRUSH_TESTS=ON -DUNDERBRUSH_BENCH=OFF -DUNDERBRUSH_STUDIES=OFF)
	@cmake --build $(BUILD)/tsan --target $(addprefix test_,$(threaded)) -j $(JOBS)
	@set -e; for module in $(threaded); do $(BUILD)/tsan/tests/test_$$module --gtest_brief=1; done

fmu:      ## The FMUs for co-simulation: build/underbrush.fmu (FMI 2.0), build/underbrush3.fmu (FMI 3.0)
	@scripts/setup.sh build python
	@test -f $(BUILD)/CMakeCache.txt && first= || first="$(program_only)"; \
	  $(call quiet,$(configure) $$first)
	@cmake --build $(BUILD) --target fmu -j $(JOBS)
	@echo "built $(BUILD)/underbrush.fmu and $(BUILD)/underbrush3.fmu"

check-fmu: fmu ## The FMU's tests with 100 000 steps for the one of memory (minutes)
	@python3 tests/fmu/fmu_test.py --fmu $(BUILD)/underbrush.fmu --fmi3 $(BUILD)/underbrush3.fmu --long

validation:    ## The report of what the simulation was validated with: build/validation.html
	@mkdir -p $(BUILD)
	@scripts/validation_report.py --html $(BUILD)/validation.html
	@echo "wrote $(BUILD)/validation.html"

demo: build    ## The whole pipeline on a generated site and a real scan; ends with a report in demo/
	@$(program) demo -o demo

pictures: build    ## The pictures of the browser page in docs/images (needs Chromium and Node)
	@python3 tests/web/browser.py --program $(program) --build $(BUILD) --animate docs/images

bench: setup   ## Build and run the benchmarks
	@$(call quiet,$(configure) $(everything))
	@cmake --build $(BUILD) -j $(JOBS)
	@set -e; for b in $$(find $(BUILD)/bin -maxdepth 1 -name 'bench_*' -type l | sort); do echo "== $$b"; $$b; done

gates: setup   ## Count the instructions of tracing, echoes and five verbs, and compare with bench/gates.txt (half an hour)
	@$(call quiet,$(configure) $(everything))
	@cmake --build $(BUILD) --target underbrush bench -j $(JOBS)
	@bench/gates.py --bin $(BUILD)/bin

results:  ## Make every table of figures in the documentation anew and compare it (hours)
	@scripts/setup.sh build test results
	@$(call quiet,$(configure) $(everything))
	@cmake --build $(BUILD) -j $(JOBS)
	@scripts/results.py --data $(DATA) --work $(WORK) --bin $(BUILD)/bin $(if $(TABLES),--only $(TABLES)) \
	  $(if $(UPDATE),--update)

docs: build    ## The documentation as a site: build/docs/site/index.html
	@scripts/setup.sh docs
	@cmake --build $(BUILD) --target underbrush-reference -j $(JOBS)
	@scripts/build_site.py --build $(BUILD)

live: build    ## The sensor server of `underbrush live`: build/lib/underbrush/live_grpc.so
	@scripts/setup.sh live
	@$(call quiet,$(configure))
	@cmake --build $(BUILD) --target live_grpc -j $(JOBS)

deb: live      ## A Debian package of the program: build/underbrush_VERSION_amd64.deb
	@scripts/setup.sh package
	@cmake --build $(BUILD) --target deb -j $(JOBS)

check-deb: deb ## Install the package on a bare Debian and run it there (root, minutes)
	@scripts/check_deb.sh $(BUILD)/underbrush_*.deb

check-wheel:   ## Install the Python package and its wheel on a bare Debian (root, minutes)
	@scripts/setup.sh package
	@scripts/check_wheel.sh

check-users:   ## The ways of four new users, each on a bare Debian (root, minutes)
	@scripts/setup.sh package
	@DATA=$(DATA) scripts/check_users.sh

check-pythons: setup   ## The Python tests with every other Python on the PATH, from 3.10 on (minutes)
	@$(call quiet,$(configure) -DUNDERBRUSH_PYTHON=ON)
	@cmake --build $(BUILD) --target underbrush_python -j $(JOBS)
	@python3 python/tests/environment.py versions --build $(BUILD)

asan-python: setup   ## The Python tests of lifetimes under AddressSanitizer: build/asan (minutes)
	@$(call quiet,cmake -S . -B $(BUILD)/asan -G Ninja -DCMAKE_BUILD_TYPE=None $(ccache) $(program_only) \
	  -DCMAKE_CXX_FLAGS="-O1 -fsanitize=address -fno-omit-frame-pointer" -DUNDERBRUSH_PYTHON=ON)
	@cmake --build $(BUILD)/asan --target _core -j $(JOBS)
	@python3 python/tests/environment.py asan --build $(BUILD)/asan

wheel: setup   ## A wheel of the Python package that bundles its libraries: build/wheel
	@$(call quiet,$(configure) -DUNDERBRUSH_PYTHON=ON)
	@cmake --build $(BUILD) --target underbrush_python -j $(JOBS)
	@python3 python/tests/environment.py repaired --build $(BUILD)

clean:    ## Remove what was built and the demo's output
	@rm -rf $(BUILD) demo
