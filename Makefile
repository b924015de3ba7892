# What a person types. CMake does the building; this file only drives it.

# Builds targets of the host: one line of progress on a terminal, none where output is piped.
compile = @if [ -t 1 ]; then NINJA_STATUS='compiling %f of %t: ' cmake --build build/host --target $(1); \
    else cmake --build build/host --target $(1) -- --quiet; fi
# What is built for the tests: all and, on the cores of the quick set, quick, or on every core deep.
TARGETS := all quick
CORES := $(shell awk '/^[^\#]/ { print $$1 }' port/boards.txt)
TESTED_CORES := $(shell awk -v targets="$(TARGETS)" '/^[^\#]/ && ($$10 == "quick" || targets ~ $$10) { print $$1 }' port/boards.txt)
DEEP_CORES := $(shell awk '/^[^\#]/ && $$10 == "deep" { print $$1 }' port/boards.txt)
JOBS  := $(shell nproc)
# Configures a build directory: build/host is optimised by -O2, others as their tool chains and tests say.
configure = cmake -G Ninja -B build/$(1) -DCMAKE_EXPORT_COMPILE_COMMANDS=ON $(2) > /dev/null
RELEASE := -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE=-O2
SANITIZED := -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_CXX_FLAGS_DEBUG=-g1 -DCMAKE_CXX_FLAGS="-fsanitize=address,undefined \
    -fno-sanitize-recover=all -fno-omit-frame-pointer -Wno-unknown-warning-option"
core_of = --toolchain $(CURDIR)/port/toolchain.cmake -DTUMBLE_CORE=$(1)
# With --keep-going a build goes on where a file does not compile.
KEEP_GOING := $(if $(findstring k,$(firstword -$(MAKEFLAGS))),-- -k 0)
SCENE ?= host_sim/scenes/cube.toml
CORE  ?= cortex-m3
TOLERANCE ?= 1e-3
ARGS  ?=
# Of `make board`: number system and method, as type names.
PROGRAM ?= q32-Verlet
PAGES := $(wildcard *.md */*.md host_sim/*/*.md)

.PHONY: header api arduino page page-pictures run test bench pictures firmware replay advise flame board sizes check format tables golden build setup clean help explore mutants tolerances sanitize deep-setup say-run host-tests deep-tests tables-are-true
.DEFAULT_GOAL := help

## help: this list
help:
	@awk '/^## / { colon = index($$0, ": "); printf "  make %-20s %s\n", substr($$0, 4, colon - 4), substr($$0, colon + 2) }' \
	    $(MAKEFILE_LIST)

## run: replay a scene on the host and on the cores of the quick set, compare the bits, say which method is the cheapest; ARGS=--all for every method, number system and core
# Worlds that the scene needs are built beside the command; the commands build the others when they need them.
run: say-run build/host/build.ninja $(if $(findstring --all,$(ARGS)),deep-setup)
	$(call compile,tumble tumble_matrix tumble_first_worlds)
	@build/host/tumble run $(SCENE)
	@echo
	@build/host/bench/tumble_matrix $(SCENE) --tolerance $(TOLERANCE) --front bench/results/free.jsonl $(ARGS)

say-run:
	@echo "Replays $(SCENE) on the host and, in QEMU, on $(TESTED_CORES);"
	@echo "compares the bits, and measures which method keeps an error of $(TOLERANCE) for the fewest cycles."
	@echo "Takes about 2 minutes the first time, which compiles the simulator, and 10 to 20 s later$(if $(findstring --all,$(ARGS)),; with --all 10 minutes more)."

## test: the quick set of tests, of every kind: on the host, with other compilers, and on its cores in QEMU
test: firmware
	ctest --test-dir build/host --output-on-failure --no-tests=error -j $(JOBS) -LE deep

## build: the host command build/host/tumble and the programs of bench (7 minutes the first time)
build: build/host/build.ninja
	@cmake --build build/host --target programs

