# shellcheck shell=bash
# Runs the steps of ./tools/test, keeps their results, prints them. Sourced by tools/test.
# shellcheck source=tools/lib/stamps.sh
source "$ROOT/tools/lib/stamps.sh"

# MODE: run (each step), resume (those that have not passed on these inputs), list (none).
MODE=run
PASSED=()
KEPT=()
FAILED=()
ABSENT=()
SUMMARIES=()
RECORDS=() # one line a step: name|result|seconds|CPU seconds|closing line or reason
ALIVE_EVERY_S=60
STAMPED=1 # 0: what passes is a part of its step, and no reason to keep the whole later
# Nothing outside of a git tree, where no step is kept.
FILES_AT_START=""
if git -C "$ROOT" rev-parse --git-dir >/dev/null 2>&1; then FILES_AT_START="$(files_hash .)"; fi

# summary_of LOG: the closing line of ctest, pytest or a benchmark, in the runner's own words.
summary_of() {
    grep -E '^[0-9]+% tests passed|^=+ .*(passed|failed|error).* =+$|^figures: ' "$1" 2>/dev/null |
        tail -n 1 || true
}

record() {
    RECORDS+=("$1|$2|$3|$4|$5")
}

# wants STEP: false where it need not run: listed only, or passed on these very inputs.
wants() {
    if [ "$MODE" = list ]; then
        list_step "$1"
        return 1
    fi
    [ "$MODE" = resume ] && has_passed "$1" || return 0
    local line
    line="$(stamp_field "$1" 4)"
    KEPT+=("$1")
    [ -z "$line" ] || SUMMARIES+=("$line")
    record "$1" kept "$(stamp_field "$1" 2)" "$(stamp_field "$1" 3)" "$line"
    printf 'kept  %-20s       passed before on these inputs\n' "$1"
    return 1
}

# say_alive NAME: a line a minute until its standard input ends.
say_alive() {
    local start_s=$SECONDS status
    while true; do
        status=0
        read -r -t "$ALIVE_EVERY_S" _ || status=$?
        ((status > 128)) || return 0
        say "...   $1 $((SECONDS - start_s)) s"
    done
}

# step NAME COMMAND...: output goes to build/logs/test-NAME.log; its end is shown on failure.
step() {
    local name="$1" start_s=$SECONDS log="$LOG_DIR/test-$1.log" hash cpu alive status=0
    local TIMEFORMAT='%0U+%0S'
    shift
    hash="$(inputs_hash "$name")"
    exec {alive}> >(say_alive "$name")
    # In the foreground: a command in the background would not see Ctrl-C.
    cpu="$({ time run_logged "test-$name" "$@"; } 2>&1 {alive}>&-)" || status=$?
    exec {alive}>&-
    ((status == 0)) || tail -n 60 "$log"
    step_done "$name" "$status" "$hash" $((SECONDS - start_s)) $((cpu)) "$(summary_of "$log")" \
        "test-$name"
    return "$status"
}

# has_changed: a file, since this run began. Programs are built once a run: what a later step passes
# with may be what was before.
has_changed() {
    [ -n "$FILES_AT_START" ] && [ "$(files_hash .)" != "$FILES_AT_START" ]
}

# step_done NAME STATUS HASH SECONDS CPU_S LINE LOG: a step without a hash is run every time.
step_done() {
    local word=ok result=passed where=""
    rm -f "$ROOT/build/tested/$1"
    [ -z "$6" ] || SUMMARIES+=("$6")
    if (($2 == 0)); then
        PASSED+=("$1")
        [ -z "$3" ] || ((STAMPED == 0)) || has_changed || stamp_write "$1" "${@:3:4}"
    else
        FAILED+=("$1")
        stamp_write "$1" failed
        word=FAIL result=FAILED where="  (build/logs/$7.log)"
    fi
    record "$1" "$result" "$4" "$5" "$6"
    printf '%-5s %-20s %4d s %5d s of CPU%s\n' "$word" "$1" "$4" "$5" "$where"
}

# absent NAME REASON: a step that this machine cannot run. Said, and never counted as passed.
absent() {
    ABSENT+=("$1")
    record "$1" absent 0 0 "$2"
    printf 'none  %-20s %s\n' "$1" "$2"
}

