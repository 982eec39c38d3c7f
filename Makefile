# SPDX-License-Identifier: GPL-3.0-or-later
# The front door. Everything else is CMake: see CMakePresets.json.
#
#   make demo    install what the program needs, build it, run scenes/wellhead, name the pictures
#   make python  build the Python module and install it for the current user of /usr/bin/python3: docs/python.md
#   make test    install what the tests need besides, build, run the tests
#   make test-slow  the tests that take half of the time of all
#   make one-test NAME=SUITE.TEST  the same for one test or suite
#   make install PREFIX=DIR  the program, man pages, completion, libraries, find_package(tubefoot): docs/installation.md
#   make package  Debian packages into build/
#   make wheel    the Python module with the libraries it needs, for pip, into build/
#   make sanitize  the tests once more under address, undefined-behaviour and thread sanitizers: validation/sanitizers.md
#   make prove   check the laws of visibility on ten million tubes (about an hour): validation/prove.md
#   make fuzz    damage everything that is read, and the kernel's input, for FUZZ_SECONDS (3600) each: validation/fuzzing.md
#   make bench   build without assertions and run the benchmarks
#   make against today's program and another in turn, scene by scene: AGAINST=REVISION or a program
#   make atlas   run every method on the inputs where methods fail, write validation/atlas.md anew (minutes)
#   make advise-study  hold the advice on every shipped scene against what it did not see: validation/advise.md
#   make pairs   what combinations cost beside their parts: validation/pairs.md (minutes)
#   make rays    hold rays in layered water against published ones: validation/rays.md
#   make engines  pictures of other engines, written anew, and what compare says of them: validation/engines.md (minutes)
#   make real-engines  engines of others, built from given sources, what compare finds, and their results on the suite: validation/real-engines.md (half an hour)
#   make refraction-study  soundings of a flat seabed in stratified water: out/refraction.png
#   make track-study  the track of a camera, estimated from its frames: out/track.png, out/drift.png
#   make scaling  what pings cost, how runs scale over ranks: validation/scaling.md, validation/performance.md (a quarter of an hour)
#   make gradients  compare exact gradients with finite differences of rays: validation/gradients.md (minutes)
#   make long-run  memory of 10 000 pings of a sidescan and a multibeam: validation/pictures/long-run.svg (minutes)
#   make reference reference-sums  certify the echoes of validation/reference/v1 anew and write its checksums (half a minute)
#   make reference-sums  checksums of the benchmark suites v2 and v3, as tubefoot suite writes them (minutes)
#   make benchmark-archive  the benchmark suite as an archive that can receive a DOI, into build/: validation/reference/archive.md
#   make docs    build the documents as a site: build/docs/html/index.html
#   make figures  draw all figures of the documents (minutes); FIGURES='gallery/robot-*' some, FIGURES=--stale those
#                 whose inputs have changed
#   make format  lay out the code by .clang-format;  make tidy  check it by .clang-tidy

JOBS := $(shell nproc)
PROGRAM := build/release/tubefoot

.PHONY: demo python test test-slow one-test install package wheel program whole build configured sanitize prove fuzz bench against atlas advise-study pairs refraction-study track-study \
  rays engines real-engines scaling gradients long-run reference reference-sums benchmark-archive docs figures format tidy clean

demo: program
	$(PROGRAM) run scenes/wellhead/scene.toml -o out/wellhead
	@echo
	@echo "The acoustic camera, from three sides:  out/wellhead/camera-0000.png  camera-0001.png  camera-0002.png"
	@echo "The sidescan sonar, in passing:         out/wellhead/sidescan.png"
	@echo "With speckle and noise:                 out/wellhead/camera-0000-received.png  sidescan-received.png"

PYTHON_SITE := $(shell /usr/bin/python3 -m site --user-site 2>/dev/null)

python: program
	@tools/setup python
	@$(CONFIGURE_PROGRAM)
	cmake --build --preset release --parallel $(JOBS) --target tubefoot_python
	@test -n "$(PYTHON_SITE)" || { echo "/usr/bin/python3 knows no folder of this user: make python PYTHON_SITE=FOLDER" >&2; exit 1; }
	@mkdir -p "$(PYTHON_SITE)"
	@rm -rf "$(PYTHON_SITE)/tubefoot"
	@cp -r build/release/python/tubefoot "$(PYTHON_SITE)/"
	@/usr/bin/python3 -c "import sys; sys.path.insert(0, '$(PYTHON_SITE)'); import tubefoot; \
	  print('tubefoot', tubefoot.__version__, 'for /usr/bin/python3 is in', tubefoot.__path__[0])"