host-tests: build/host/build.ninja
	@cmake --build build/host --target $(TARGETS) $(KEEP_GOING)

## firmware: the firmware of the tests, for the cores of the quick set; TARGETS="all deep": of the deep set, for every core
firmware: $(TESTED_CORES:%=firmware-%)

.PHONY: $(CORES:%=firmware-%) $(CORES:%=configured-%)
$(CORES:%=firmware-%): firmware-%: host-tests configured-%
	@cmake --build build/$* --target $(TARGETS) $(KEEP_GOING)
$(DEEP_CORES:%=configured-%): deep-setup
$(CORES:%=configured-%): configured-%:
	@grep -qs '=$(CURDIR)/port/toolchain.cmake$$' build/$*/CMakeCache.txt || { rm -rf build/$*/CMakeCache.txt build/$*/CMakeFiles; \
	    $(call configure,$*,$(call core_of,$*)); }

## replay: run a scene on the host: make replay SCENE=path ARGS="--integrator rk4 --json"
replay: build/host/build.ninja
	$(call compile,tumble)
	build/host/tumble run $(SCENE) $(ARGS)

## advise: the cheapest integrator, numbers and step that keep an error: SCENE=path CORE=cortex-m3 TOLERANCE=1e-3 ARGS="--clock 16MHz"
advise: SCENE = host_sim/scenes/brick.toml
advise: build/host/build.ninja
	$(call compile,tumble)
	build/host/tumble advise $(SCENE) --core $(CORE) --tolerance $(TOLERANCE) $(ARGS)

## flame: where the cycles of a step go, as a table and a flame graph: SCENE=path CORE=cortex-m3 ARGS="--integrator rk4"
flame: build/host/build.ninja
	$(call compile,tumble)
	build/host/tumble profile $(SCENE) --core $(CORE) --flame build/flame.svg $(ARGS)

## bench: measure rows of bench/results anew, with their pictures and tables: ONLY=ladder, or ONLY=list for all names (bench/results.txt)
ONLY ?= free cube
bench:
	@bench/measure $(ONLY)

## pictures: draw all pictures again from the committed rows in bench/results
pictures:
	@bench/measure --pictures

## board: programs that hold the cycle counter of a board against the model (port/README.md): BOARD=its row CORE=cortex-m3 SCENE=path
board: SCENE = host_sim/scenes/free.toml
board: build/host/build.ninja
	@cmake --build build/host --target tumble tumble_cycles
	@port/board "$(BOARD)" $(CORE) $(SCENE) $(PROGRAM)

## sizes: code, constants, RAM and worst-case stack of the tests' firmware, into tests/budget/sizes.txt; REASON="why they changed"
REASON ?=
sizes: build
	@for core in $$(cut -d ' ' -f 1 build/host/tests/budget/sized.txt | sort -u); do \
	    $(MAKE) --no-print-directory configured-$$core && cmake --build build/$$core --target sized || exit 1; \
	done
	tests/budget/update_sizes tests/budget/sizes.txt build/host/tests/budget/sized.txt "$(REASON)"

## tables: rewrite the tables and figures of the pages from the committed rows in bench/results
tables: build
	build/host/bench/tumble_tables bench/results $(PAGES)

## header: the whole kernel as one header, build/header/tumble/tumble.hpp
header:
	@mkdir -p build/header/tumble
	kernel/amalgamate > build/header/tumble/tumble.hpp

## api: pages of the public interface, build/api/index.html; a public name without a comment is an error
api:
	@port/setup api
	@mkdir -p build/api
	doxygen kernel/Doxyfile

## page: the page on which scenes are seen and hit, build/page/tumble.html: one file that any browser opens
page: setup
	@port/setup page
	@$(call configure,wasm32,$(call core_of,wasm32))
	@cmake --build build/wasm32 --target page
	@echo "$(CURDIR)/build/page/tumble.html"

