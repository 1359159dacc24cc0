# shellcheck shell=bash
# From a fresh clone to a running `quiesce`. Sourced by tools/hil, tools/quiesce and
# tools/benchmark.
# shellcheck source=tools/lib/build.sh
source "$ROOT/tools/lib/build.sh"
# shellcheck source=tools/lib/needs.sh
source "$ROOT/tools/lib/needs.sh"
# shellcheck source=tools/lib/python.sh
source "$ROOT/tools/lib/python.sh"

asks_for_help() {
    local argument
    for argument in "$@"; do
        case "$argument" in -h | --help) return 0 ;; esac
    done
    return 1
}

# python_is_usable: it was complete once, in this folder, whatever tools/requirements.txt says now.
python_is_usable() {
    [ -x "$VENV/bin/python" ] && grep -qxF "$ROOT" "$VENV/.complete" 2>/dev/null
}

# launch_prepare NEEDS ARGUMENT...: sets up and builds what is missing. Where nothing compiled is
# needed and .venv is there, no lock is taken and nothing is waited for. A stop does not wait for
# newer packages either: any environment that was complete will do.
launch_prepare() {
    local needs=() all=" $1 "
    # The page is fetched, not built.
    read -ra needs <<<"${all/ page / }" || true
    shift
    if [[ "$all" = *" page "* ]] && ! asks_for_help "$@"; then
        "$ROOT/tools/setup" page
    fi
    if ((${#needs[@]} > 0 && $# > 0)) && ! asks_for_help "$@"; then
        "$ROOT/tools/setup" run
        needs_build "${needs[@]}"
    elif [ "${1:-} ${2:-}" = "can stop" ] && python_is_usable; then
        return 0
    elif ! python_is_complete; then
        "$ROOT/tools/setup" python
    fi
}

# launch MODULE ARGUMENT...: becomes that Python module in the caller's folder.
launch() {
    # -I: nothing in the caller's folder or PYTHONPATH can stand in for a module.
    exec "$ROOT/.venv/bin/python" -I -m "$@"
}