test: build
	cmake --build --preset release --parallel $(JOBS)
	@echo "The tests with the label slow are left out: make test-slow"
	ctest --preset release --parallel $(JOBS) --label-exclude slow

test-slow: build
	cmake --build --preset release --parallel $(JOBS)
	ctest --preset release --parallel $(JOBS) --label-regex slow

# One test or suite of the test programs, with * and ?: NAME='Hostile.*'. Scripts: ctest --test-dir build/release -R NAME.
one-test: build
	cmake --build --preset release --parallel $(JOBS)
	@for program in build/release/tests/*_tests; do \
	  ! $$program --gtest_filter='$(NAME)' --gtest_list_tests | grep -q '^  ' || { found=1; $$program --gtest_filter='$(NAME)' || exit; }; \
	done; test -n "$$found" || { echo "no test is called '$(NAME)'" >&2; exit 2; }

# Where the program goes, so that its man pages, completion and find_package(tubefoot) are found: below PREFIX. As root
# into the default, or into a folder of one's own. DESTDIR, if set, comes before it.
PREFIX := /usr/local

install: whole
	cmake --install build/release --prefix $(abspath $(PREFIX)) >build/install.log || { cat build/install.log; exit 1; }
	@echo "tubefoot is in $(DESTDIR)$(abspath $(PREFIX))/bin"

package: whole
	@tools/setup packages
	@cpack --config build/release/CPackConfig.cmake -B build >build/package.log || { cat build/package.log; exit 1; }
	@rm -rf build/_CPack_Packages
	@ls build/*.deb

wheel: program
	@tools/setup python wheel
	@$(CONFIGURE_PROGRAM)
	cmake --build --preset release --parallel $(JOBS) --target tubefoot_python
	@/usr/bin/python3 tools/wheel build/release build

# The program alone, or all that is configured with the tests, once they were: then it stays so.
# WARNINGS_AS_ERRORS=ON stops at a compiler's warning, as CI does; unset, the folder keeps what it had.
configure = cmake --preset release -Wno-dev $(if $(WARNINGS_AS_ERRORS),-DTUBEFOOT_WARNINGS_AS_ERRORS=$(WARNINGS_AS_ERRORS)) $(1) >build/configure.log 2>&1 || { cat build/configure.log; exit 1; }
CONFIGURE_PROGRAM = tests=$$(grep -qs TUBEFOOT_TESTS:BOOL=ON build/release/CMakeCache.txt && echo ON || echo OFF); \
  $(call configure,-DTUBEFOOT_TESTS=$$tests -DTUBEFOOT_BENCH=$$tests)

program:
	@mkdir -p build
	@tools/setup program
	@[ -e $(PROGRAM) ] || echo "tubefoot: building takes about $(MINUTES) minutes of one processor; here are $(JOBS)"
	@$(CONFIGURE_PROGRAM)
	cmake --build --preset release --parallel $(JOBS) --target tubefoot

# All that is installed.
whole: program
	@tools/setup python cluster
	@$(CONFIGURE_PROGRAM)
	cmake --build --preset release --parallel $(JOBS) --target tubefoot_manual tubefoot_python tubefoot_mpi

# Minutes of one processor that the program takes to build from nothing.
MINUTES := 20

# With tests, benchmarks and studies.
build: configured
	cmake --build --preset release --parallel $(JOBS) --target tubefoot

configured:
	@mkdir -p build
	@tools/setup program python cluster packages wheel documents figures tests
	@$(call configure,-DTUBEFOOT_TESTS=ON -DTUBEFOOT_BENCH=ON)

sanitize: configured
	@tools/setup sanitizers
	tools/instrumented_tbb build/tbb-thread
	@for preset in dev thread; do \
	  cmake --preset $$preset -Wno-dev >build/configure.log 2>&1 || { cat build/configure.log; exit 1; }; \
	  cmake --build --preset $$preset --parallel $(JOBS) || exit 1; \
	done
	ctest --preset dev --parallel $(JOBS); first=$$?; ctest --preset thread --parallel $(JOBS) && exit $$first

PROVE_TUBES := 10000000
PROVE_SEED := 1

prove: build
	cmake --build --preset release --parallel $(JOBS) --target tubefoot_prove
	@mkdir -p validation
	build/release/tubefoot_prove --tubes $(PROVE_TUBES) --seed $(PROVE_SEED) --threads $(JOBS) \
	  --report validation/prove.md

FUZZ_SECONDS := 3600
FUZZ_TARGETS := all
FUZZ_JOBS := 2

fuzz: configured
	@tools/setup sanitizers
	@cmake --preset dev -Wno-dev >build/configure-dev.log 2>&1 || { cat build/configure-dev.log; exit 1; }
	cmake --build --preset dev --parallel $(JOBS) --target fuzz_targets
	@tests/fuzz/run build/dev/fuzz --seconds $(FUZZ_SECONDS) --targets $(FUZZ_TARGETS) --jobs $(FUZZ_JOBS)

AGAINST := HEAD~1

against: build
	validation/bench/against $(AGAINST) --jobs $(JOBS)

bench: configured
	cmake --preset bench -Wno-dev
	cmake --build --preset bench --parallel $(JOBS)
	build/bench/tubefoot_bench

atlas: configured
	cmake --build --preset release --parallel $(JOBS) --target tubefoot_atlas
	build/release/tubefoot_atlas validation

advise-study: build
	cmake --build --preset release --parallel $(JOBS) --target tubefoot_advise_study
	build/release/tubefoot_advise_study validation/advise.md scenes/chart/*.toml scenes/*/scene.toml

