# shellcheck shell=bash
# The sections of ./tools/test: which steps each holds and what they need. WHOLE 1: all that it can
# hold; 0: what the submit tier has of it. Sourced by tools/test.

WHOLE=1
# The full one of identify takes hours, that of laws half an hour. The longest first: two at a time, most of
# them keep one processor busy.
BENCHMARKS=(papers "identify --quick" "tables --quick" trust "install --quick" fuzzy control "laws --quick"
    "sweep --quick" controller lock board signal can "unseen --quick" house)
# With the machine to themselves: they use all processors, or time what people wait for.
LONE_BENCHMARKS=("campaign --quick" "live --quick")

run_ctest() {
    ctest --preset "$1" --parallel "$(nproc)" --no-tests=error
}

# run_ctest_of FOLDER REGEX [OPTION...]: those tests of one folder of a build.
run_ctest_of() {
    ctest --test-dir "build/$1" --tests-regex "$2" --parallel "$(nproc)" --output-on-failure \
        --no-tests=error "${@:3}"
}

# run_pytest MARKS [PATH...]: a file stays with one worker: its fixtures run once.
run_pytest() {
    local paths=("${@:2}")
    ((${#paths[@]} > 0)) || paths=(tests/python)
    .venv/bin/python -m pytest -m "$1" --numprocesses "$(nproc)" --dist loadfile --durations=20 \
        "${paths[@]}"
}

run_pytest_of() {
    .venv/bin/python -m pytest "$1" --durations=10
}

# run_tidy_changed: at most 24 sources, those that changed most.
run_tidy_changed() {
    local text files=()
    text="$(changed_lines | touched tidy)" || return
    [ -z "$text" ] || mapfile -t files <<<"$text"
    printf 'changed: %s\n' "${files[*]:-nothing that clang-tidy reads}"
    ((${#files[@]} == 0)) || "$ROOT/tools/check/tidy" "${files[@]}"
}

run_coverage() {
    .venv/bin/python -m gcovr --root . --object-directory build/coverage --filter firmware/ \
        --exclude firmware/comm/generated/ --print-summary --fail-under-line 98
}

section_unit() {
    wants ctest-host && build host && step ctest-host run_ctest host
}

section_target() {
    wants ctest-mps2 && build mps2 && step ctest-mps2 run_ctest mps2
}

section_m32() {
    wants ctest-m32 && build m32 && step ctest-m32 run_ctest m32
}

section_ports() {
    local port
    for port in "${PORTS[@]}"; do
        if wants "ctest-$port" && "$ROOT/tools/setup" ports && build "$port"; then
            step "ctest-$port" run_ctest "$port"
        fi
    done
    for port in "${SIZED_PORTS[@]}"; do
        if wants "sizes-$port" && build "$port"; then
            step "sizes-$port" arm-none-eabi-size --totals "build/$port/firmware/libquiesce_core.a"
        fi
    done
}

section_sanitize() {
    ((WHOLE == 0)) || {
        wants ctest-sanitize && build sanitize && step ctest-sanitize run_ctest sanitize
        return
    }
    local area
    area="$(changed_lines | touched area)" || fail "cannot tell what changed"
    wants "ctest-sanitize-$area" && build mps2 && build sanitize "tests/unit/$area/all" &&
        step "ctest-sanitize-$area" run_ctest_of "sanitize/tests/unit/$area" . --exclude-regex '^fuzz_'
}

section_lint() {
    local gate tidy=tidy tidy_command="$ROOT/tools/check/tidy"
    ((WHOLE == 1)) || tidy=tidy-changed tidy_command=run_tidy_changed
    # clang-tidy reads the compile commands of all three builds.
    if wants "$tidy" && build host && build mps2 && build stm32f4; then step "$tidy" "$tidy_command"; fi
    for gate in format cppcheck generated scripts ruff; do
        if wants "$gate"; then step "$gate" "$ROOT/tools/check/$gate"; fi
    done
}

section_python() {
    wants pytest && build host && build mps2 && build stm32f4 && step pytest run_pytest "not slow"
    ((WHOLE == 1)) && wants pytest-slow && build host && build mps2 && build stm32f4 && build m32 &&
        step bench-images "$ROOT/tools/benchmarks/build_images" &&
        step browser "$ROOT/tools/benchmarks/fetch_peers" browser && step pytest-slow run_pytest slow
}

section_proofs() {
    wants proofs || return 0
    if command -v frama-c >/dev/null; then
        step proofs "$ROOT/tools/check/eva"
    else
        absent proofs "Frama-C is not installed (Debian package frama-c-base)"
    fi
}

section_package() {
    # tools/package sets up what the arm64 build needs, too.
    if wants pytest-package; then
        step package "$ROOT/tools/package" && step package-roots "$ROOT/tools/package" --root &&
            step package-kernel "$ROOT/tests/system/vm/build_images" kernel &&
            step pytest-package run_pytest_of tests/system/package
    fi
    wants ctest-arm64 && step arm64-libraries "$ROOT/tests/system/vm/build_images" root &&
        build arm64 && step ctest-arm64 run_ctest arm64
}

section_vm() {
    wants pytest-vm && build host && step vm-images "$ROOT/tests/system/vm/build_images" &&
        step pytest-vm run_pytest_of tests/system/vm
}

section_benchmarks() {
    local name call wanted=() lone=()
    for name in "${BENCHMARKS[@]}" "${LONE_BENCHMARKS[@]}"; do
        read -r -a call <<<"$name"
        wants "bench-${call[0]}" || continue
        if [[ " ${BENCHMARKS[*]} " == *" $name "* ]]; then wanted+=("$name"); else lone+=("$name"); fi
    done
    ((${#wanted[@]} + ${#lone[@]} > 0)) && build host && build mps2 || return 0
    ((${#wanted[@]} == 0)) || side_by_side "$(($(nproc) > 1 ? 2 : 1))" benchmark_step "${wanted[@]}"
    for name in "${lone[@]}"; do
        benchmark_step "$name"
    done
}

# benchmark_step "NAME [OPTION]"
benchmark_step() {
    local call
    read -r -a call <<<"$1"
    step "bench-${call[0]}" .venv/bin/python tools/check/benchmark.py "${call[@]}" &&
        drop_unjudged "bench-${call[0]}"
}

# drop_unjudged STEP: a figure that could not be judged here is no reason to keep it.
drop_unjudged() {
    ! grep -q '^not judged: ' "$LOG_DIR/test-$1.log" || stamp_write "$1" unjudged
}

section_coverage() {
    wants coverage && build coverage && step ctest-coverage run_ctest coverage &&
        step coverage run_coverage && tail -n +2 "$LOG_DIR/test-coverage.log"
}

# edit_steps: tests and gates of the files that differ from the last commit.
edit_steps() {
    local plan found=()
    plan="$(edited_files | touched edit)" || fail "cannot tell what was edited"
    [ -n "$plan" ] || say "nothing to test: no file with a test differs from the last commit"
    # planned KIND: what the plan says of it, into `found`.
    planned() {
        mapfile -t found < <(sed -n "s/^$1 \\?//p" <<<"$plan")
        ((${#found[@]} > 0))
    }
    if planned format; then step format clang-format-14 --dry-run --Werror "${found[@]}"; fi
    if planned ruff; then step ruff .venv/bin/python -m ruff check --no-cache "${found[@]}"; fi
    if planned script; then step scripts shellcheck --external-sources "${found[@]}"; fi
    if planned generated; then step generated "$ROOT/tools/check/generated"; fi
    if planned unit; then edit_units "${found[@]}"; fi
    if planned board && build mps2; then step ctest-mps2 run_ctest_of mps2/tests/unit/mps2 .; fi
    if planned pytest && build host sim_hil/all && build mps2 targets/all && build stm32f4; then
        step pytest run_pytest_edited "${found[@]}"
    fi
}

# run_pytest_edited PATH...: where all tests of a file are slow, none is left to run: pytest's 5.
run_pytest_edited() {
    run_pytest "not slow" "$@" || (($? == 5))
}

# edit_units "FOLDER TARGETS REGEX"...
edit_units() {
    local line folder targets all=() regex
    for line in "$@"; do
        read -r folder targets regex <<<"$line"
        IFS=, read -r -a targets <<<"$targets"
        all+=("${targets[@]}")
    done
    build host "${all[@]}" || return 1
    for line in "$@"; do
        read -r folder targets regex <<<"$line"
        step "ctest-${folder##*/}" run_ctest_of "host/tests/$folder" "$regex"
    done
}
