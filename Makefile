# What a person types. CMake does the building; this file only drives it.

# Builds targets of the host: one line of progress on a terminal, none where output is piped.
compile = @if [ -t 1 ]; then NINJA_STATUS='compiling %f of %t: ' cmake --build build/host --target $(1); \
    else cmake --build build/host --target $(1) -- --quiet; fi
# What is built for the tests: all, which the quick set needs, on its cores; with deep, what the deep set needs besides.
TARGETS := all
CORES := $(shell awk '/^[^\#]/ { print $$1 }' port/boards.txt)
TESTED_CORES := $(shell awk -v targets="$(TARGETS)" '/^[^\#]/ && ($$10 == "quick" || targets ~ $$10) { print $$1 }' port/boards.txt)
# Cores with a timing table, of these those of the quick set, and the others that count instructions; and all of the deep set.
TIMED_CORES := $(shell awk '/^[^\#]/ && $$9 != "-" { print $$1 }' port/boards.txt)
QUICK_CORES := $(shell awk '/^[^\#]/ && $$9 != "-" && $$10 == "quick" { print $$1 }' port/boards.txt)
OTHER_CORES := $(shell awk '/^[^\#]/ && $$9 == "-" && $$5 ~ /^insn/ { print $$1 }' port/boards.txt)
DEEP_CORES := $(shell awk '/^[^\#]/ && $$10 == "deep" { print $$1 }' port/boards.txt)
JOBS  := $(shell nproc)
comma := ,
space := $(subst ,, )
# Words joined by commas.
list = $(subst $(space),$(comma),$(strip $(1)))
SCENE ?= host_sim/scenes/cube.toml
CORE  ?= cortex-m3
TOLERANCE ?= 1e-3
ARGS  ?=
# Of `make board`: number system and method, as type names.
PROGRAM ?= q32-Verlet
PAGES := $(wildcard *.md */*.md host_sim/*/*.md)

.PHONY: run test bench bench-contacts ladder peers work-precision work-precision-loads pictures long-run stress stress-coarse ordinary engines bench-host firmware replay advise flame board sizes check format tables golden build setup clean help
.DEFAULT_GOAL := help

## help: this list
help:
	@awk '/^## / { colon = index($$0, ": "); printf "  make %-20s %s\n", substr($$0, 4, colon - 4), substr($$0, colon + 2) }' \
	    $(MAKEFILE_LIST)

## run: replay a scene on the host and on the cores of the quick set, compare the bits, say which method is the cheapest; ARGS=--all for every method, number system and core
# The first module of worlds beside the command, on the other processor; the commands build what else they need.
run: say-run build/host/build.ninja $(if $(findstring --all,$(ARGS)),deep-setup)
	$(call compile,tumble tumble_matrix tumble_worlds_0)
	@build/host/tumble run $(SCENE)
	@echo
	@build/host/bench/tumble_matrix $(SCENE) --tolerance $(TOLERANCE) --front bench/results/free.jsonl $(ARGS)

.PHONY: say-run
say-run:
	@echo "Replays $(SCENE) on the host and, in QEMU, on $(TESTED_CORES);"
	@echo "compares the bits, and measures which method keeps an error of $(TOLERANCE) for the fewest cycles."
	@echo "Takes 1 to 2 minutes the first time, which compiles the simulator, and 10 to 20 s later$(if $(findstring --all,$(ARGS)),; with --all 10 minutes more)."

## test: the quick set of tests, of every kind: on the host, with other compilers, and on its cores in QEMU
test: firmware
	ctest --test-dir build/host --output-on-failure --no-tests=error -j $(JOBS) -LE deep

## build: the host command build/host/tumble and the programs of bench
build: build/host/build.ninja
	@cmake --build build/host --target programs

.PHONY: host-tests
host-tests: build/host/build.ninja
	@cmake --build build/host --target $(TARGETS)

## firmware: the firmware of the tests, for the cores of the quick set; TARGETS="all deep": of the deep set, for every core
firmware: $(TESTED_CORES:%=firmware-%)

.PHONY: $(CORES:%=firmware-%) $(CORES:%=configured-%)
$(CORES:%=firmware-%): firmware-%: host-tests configured-%
	@cmake --build build/$* --target $(TARGETS)
$(DEEP_CORES:%=configured-%): deep-setup
$(CORES:%=configured-%): configured-%:
	@grep -qs '=$(CURDIR)/port/toolchain.cmake$$' build/$*/CMakeCache.txt || { rm -rf build/$*/CMakeCache.txt build/$*/CMakeFiles; \
	    TUMBLE_CORE=$* cmake --preset firmware > /dev/null; }

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