pairs: build
	cmake --build --preset release --parallel $(JOBS) --target tubefoot_pairs
	build/release/tubefoot_pairs validation/pairs.md

refraction-study: build
	cmake --build --preset release --parallel $(JOBS) --target tubefoot_refraction_study
	@mkdir -p out
	build/release/tubefoot_refraction_study scenes/refraction/scene.toml out/refraction.png

track-study: build
	cmake --build --preset release --parallel $(JOBS) --target tubefoot_track_study
	@mkdir -p out
	build/release/tubefoot_track_study scenes/textures/track.toml out/track.png out/drift.png

rays: build
	cmake --build --preset release --parallel $(JOBS) --target tubefoot_rays
	build/release/tubefoot_rays validation/rays.md

engines: build
	cmake --build --preset release --parallel $(JOBS) --target tubefoot_hurried_rays
	/usr/bin/python3 -B validation/engines/run.py $(PROGRAM) build/release/tubefoot_hurried_rays.so out/engines \
	  --results validation/engines/results.json --page validation/engines.md

real-engines: build
	cmake --build --preset release --parallel $(JOBS) --target tubefoot_hurried_rays
	/usr/bin/python3 -B validation/engines/run.py $(PROGRAM) build/release/tubefoot_hurried_rays.so out/real-engines --real \
	  --results validation/engines/results-real.json --page validation/real-engines.md
	rm -rf out/suite
	$(PROGRAM) suite --quiet -o out/suite
	/usr/bin/python3 -B validation/engines/real/suite.py $(PROGRAM) out/suite out/real-suite --entries validation/results/entries
	/usr/bin/python3 -B validation/results/page.py

SCALING_ROUNDS := 3

scaling: build
	@rm -f build/scaling.json
	/usr/bin/python3 -B validation/scaling/study.py $(PROGRAM) validation/scaling.md validation/pictures build/scaling.json --rounds $(SCALING_ROUNDS)

gradients: build
	PYTHONPATH=build/release/python /usr/bin/python3 -B validation/gradients/study.py validation/gradients.md validation/pictures

LONG_RUN_PINGS := 10000

long-run: build
	/usr/bin/python3 -B validation/scaling/long_run.py $(PROGRAM) validation/pictures/long-run.svg $(LONG_RUN_PINGS)

reference: build
	tools/reference_suite $(PROGRAM) validation/reference/v1

reference-sums: build
	tools/suite_sums $(PROGRAM) 2 validation/reference/v2/SHA256SUMS
	tools/suite_sums $(PROGRAM) 3 validation/reference/v3/SHA256SUMS

DOI :=

benchmark-archive: build
	tools/benchmark_archive $(PROGRAM) build/benchmark $(if $(DOI),--doi $(DOI))

docs:
	@tools/setup documents
	@/usr/bin/python3 docs/site/build.py build/docs

FIGURES :=

figures: build
	cmake --build --preset release --parallel $(JOBS) --target tubefoot_refraction_study tubefoot_track_study
	/usr/bin/python3 docs/figures/draw.py $(PROGRAM) $(FIGURES)

SOURCES = $(shell git ls-files '*.cpp' '*.hpp')

format:
	clang-format -i $(SOURCES)

tidy: build
	clang-tidy -p build/release $(filter %.cpp,$(filter-out tests/% validation/bench/%,$(SOURCES)))

clean:
	rm -rf build out
