# Every command of gnomon's README. Each first installs what is missing; a second run needs no network.
SHELL := /bin/bash
CARGO ?= cargo
GNOMON = $(or $(CARGO_TARGET_DIR),target)/release/gnomon
DEMO = out/demo
# Vulkan loaders complain on standard error without one.
export XDG_RUNTIME_DIR ?= $(CURDIR)/out/xdg

.PHONY: help setup oracle demo test bench docs pictures clean

help: ## this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "make %-8s %s\n", $$1, $$2 }' Makefile

setup: ## a Vulkan driver and the two large meshes, where missing
	@mkdir -p -m 700 '$(XDG_RUNTIME_DIR)'
	setup/vulkan.sh
	setup/meshes.sh

oracle: ## Mitsuba, the second oracle, in oracle/.venv
	setup/oracle.sh

demo: setup oracle ## judge three scenes' shadows; report and pictures go to out/demo
	@echo '==> building gnomon'
	$(CARGO) build --release --locked
	@echo '==> judging shadows (a budget exceeded, exit status 1, is a result)'
	rm -rf $(DEMO)
	$(GNOMON) check scenes/torus scenes/room scenes/kitchen --out $(DEMO) --format html || [ $$? -eq 1 ]
	@echo '==> rendering the room'
	$(GNOMON) render scenes/room -o $(DEMO)/room.png
	@echo '==> pictures:'
	@ls $(DEMO)/*.png
	@echo '==> report, for a browser: $(DEMO)/report.html; for programs: $(DEMO)/report.json'

test: setup oracle ## format, lints, documentation and every test
	setup/rust.sh
	setup/chromium.sh
	@echo '==> format'
	$(CARGO) fmt --check
	@echo '==> lints'
	$(CARGO) clippy --all-targets --locked -- -D warnings
	@echo '==> documentation'
	RUSTDOCFLAGS='-D warnings' $(CARGO) doc --no-deps --document-private-items --locked
	@echo '==> oracle'
	cd oracle && .venv/bin/ruff format --check . && .venv/bin/ruff check . && .venv/bin/mypy gnomon_oracle tests
	cd oracle && .venv/bin/python -m pytest
	@echo '==> tests'
	mkdir -p out
	set -o pipefail; $(CARGO) test --locked --no-fail-fast | tee out/test.log
	@awk '/^test result:/ { suites++; for (i = 2; i <= NF; i++) { \
	        if ($$i ~ /^passed/) passed += $$(i - 1); if ($$i ~ /^ignored/) ignored += $$(i - 1) } } \
	    END { printf "==> %d tests passed in %d suites, %d ignored; log: out/test.log\n", passed, suites, ignored; \
	        exit passed == 0 }' out/test.log

bench: setup ## measure speed and memory, as ratios within one run
	$(CARGO) bench --locked

docs: ## the library's documentation
	$(CARGO) doc --no-deps --locked
	@echo '==> $(or $(CARGO_TARGET_DIR),target)/doc/gnomon/index.html'

pictures: setup ## the pictures of README and docs, drawn again
	$(CARGO) build --release --locked
	docs/pictures.sh $(GNOMON)

clean: ## remove what was built and reported; the large meshes stay
	$(CARGO) clean
	rm -rf out