## page-pictures: draw the pictures of the front page anew, from the page
page-pictures: page deep-setup
	node tests/page/pictures.mjs build/page/tumble.html build/host/tumble host_sim/page/pictures

## arduino: the kernel as an Arduino library, build/arduino/tumble
arduino: setup
	kernel/arduino_library build/arduino

## golden: rewrite the golden hashes; a decision that the commit must explain
golden: build/host/build.ninja
	@cmake --build build/host --target conformance_simulator kernel_tests_deep
	tests/conformance/update_golden

## check: format, the deep set of tests (an hour or more), the sanitizers, comments of the public interface, and the pages' tables
# All of it, also where a part fails.
check: setup
	port/setup format
	port/setup engines
	$(call configure,host,$(RELEASE) -DTUMBLE_BENCH_HOST=ON)
	@failed=; for part in firmware deep-tests sanitize tables-are-true api; do \
	    $(MAKE) --keep-going TARGETS="all deep" $$part || failed="$$failed $$part"; \
	done; test -z "$$failed" || { echo "make check: failed in$$failed"; exit 1; }
deep-tests:
	ctest --test-dir build/host --output-on-failure --no-tests=error -j $(JOBS) -LE quick
tables-are-true:
	build/host/bench/tumble_tables --check bench/results $(PAGES)

## explore: random scenes and mechanisms of a new seed, or SEED=, each against double precision; those that end wrong are written to build/explore; SCENES=40000
SEED ?=
SCENES ?= 40000
explore: build/host/build.ninja
	@cmake --build build/host --target tumble_property
	@failed=0; explore() { build/host/tests/property/tumble_property $(if $(SEED),--seed $(SEED)) "$$@" || failed=1; }; \
	explore --scenes $(SCENES) --write build/explore; \
	explore --joints --scenes $$(($(SCENES) / 10)) --write build/explore/joints; exit $$failed

## mutants: wrong kernels, one line each, that the kernel's tests must find without committed bits (half an hour; goes on where it was stopped); PATTERN=part of a name
PATTERN ?=
mutants: build/host/build.ninja
	@cmake --build build/host --target kernel_tests
	tests/mutants/run build/host "$(PATTERN)"

## tolerances: every tolerance of the kernel's tests beside the largest error, and the test that measured it
tolerances: build/host/build.ninja
	@cmake --build build/host --target kernel_tests
	@ctest --test-dir build/host -j $(JOBS) -R '^kernel\.tolerances_are_used$$' > build/host/tests/kernel/tolerances.log || cat build/host/tests/kernel/tolerances.log
	@tests/kernel/tolerances build/host/tests/kernel/tolerances/*

## sanitize: the host tests under the address and undefined-behaviour sanitizers
# With clang++, which compiles them in half of the time that g++ takes. The quick set, of which the deep set has more of each
# kind, without what builds projects of its own, without the sanitizers, and without a test of CPU time. The use of tolerances
# is not judged, because kernel_tests has other number systems and methods there.
UNSANITIZED := ^(kernel\.tolerances_are_used|a_project_|a_firmware_as_|VerdictOfRun\.a_check_that_is_ended)
sanitize: deep-setup
	@test -f build/sanitize/build.ninja || $(call configure,sanitize,$(SANITIZED))
	@cmake --build build/sanitize --target all quick $(KEEP_GOING)
	ctest --test-dir build/sanitize --output-on-failure --no-tests=error -j $(JOBS) -LE "qemu|compilers|deep" -E "$(UNSANITIZED)"

## setup: install what is missing (Debian packages, with sudo when not root)
setup:
	@port/setup

# What only the deep set of tests and of cores needs.
deep-setup:
	@port/setup deep

## clean: remove the build directory
clean:
	rm -rf build

build/host/build.ninja: CMakeLists.txt | setup
	@$(call configure,host,$(RELEASE))
