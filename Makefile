# Every target can be the first one run on a fresh Debian 12 (root or sudo).
PRESET ?= release

.PHONY: reproduce test bench stress format tidy clean build packages packages-test

build: packages
	@cmake --preset $(PRESET) >/dev/null
	@cmake --build --preset $(PRESET)

packages:
	@cmake/install_packages.sh run

packages-test:
	@cmake/install_packages.sh test

test: packages-test
	@cmake --preset $(PRESET) -DMODCAL_WERROR=ON >/dev/null
	@cmake --build --preset $(PRESET)
	@ctest --preset $(PRESET) --parallel $$(nproc)

format:
	@git ls-files -co --exclude-standard -- '*.cpp' '*.hpp' | xargs ls 2>/dev/null | xargs clang-format -i

clean:
	@cmake -E rm -rf build
