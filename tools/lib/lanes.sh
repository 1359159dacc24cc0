# shellcheck shell=bash
# Steps side by side, each as if it ran by itself. Sourced by tools/test.

# side_by_side COUNT RUN NAME...: RUN NAME for every name, so many at a time: who is done takes the next.
# What they record is recorded here. Ctrl-C reaches them all.
side_by_side() {
    local count="$1" run="$2" folder lane lanes=()
    shift 2
    folder="$(mktemp -d)"
    printf '%s\n' "$@" >"$folder/left"
    set -m # a process group for each, which sees Ctrl-C
    for ((lane = 0; lane < count; lane++)); do
        lane_run "$folder" "$lane" "$run" </dev/null &
        lanes+=("$!")
    done
    set +m
    # shellcheck disable=SC2064 # these ones
    trap "kill -INT -- ${lanes[*]/#/-} 2>/dev/null; rm -rf '$folder'; exit 130" INT TERM
    wait "${lanes[@]}" || true # a failed step is in what they record
    trap - INT TERM
    lanes_collect "$folder"
    rm -rf "$folder"
}

# lane_run FOLDER LANE RUN: until nothing is left.
lane_run() {
    local name array value
    # shellcheck disable=SC2034 # by their names, below
    PASSED=() KEPT=() FAILED=() ABSENT=() SUMMARIES=() RECORDS=()
    while name="$(lane_next "$1")" && [ -n "$name" ]; do
        "$3" "$name" || true
    done
    for array in PASSED KEPT FAILED ABSENT SUMMARIES RECORDS; do
        local -n values="$array"
        for value in "${values[@]}"; do printf '%s %s\n' "$array" "$value"; done
    done >"$1/lane$2"
}

# lane_next FOLDER: takes the first name that is left; nothing where none is.
lane_next() {
    local left gate
    exec {gate}>"$1/gate"
    flock "$gate"
    mapfile -t left <"$1/left"
    ((${#left[@]} > 0)) || return 0
    if ((${#left[@]} > 1)); then printf "%s\n" "${left[@]:1}"; fi >"$1/left"
    printf '%s\n' "${left[0]}"
}

lanes_collect() {
    local array value file
    for file in "$1"/lane*; do
        while read -r array value; do
            local -n target="$array"
            target+=("$value")
        done <"$file"
    done
}
