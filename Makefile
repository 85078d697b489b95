# Everything a newcomer needs: `make demo` and `make test` each work alone on a fresh Debian 12.

JOBS ?= $(shell nproc)
RELEASE := build/release
ARGS ?=

.PHONY: help setup build demo test test-fuzz test-sanitizers bench lint format clean

help:
	@echo "make setup   install Debian and npm packages (idempotent)"
	@echo "make build   build $(RELEASE)/leafcutter with its dashboard"
	@echo "make demo    cut a sample on a simulated laser; ARGS=--once ends by itself"
	@echo "make test    set up, build, run every test"
	@echo "make lint    clang-format and clang-tidy over all sources"
	@echo "make bench   build and run the benchmarks"

setup: web/node_modules/.package-lock.json

web/node_modules/.package-lock.json: web/package-lock.json docker/install.sh
	@docker/install.sh build
	@echo "setup: npm packages of the dashboard"
	@cd web && npm ci --no-audit --no-fund --loglevel=error
	@touch $@

build: setup
	@mkdir -p build
	@cmake --preset release >build/configure.log 2>&1 || (cat build/configure.log; exit 1)
	@cmake --build --preset release -j $(JOBS)

demo: build
	@python3 tests/demo.py --leafcutter $(RELEASE)/leafcutter $(ARGS)

test: build test-fuzz
	@ctest --preset release -j $(JOBS)

# A short run of every reader's fuzzer.
test-fuzz: setup
	@mkdir -p build
	@cmake --preset fuzz >build/configure-fuzz.log 2>&1 || (cat build/configure-fuzz.log; exit 1)
	@cmake --build --preset fuzz -j $(JOBS) --target fuzzers
	@ctest --test-dir build/fuzz -L fuzz --output-on-failure

# The unit tests under address, undefined-behaviour and thread sanitizers.
test-sanitizers: setup
	@for preset in asan tsan; do \
	    cmake --preset $$preset >/dev/null && cmake --build --preset $$preset -j $(JOBS) && \
	    ctest --preset $$preset -L unit -j $(JOBS) || exit 1; \
	done

bench: setup
	@cmake --preset release -DLEAFCUTTER_BENCH=ON >/dev/null
	@cmake --build --preset release -j $(JOBS) --target benchmarks
	@for binary in $(RELEASE)/tests/bench/bench_*; do $$binary || exit 1; done

SOURCES = $(shell git ls-files '*.h' '*.cpp')

lint: build
	@clang-format-14 --dry-run -Werror $(SOURCES)
	@git ls-files 'geometry/*.cpp' 'fab/*.cpp' 'drivers/*.cpp' 'server/*.cpp' | \
	    xargs -P $(JOBS) -n 4 clang-tidy-14 --quiet -p $(RELEASE)

format:
	@clang-format-14 -i $(SOURCES)

clean:
	@rm -rf build web/dist web/node_modules