## bench: cycles, text, RAM and stack of a step of the benchmark scenes on every core and the host, into bench/results
# Where there are no cycles, the number systems that tables show; of the cube, what its table shows.
bench: build valgrind
	build/host/bench/tumble_matrix host_sim/scenes/free.toml --all --cores $(call list,$(TIMED_CORES)) --results build/results/free_timed.jsonl
	build/host/bench/tumble_matrix host_sim/scenes/free.toml --numbers q32,f32_plain --cores $(call list,$(OTHER_CORES)) --results build/results/free_other.jsonl
	build/host/bench/tumble_matrix host_sim/scenes/free.toml --all --cores host --results build/results/free_host.jsonl
	cat build/results/free_timed.jsonl build/results/free_other.jsonl build/results/free_host.jsonl > bench/results/free.jsonl
	build/host/bench/tumble_matrix host_sim/scenes/cube.toml --numbers q32 --cores $(call list,$(TIMED_CORES)) --accuracy \
	    --integrators explicit_euler,implicit_euler,heun,midpoint,rk4,verlet --results bench/results/cube.jsonl
	build/host/bench/tumble_tables bench/results $(PAGES)

## bench-contacts: what contacts cost a step, at rest, asleep, out of reach and at worst, on an M3 and an M4F
CONTACTS := bench/contacts/plane_out_of_reach bench/contacts/plane_within_reach bench/contacts/ball_and_ball \
    bench/contacts/ball_and_box bench/contacts/resting_box bench/contacts/resting_box_rough \
    bench/contacts/sleepers_0 bench/contacts/sleepers_1 bench/contacts/sleepers_16 host_sim/scenes/contacts/cradle \
    host_sim/scenes/contacts/stack bench/contacts/worst_case
# On an M0 the larger of them do not fit.
bench-contacts: build
	rm -f build/results/contacts.jsonl
	for scene in host_sim/scenes/free $(CONTACTS); do \
	    build/host/bench/tumble_matrix $$scene.toml --cores $(call list,$(filter-out cortex-m0,$(QUICK_CORES))) --numbers q32,f32_plain --integrators verlet \
	        --results build/results/contacts_scene.jsonl || exit 1; \
	    cat build/results/contacts_scene.jsonl >> build/results/contacts.jsonl; \
	done
	@mv build/results/contacts.jsonl bench/results/contacts.jsonl
	build/host/bench/tumble_tables bench/results $(PAGES)

