# Every target can be the first one run on a fresh Debian 12 (root or sudo).
PRESET ?= release
# Further options of CMake's, such as -DMODCAL_WERROR=ON.
OPTIONS ?=

.PHONY: reproduce test test-delivery sanitize fuzz mutation test-cluster python bench accuracy stress format tidy tidy-changed docs clean build
.PHONY: packages packages-test packages-python packages-cluster packages-develop packages-fuzz

build: packages
	@cmake --preset $(PRESET) $(OPTIONS) >/dev/null
	@cmake --build --preset $(PRESET) --target modcal

packages:
	@cmake/install_packages.sh

packages-test:
	@cmake/install_packages.sh test

packages-python:
	@cmake/install_packages.sh python

packages-cluster:
	@cmake/install_packages.sh cluster

packages-fuzz:
	@cmake/install_packages.sh fuzz

packages-develop:
	@cmake/install_packages.sh develop

reproduce: build
	@build/$(PRESET)/modcal reproduce table1

# All that tells whether a change is right; LABELS takes other tests of the same build.
LABELS ?= --label-exclude delivery
test:
	@cmake/install_packages.sh test python
	@cmake --preset $(PRESET) -DMODCAL_WERROR=ON -DMODCAL_PYTHON=ON >/dev/null
	@cmake --build --preset $(PRESET)
	@ctest --preset $(PRESET) --parallel $$(($$(nproc) + 1)) $(LABELS)

# What is handed out (packages, wheel, reports in a browser and as PDFs, the pages' programs), and full disks, kills.
test-delivery:
	@$(MAKE) --no-print-directory test LABELS='--label-regex delivery'

# Addresses, undefined behavior and threads: the tests that tests/CMakeLists.txt lists for them, or a GROUP of its own.
SANITIZERS ?= asan-ubsan tsan
sanitize: packages-test packages-fuzz
	@for preset in $(SANITIZERS); do \
	  cmake --preset $$preset >/dev/null && \
	  cmake --build --preset $$preset $(if $(GROUP),--target $(GROUP)_tests) && \
	  ctest $(if $(GROUP),--test-dir build/$$preset --label-regex $(GROUP) --output-on-failure,--preset $$preset) \
	    --parallel $$(nproc) || exit 1; \
	done

# Each fuzzer for SECONDS; 0: the corpora once. What they find: build/asan-ubsan/findings.
SECONDS ?= 60
fuzz: packages-test packages-fuzz
	@cmake --preset asan-ubsan >/dev/null
	@cmake --build --preset fuzz
	@tests/fuzz/run.sh build/asan-ubsan $(SECONDS)

# The package of Python: build/release/python.
python: packages-python
	@cmake --preset $(PRESET) -DMODCAL_PYTHON=ON >/dev/null
	@cmake --build --preset $(PRESET) --target modcal modcal_python_package
	@ctest --preset $(PRESET) --tests-regex '^python_'

# The typed stub of the module, from the module.
.PHONY: stubs
stubs: packages-python
	@cmake --preset $(PRESET) -DMODCAL_PYTHON=ON >/dev/null
	@cmake --build --preset $(PRESET) --target modcal_python_package
	@PYTHONPATH=build/$(PRESET)/python /usr/bin/python3 python/core/stubs.py > build/$(PRESET)/python/new.pyi
	@mv build/$(PRESET)/python/new.pyi python/modcal/_core.pyi

# Small wrong changes to the kernels: COUNT of them, drawn by SEED; those that no test sees are printed.
SEED ?= 1
COUNT ?= 20
mutation: packages-test
	@cmake --preset mutation >/dev/null
	@cmake --build --preset mutation
	@tests/mutation/mutate.py . build/mutation --seed $(SEED) --count $(COUNT)

test-cluster: packages-cluster
	@cmake --preset $(PRESET) >/dev/null
	@cmake --build --preset $(PRESET) --target modcal modcal-mpi
	@tests/cluster/test_cluster.sh build/$(PRESET)

bench: packages
	@cmake --preset $(PRESET) >/dev/null
	@cmake --build --preset $(PRESET) --target modcal benchmarks/all
	@benchmarks/run.sh build/$(PRESET)

accuracy: packages
	@cmake --preset $(PRESET) >/dev/null
	@cmake --build --preset $(PRESET) --target work_precision perturbation_growth random_scenes regularizer_error
	@benchmarks/accuracy/run.sh build/$(PRESET) docs/accuracy

stress: packages
	@cmake --preset $(PRESET) >/dev/null
	@cmake --build --preset $(PRESET) --target stability_map
	@benchmarks/stress/run.sh build/$(PRESET)

# What configs/ give at test size: bits for 1, 2 and 8 threads, digests by instruction set.
.PHONY: digests
digests: packages
	@cmake --preset $(PRESET) >/dev/null
	@cmake --build --preset $(PRESET) --target digests_test
	@build/$(PRESET)/tests/digests_test
	@for set in baseline avx2; do MODCAL_INSTRUCTIONS=$$set build/$(PRESET)/tests/digests_test || [ $$? -eq 77 ]; done

# The site: build/release/docs/html/index.html.
docs: packages-test
	@cmake/site/build.sh build/$(PRESET)/docs

format: packages-develop
	@git ls-files -co --exclude-standard -- '*.cpp' '*.hpp' | xargs ls 2>/dev/null | xargs clang-format -i

tidy: packages packages-develop
	@cmake --preset tidy >/dev/null
	@cmake --build --preset tidy

# The sources that commits of the HOURS before the last one changed.
HOURS ?= 24
tidy-changed: packages packages-test packages-develop
	@cmake --preset tidy -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >/dev/null
	@cmake --build --preset tidy --target modcal_build_info >/dev/null
	@last=$$(git log -1 --format=%ct) && \
	  changed=$$(git log --since=$$((last - 3600 * $(HOURS))) --name-only --format= -- '*.cpp') && \
	  files=$$(for file in $$(echo "$$changed" | sort -u); do if [ -f $$file ]; then echo "^$$PWD/$$file\$$"; fi; done) && \
	  echo "clang-tidy: $$(echo "$$files" | grep -c .) files; those of python/ are not built and left out" && \
	  if [ -n "$$files" ]; then run-clang-tidy -quiet -j $$(nproc) -p build/tidy $$files; fi

clean:
	@cmake -E rm -rf build

.PHONY: calibration
calibration: packages
	@cmake --preset $(PRESET) >/dev/null
	@cmake --build --preset $(PRESET) --target calibration_work_precision objective_bias
	@benchmarks/accuracy/calibration.sh build/$(PRESET) docs/calibration

# Error bars on records of another program: 324 calibrations, resumed where they stopped.
.PHONY: coverage
coverage: packages
	@cmake --preset $(PRESET) >/dev/null
	@cmake --build --preset $(PRESET) --target modcal truth
	@benchmarks/truth/score.py build/$(PRESET) build/$(PRESET)/coverage --jobs $$(nproc)