# build PRESET [TARGET...]: a step of its own; a whole one once.
build() {
    local name="build-$1${2:+-part}" start_s=$SECONDS cpu alive status=0 TIMEFORMAT='%0U+%0S'
    (($# > 1)) || [[ " ${PASSED[*]} " != *" $name "* ]] || return 0
    (($# > 1)) || [[ " ${FAILED[*]} " != *" $name "* ]] || return 1
    exec {alive}> >(say_alive "$name")
    # In a subshell: build_preset ends its script on failure. What it says goes on to stderr.
    { cpu="$({ time (build_preset "$@" 2>&3); } 2>&1 {alive}>&-)"; } 3>&2 || status=$?
    exec {alive}>&-
    step_done "$name" "$status" "" $((SECONDS - start_s)) $((cpu)) "" "build-$1"
    return "$status"
}

# list_step STEP: its name, and those of its tests where they can be told.
list_step() {
    printf '%s\n' "$1"
    case "$1" in
    pytest) list_pytest "$1" tests/python -m "not slow" ;;
    pytest-slow) list_pytest "$1" tests/python -m slow ;;
    pytest-package) list_pytest "$1" tests/system/package ;;
    pytest-vm) list_pytest "$1" tests/system/vm ;;
    ctest-*)
        if [ -f "build/${1#ctest-}/CTestTestfile.cmake" ]; then
            ctest --preset "${1#ctest-}" -N | grep -v '_NOT_BUILT$' |
                sed -n -E "s/^ *Test +#[0-9]+: /$1 /p"
        else
            say "$1: its tests can be named once build/${1#ctest-} is there"
        fi
        ;;
    esac
}

list_pytest() {
    .venv/bin/python -m pytest "${@:2}" --collect-only -q | grep '::' | sed "s/^/$1 /"
}

# report: every step, then the runners' own closing lines; false iff a step failed.
report() {
    echo
    ((${#FAILED[@]} == 0)) || printf 'failed: %s\n' "${FAILED[*]}"
    ((${#ABSENT[@]} == 0)) || printf 'not run here: %s\n' "${ABSENT[*]}"
    printf 'steps: %d passed, %d failed' "${#PASSED[@]}" "${#FAILED[@]}"
    ((${#KEPT[@]} == 0)) && echo || printf ', %d kept\n' "${#KEPT[@]}"
    ((${#SUMMARIES[@]} == 0)) || printf '%s\n' "${SUMMARIES[@]}"
    ((${#FAILED[@]} == 0))
}

# summary_hash STEP RESULT: of the inputs it passed with; "-" where that is no reason to keep it.
summary_hash() {
    local hash=""
    [[ "$2" != passed && "$2" != kept ]] || hash="$(stamp_field "$1" 1 | grep -E '^[0-9a-f]+$')" || true
    hash="${hash:0:HASH_LENGTH}"
    echo "${hash:--}"
}

# write_summary: what `all` did, for the repository, and for who goes on with it.
write_summary() {
    local entry name result wall_s cpu_s line total_s=0 changed="" reached=" " before=""
    [ ! -f "$ROOT/$TEST_SUMMARY" ] || before="$(<"$ROOT/$TEST_SUMMARY")"
    git diff --quiet HEAD -- . ":!$TEST_SUMMARY" 2>/dev/null || changed=", with changes of its files"
    {
        echo "# What ./tools/test all last ran"
        echo
        echo "Written by \`./tools/test all\`. A step that is kept passed before on the same inputs, here or on another"
        echo "machine; \`before\`: this run has not reached it, an earlier one passed it on these inputs or others."
        echo
        echo "- commit $(git rev-parse --short=12 HEAD 2>/dev/null || echo unknown)$changed"
        echo "- files $(files_hash . | cut -c1-16) (their hash, without this one)"
        echo "- $(date -u +%Y-%m-%d), $(nproc) processors, $(uname -m)"
        echo
        echo "| step | result | inputs | time | CPU time | |"
        echo "|---|---|---|---|---|---|"
        for entry in "${RECORDS[@]}"; do
            IFS='|' read -r name result wall_s cpu_s line <<<"$entry"
            line="$(sed -E 's/^=+ //; s/ =+$//' <<<"$line")"
            echo "| $name | $result | $(summary_hash "$name" "$result") | $wall_s s | $cpu_s s | $line |"
            total_s=$((total_s + wall_s))
            reached+="$name "
        done
        while IFS='|' read -r _ name result line; do
            name="${name// /}" result="${result// /}"
            [[ "$result" =~ ^(passed|kept|before)$ && "$line" =~ ^\ [0-9a-f]{16}\  ]] || continue
            [[ "$reached" == *" $name "* ]] || echo "| $name | before |$line"
        done <<<"$before"
        echo
        echo "All steps together: $((total_s / 60)) minutes."
    } >"$ROOT/$TEST_SUMMARY"
}
