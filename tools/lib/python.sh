# shellcheck shell=bash
# The virtual environment .venv with the pinned packages of tools/requirements.txt, and the quiesce
# package of tools/src on its path. Sourced by tools/setup.

VENV="$ROOT/.venv"
REQUIREMENTS="$ROOT/tools/requirements.txt"

# python_probe EXE: "MAJOR MINOR", and " venv" where it can make environments. False iff it does not run.
python_probe() {
    "$1" -c '
import sys
try:
    import ensurepip, venv
    able = ["venv"]
except ImportError:
    able = []
print(*sys.version_info[:2], *able)' 2>/dev/null </dev/null
}

# python_find: PYTHON = one that is new enough and makes environments. False iff none is;
# PYTHON_SEEN then says what there is.
python_find() {
    local exe probe major minor able
    local candidates=(python3 /usr/bin/python3 python3.14 python3.13 python3.12 python3.11)
    [ -z "${QUIESCE_PYTHON:-}" ] || candidates=("$QUIESCE_PYTHON")
    PYTHON_SEEN=""
    for exe in "${candidates[@]}"; do
        probe="$(python_probe "$exe")" || continue
        read -r major minor able <<<"$probe"
        PYTHON_SEEN+="${PYTHON_SEEN:+, }$exe is $major.$minor"
        [ "$able" = venv ] || PYTHON_SEEN+=" without venv"
        ((major > 3 || (major == 3 && minor >= 11))) || continue
        [ "$able" = venv ] || continue
        PYTHON="$exe"
        return 0
    done
    return 1
}

# What a complete environment was made from. Environments do not survive a move of the folder.
python_stamp() {
    cat "$REQUIREMENTS" "$ROOT/tools/lib/python.sh" | sha256sum
    printf '%s\n' "$ROOT"
    "$VENV/bin/python" -V
}

python_is_complete() {
    [ -x "$VENV/bin/python" ] && [ -f "$VENV/.complete" ] &&
        [ "$(cat "$VENV/.complete")" = "$(python_stamp)" ]
}

python_require() {
    python_find && return 0
    [ -n "${QUIESCE_PYTHON:-}" ] || packages_setup python3 python3-venv
    python_find && return 0
    fail "Python 3.11 or newer with its venv module is needed; found: ${PYTHON_SEEN:-none}. Install one (Debian 12: python3 python3-venv), or name it: QUIESCE_PYTHON=/path/to/python3.11"
}

python_pip() {
    "$VENV/bin/python" -I -m pip --disable-pip-version-check --no-input "$@"
}

# pip_reason LOG: pip's last error, in its words.
pip_reason() {
    grep -h '^ERROR' "$LOG_DIR/$1.log" | tail -n 1 | cut -c1-300 || true
}

python_setup() {
    local site
    python_is_complete && return 0
    python_require
    say "set-up: Python environment .venv with $PYTHON and the packages of tools/requirements.txt"
    rm -rf "$VENV"
    run_logged setup-venv "$PYTHON" -m venv "$VENV" ||
        fail "'$PYTHON -m venv' failed (log: build/logs/setup-venv.log). Is the disk full?"
    # What is imported is compiled when it is, but what an emergency stop imports now.
    retry setup-python python_pip install --no-compile --require-hashes -r "$REQUIREMENTS" ||
        fail "could not install the Python packages: $(pip_reason setup-python). Check the network and pip's settings, then run again (log: build/logs/setup-python.log)"
    site="$("$VENV/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')"
    printf '%s\n' "$ROOT"/{tools/src,tools/benchmarks,tests/system/vm} >"$site/quiesce.pth"
    run_logged setup-import "$VENV/bin/python" -I -c '
from quiesce.can import database, e2e, link, slcan, stopping, traffic
database.load()' || fail "the Python environment does not work (log: build/logs/setup-import.log)" 1
    # Last, and in one step: an interrupted set-up has no such file and starts again.
    python_stamp >"$VENV/.complete.new"
    mv "$VENV/.complete.new" "$VENV/.complete"
}