## ladder: what each feature adds to a step, from the empty world up, on an M0, an M3 and an M4F, as rows and a picture
ladder: build
	rm -f build/results/ladder.jsonl
	for scene in bench/ladder/*.toml; do \
	    build/host/bench/tumble_matrix $$scene --cores $(call list,$(QUICK_CORES)) --integrators verlet \
	        --results build/results/ladder_scene.jsonl || exit 1; \
	    cat build/results/ladder_scene.jsonl >> build/results/ladder.jsonl; \
	done
	@mv build/results/ladder.jsonl bench/results/ladder.jsonl
	build/host/bench/tumble_pictures --ladder bench/results/ladder.jsonl --directory bench/results
	build/host/bench/tumble_tables bench/results $(PAGES)

## work-precision: error against cost of every method on problems of free rotation, as rows and pictures in bench/results
work-precision: build
	build/host/bench/tumble_work_precision bench/problems/generic_top.toml bench/problems/separatrix_top.toml bench/problems/nearly_symmetric_top.toml \
	    --cost bench/results/free.jsonl --cost-of-problem bench/results/peers.jsonl --results bench/results/work_precision.jsonl
	build/host/bench/tumble_pictures bench/results/work_precision.jsonl --directory bench/results
	build/host/bench/tumble_tables bench/results $(PAGES)

## work-precision-loads: the same on problems with loads and contacts, with the cost of a step of each problem
LOADS := heavy_top kepler stiff_spring projectile_drag ball_elastic ball_inelastic
LOADS_CORES := $(call list,$(QUICK_CORES) host)
LOADS_NUMBERS := q32,f32_plain,f64
# Where the error is a position, the methods that differ in translation: the others are verlet with another rotation.
LOADS_METHODS := --integrators explicit_euler,semi_implicit_euler,implicit_euler,implicit_midpoint,midpoint,heun,rk4,verlet,suzuki4
cost-of-heavy_top: LOADS_METHODS :=
.PHONY: $(LOADS:%=cost-of-%)
$(LOADS:%=cost-of-%): cost-of-%: build valgrind
	build/host/bench/tumble_matrix bench/problems/$*.toml --cores $(LOADS_CORES) --numbers $(LOADS_NUMBERS) $(LOADS_METHODS) --results build/results/cost_of_$*.jsonl
work-precision-loads: $(LOADS:%=cost-of-%)
	cat $(LOADS:%=build/results/cost_of_%.jsonl) > bench/results/loads.jsonl
	build/host/bench/tumble_work_precision $(LOADS:%=bench/problems/%.toml) --cores $(LOADS_CORES) --coarsest 0 \
	    --cost-of-problem bench/results/loads.jsonl --cost-of-problem bench/results/peers.jsonl \
	    --results bench/results/work_precision_loads.jsonl
	build/host/bench/tumble_pictures bench/results/work_precision_loads.jsonl --directory bench/results
	build/host/bench/tumble_tables bench/results $(PAGES)

## pictures: draw all pictures again from the committed rows
pictures: build
	build/host/bench/tumble_pictures $(wildcard bench/results/work_precision*.jsonl) --ladder bench/results/ladder.jsonl \
	    --long-runs bench/results/long_run_series.jsonl --directory bench/results
	build/host/bench/tumble_host_picture bench/results/host.jsonl bench/results/host.svg
	test ! -f bench/results/stability.jsonl || build/host/bench/stress/tumble_stress --draw bench/results/stability.jsonl --directory bench/results

## stress: maps of where each method and number system is accurate, drifts, blows up or is silent, as rows and pictures in bench/results
stress: build
	build/host/bench/stress/tumble_stress --results bench/results/stability.jsonl --directory bench/results

## stress-coarse: a few cells of each map, into build/results; ARGS="--maps springs --integrators rk4 --numbers q32"
stress-coarse: build
	build/host/bench/stress/tumble_stress --coarse --results build/results/stability.jsonl --directory build/results $(ARGS)

## long-run: what a million and ten million steps do to energy and momentum, bodies at rest and elastic impacts, into bench/results
long-run: build
	build/host/bench/tumble_long_run bench/problems/generic_top.toml bench/problems/heavy_top.toml --results bench/results/long_run.jsonl
	build/host/bench/tumble_long_run --results bench/results/long_run_series.jsonl
	build/host/bench/tumble_pictures --long-runs bench/results/long_run_series.jsonl --directory bench/results
	build/host/bench/tumble_tables bench/results $(PAGES)

## ordinary: the kernel's Butcher tables on a harmonic oscillator and the Lorenz system, into bench/results
ordinary: build
	build/host/bench/tumble_ordinary bench/results/ordinary.jsonl
	build/host/bench/tumble_tables bench/results $(PAGES)

## engines: Bullet, ODE and MuJoCo on the tests' free top beside this kernel, into bench/results; installs their packages
engines:
	@port/setup engines
	@cmake -G Ninja -S bench/engines -B build/engines > /dev/null
	@cmake --build build/engines
	@for engine in tumble bullet_f32 bullet_f64 ode mujoco; do build/engines/$$engine || exit 1; done > build/engines/engines.jsonl
	@mv build/engines/engines.jsonl bench/results/engines.jsonl
	@$(MAKE) tables

## bench-host: times of steps on this machine beside Odeint's, Bullet's, ODE's and MuJoCo's, 1 to 10000 bodies, into bench/results
bench-host:
	@port/setup engines
	@cmake --preset host -DTUMBLE_BENCH_HOST=ON > /dev/null
	@cmake --build build/host --target tumble_bench_host tumble_host_picture tumble_tables
	build/host/bench/host/tumble_bench_host 10000 build/results/host.jsonl
	@mv build/results/host.jsonl bench/results/host.jsonl
	build/host/bench/tumble_host_picture bench/results/host.jsonl bench/results/host.svg
	build/host/bench/tumble_tables bench/results $(PAGES)

## peers: what a step of Boost.Odeint costs on the cores, into bench/results
peers: build
	@mkdir -p build/results
	@for core in $(QUICK_CORES); do \
	    cmake -G Ninja -S bench/peers -B build/peers/$$core -DCMAKE_TOOLCHAIN_FILE=$(CURDIR)/port/toolchain.cmake -DTUMBLE_CORE=$$core \
	        -DTUMBLE_COMMAND=$(CURDIR)/build/host/tumble > /dev/null && \
	    cmake --build build/peers/$$core > /dev/null || exit 1; \
	    build/host/bench/tumble_peers $$core build/peers/$$core/*.elf || exit 1; \
	done > build/results/peers.jsonl
	@mv build/results/peers.jsonl bench/results/peers.jsonl

## board: programs that hold the cycle counter of a board against the model (port/README.md): BOARD=its row CORE=cortex-m3 SCENE=path
board: SCENE = host_sim/scenes/free.toml
board: build/host/build.ninja
	@test -n "$(BOARD)" || { echo "make board: expected BOARD=<row of port/boards.txt>" >&2; exit 2; }
	@cmake --build build/host --target tumble tumble_cycles
	@mkdir -p build/board
	build/host/tumble compile $(SCENE) --struct Replayed -o build/board/replayed.hpp
	@for core in $(BOARD) $(CORE); do \
	    cmake -G Ninja -S port/programs/step -B build/board/$$core -DTUMBLE_CORE=$$core -DTUMBLE_SCENE=Replayed \
	        -DCMAKE_TOOLCHAIN_FILE=$(CURDIR)/port/toolchain.cmake \
	        -DTUMBLE_SCENE_HEADER=$(CURDIR)/build/board/replayed.hpp > /dev/null && \
	    cmake --build build/board/$$core --target $(PROGRAM) || exit 1; \
	done
	port/qemu/run --cycles $$(awk '$$1 == "$(CORE)" { print $$9 }' port/boards.txt) $(CORE) build/board/$(CORE)/$(PROGRAM).elf \
	    > build/board/model.jsonl
	@echo "run build/board/$(BOARD)/$(PROGRAM).elf on the board and hold what it prints against build/board/model.jsonl"

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
.PHONY: header
header:
	@mkdir -p build/header/tumble
	kernel/amalgamate > build/header/tumble/tumble.hpp

## api: pages of the public interface, build/api/index.html; a public name without a comment is an error
.PHONY: api
api:
	@port/setup api
	@mkdir -p build/api
	doxygen kernel/Doxyfile

## arduino: the kernel as an Arduino library, build/arduino/tumble
.PHONY: arduino
arduino: setup
	kernel/arduino_library build/arduino

## golden: rewrite the golden hashes; a decision that the commit must explain
golden: build/host/build.ninja
	@cmake --build build/host --target conformance_simulator kernel_tests_deep
	tests/conformance/update_golden

## check: format, the deep set of tests (hours), the sanitizers, comments of the public interface, and the pages' tables
check: TARGETS := all deep
check: setup
	port/setup format
	port/setup engines
	cmake --preset host -DTUMBLE_BENCH_HOST=ON > /dev/null
	$(MAKE) firmware TARGETS="$(TARGETS)"
	ctest --test-dir build/host --output-on-failure --no-tests=error -j $(JOBS)
	$(MAKE) sanitize
	build/host/bench/tumble_tables --check bench/results $(PAGES)
	$(MAKE) api

## mutants: wrong kernels, one line each, that the kernel's tests must find without committed bits (half an hour; goes on where it was stopped); PATTERN=part of a name
PATTERN ?=
.PHONY: mutants
mutants: build/host/build.ninja
	@cmake --build build/host --target kernel_tests
	tests/mutants/run build/host "$(PATTERN)"

## tolerances: every tolerance of the kernel's tests beside the largest error, and the test that measured it
.PHONY: tolerances
tolerances: build/host/build.ninja
	@cmake --build build/host --target kernel_tests
	@ctest --test-dir build/host -j $(JOBS) -R '^kernel\.tolerances_are_used$$' > build/host/tests/kernel/tolerances.log || cat build/host/tests/kernel/tolerances.log
	@tests/kernel/tolerances build/host/tests/kernel/tolerances/*

## sanitize: the host tests under the address and undefined-behaviour sanitizers
# GCC's warnings of array bounds and of uninitialized values are off there: with sanitizers it sees what is not.
# Without what builds projects of its own, without the sanitizers, without kernel_tests: kernel_tests_deep holds its cases;
# without the new ones of the random scenes, and without what runs for millions of steps: long runs and maps of stability.
UNSANITIZED := ^(kernel\.(shard_|tolerances_are_used)|a_project_|a_firmware_as_|new_random_|long_runs_|the_maps_|maps_of_|no_cell_of_)
.PHONY: sanitize
sanitize: setup
	@test -f build/sanitize/build.ninja || cmake --preset host-debug-sanitize > /dev/null
	@cmake --build build/sanitize --target all kernel_tests_deep
	ctest --test-dir build/sanitize --output-on-failure --no-tests=error -j $(JOBS) -LE "qemu|compilers" -E "$(UNSANITIZED)"

# What counts the host's instructions.
.PHONY: valgrind
valgrind:
	@port/setup bench

## setup: install what is missing (Debian packages, with sudo when not root)
setup:
	@port/setup

# What only the deep set of tests and of cores needs.
.PHONY: deep-setup
deep-setup:
	@port/setup deep

## clean: remove the build directory
clean:
	rm -rf build

build/host/build.ninja: CMakeLists.txt CMakePresets.json | setup
	@cmake --preset host > /dev/null
