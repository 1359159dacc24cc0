# shellcheck shell=bash
# Runs the steps of ./tools/test, keeps their results, prints them. Sourced by tools/test.

PASSED=()
FAILED=()
SUMMARIES=()

# summary_of LOG: the closing line of ctest or pytest, in the runner's own words.
summary_of() {
    grep -E '^[0-9]+% tests passed|^=+ .*(passed|failed|error).* =+$' "$1" | tail -n 1 || true
}

# step NAME COMMAND...: output goes to build/logs/test-NAME.log; its end is shown on failure.
step() {
    local name="$1" start_s=$SECONDS summary status=0
    shift
    run_logged "test-$name" "$@" || status=$?
    summary="$(summary_of "$LOG_DIR/test-$name.log")"
    [ -z "$summary" ] || SUMMARIES+=("$summary")
    if ((status == 0)); then
        PASSED+=("$name")
        printf 'ok    %-15s %4d s\n' "$name" $((SECONDS - start_s))
    else
        FAILED+=("$name")
        tail -n 60 "$LOG_DIR/test-$name.log"
        printf 'FAIL  %-15s %4d s  (build/logs/test-%s.log)\n' "$name" $((SECONDS - start_s)) "$name"
    fi
    return "$status"
}

# build PRESET: a step of its own, once.
build() {
    [[ " ${PASSED[*]} " != *" build-$1 "* ]] || return 0
    [[ " ${FAILED[*]} " != *" build-$1 "* ]] || return 1
    local start_s=$SECONDS
    # In a subshell: build_preset ends its script on failure.
    if (build_preset "$1"); then
        PASSED+=("build-$1")
        printf 'ok    %-15s %4d s\n' "build-$1" $((SECONDS - start_s))
    else
        FAILED+=("build-$1")
        printf 'FAIL  %-15s %4d s  (build/logs/build-%s.log)\n' "build-$1" $((SECONDS - start_s)) "$1"
        return 1
    fi
}

run_ctest() {
    ctest --preset "$1" --parallel "$(nproc)" --no-tests=error
}

run_pytest() {
    # A file stays with one worker: its fixtures run once.
    .venv/bin/python -m pytest tests/python --numprocesses "$(nproc)" --dist loadfile --durations=10
}

run_pytest_package() {
    .venv/bin/python -m pytest tests/system/package --durations=10
}

run_pytest_vm() {
    .venv/bin/python -m pytest tests/system/vm --durations=5
}

run_coverage() {
    .venv/bin/python -m gcovr --root . --object-directory build/coverage --filter firmware/ \
        --exclude firmware/comm/generated/ --print-summary --fail-under-line 98
}

# report: every step, then the runners' own closing lines; false iff a step failed.
report() {
    echo
    ((${#FAILED[@]} == 0)) || printf 'failed: %s\n' "${FAILED[*]}"
    printf 'steps: %d passed, %d failed\n' "${#PASSED[@]}" "${#FAILED[@]}"
    ((${#SUMMARIES[@]} == 0)) || printf '%s\n' "${SUMMARIES[@]}"
    ((${#FAILED[@]} == 0))
}
