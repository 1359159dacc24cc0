# shellcheck shell=bash
# Shared by the scripts in tools/: where things are, how they speak, how they fail.
# A script sets PROGRAM (the name it speaks under) and sources this file.
set -euo pipefail

ROOT="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)"
LOG_DIR="$ROOT/build/logs"

# All progress goes to stderr: stdout belongs to what a command prints for others to read.
say() {
    printf '%s\n' "$*" >&2
}

# One line that says what is wrong and what to do. Exit code 2: bad input or a missing tool.
fail() {
    printf '%s: %s\n' "$PROGRAM" "$1" >&2
    exit "${2:-2}"
}

# run_logged NAME COMMAND...: the command without stdin, its output in build/logs/NAME.log.
run_logged() {
    local log="$LOG_DIR/$1.log"
    shift
    mkdir -p "$LOG_DIR"
    "$@" >"$log" 2>&1 </dev/null
}

# retry NAME COMMAND...: run_logged, up to three times with a growing pause.
retry() {
    local pause_s
    for pause_s in 2 5 0; do
        run_logged "$@" && return 0
        ((pause_s == 0)) || sleep "$pause_s"
    done
    return 1
}

# lock NAME FD: one command at a time; the lock goes with the process.
lock() {
    local fd="$2"
    mkdir -p "$ROOT/build"
    eval "exec $fd>\"\$ROOT/build/.$1.lock\""
    flock --nonblock "$fd" && return 0
    say "$PROGRAM: waiting for another command that holds build/.$1.lock"
    flock "$fd"
}
