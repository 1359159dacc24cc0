# shellcheck shell=bash
# The virtual environment .venv with the pinned packages of tools/requirements.txt, and the quiesce
# package of tools/src on its path. Sourced by tools/setup.
#
# .venv is a link into .venvs: another environment is made beside the one in use and takes its place
# when it is complete, so that `quiesce can stop` has one at any time, and after a failed set-up.

VENV="$ROOT/.venv"
VENVS="$ROOT/.venvs"
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

# python_stamp [FOLDER]: what a complete environment was made from. Environments do not survive a
# move of the project.
python_stamp() {
    cat "$REQUIREMENTS" "$ROOT/tools/lib/python.sh" | sha256sum
    printf '%s\n' "$ROOT"
    "${1:-$VENV}/bin/python" -V
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

# pip_of ENVIRONMENT ARGUMENT...
pip_of() {
    "$1/bin/python" -I -m pip --disable-pip-version-check --no-input "${@:2}"
}

python_pip() {
    pip_of "$VENV" "$@"
}

# pip_reason LOG: pip's last error, in its words.
pip_reason() {
    grep -h '^ERROR' "$LOG_DIR/$1.log" | tail -n 1 | cut -c1-300 || true
}

# python_switch FOLDER: .venv is that one from now on. What runs may still import from the one
# before; those before that go.
python_switch() {
    local fresh="$1" before folder
    before="$(readlink "$VENV" || true)"
    if [ -z "$before" ] && [ -d "$VENV" ]; then # as it was made once
        before=before
        mv "$VENV" "$VENVS/$before"
    fi
    rm -f "$VENV.new"
    ln -s ".venvs/${fresh##*/}" "$VENV.new"
    mv -T "$VENV.new" "$VENV"
    for folder in "$VENVS"/*; do
        [[ "${folder##*/}" == @("${fresh##*/}"|"${before##*/}") ]] || rm -rf "$folder"
    done
}

# What set-ups left that failed or were interrupted: each may be hundreds of megabytes.
python_drop_unfinished() {
    local folder
    for folder in "$VENVS"/*/; do
        [ -f "$folder/.complete" ] || rm -rf "$folder"
    done
}

python_setup() {
    local site fresh
    python_is_complete && return 0
    python_require
    say "set-up: Python environment .venv with $PYTHON and the packages of tools/requirements.txt"
    mkdir -p "$VENVS"
    python_drop_unfinished
    fresh="$(mktemp -d "$VENVS/XXXXXX")"
    chmod 755 "$fresh"
    run_logged setup-venv "$PYTHON" -m venv "$fresh" ||
        fail "'$PYTHON -m venv' failed (log: build/logs/setup-venv.log). Is the disk full?"
    # What is imported is compiled when it is, but what an emergency stop imports now.
    retry setup-python pip_of "$fresh" install --no-compile --require-hashes -r "$REQUIREMENTS" ||
        fail "could not install the Python packages: $(pip_reason setup-python). Check the network and pip's settings, then run again (log: build/logs/setup-python.log)"
    site="$("$fresh/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')"
    printf '%s\n' "$ROOT"/{tools/src,tools/benchmarks,tests/system/vm} >"$site/quiesce.pth"
    run_logged setup-import "$fresh/bin/python" -I -c '
from quiesce.can import database, e2e, link, slcan, stopping, traffic
database.load()' || fail "the Python environment does not work (log: build/logs/setup-import.log)" 1
    # Last, and in one step: an interrupted set-up has no such file and starts again.
    python_stamp "$fresh" >"$fresh/.complete"
    python_switch "$fresh"
}
