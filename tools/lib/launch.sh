# shellcheck shell=bash
# From a fresh clone to a running `quiesce`. Sourced by tools/hil and tools/quiesce.
# shellcheck source=tools/lib/build.sh
source "$ROOT/tools/lib/build.sh"

asks_for_help() {
    local argument
    for argument in "$@"; do
        case "$argument" in -h | --help) return 0 ;; esac
    done
    return 1
}

# launch_build PRESET: what the bench runs, without the tests (ninja's target of a whole folder).
launch_build() {
    case "$1" in
    mps2) build_preset mps2 targets/all ;;
    *) build_preset "$1" sim_hil/all ;;
    esac
}

# launch PRESET... -- MODULE ARGUMENT...: becomes that Python module in the caller's folder.
# Help needs the Python environment only.
launch() {
    local presets=() preset
    while [ "$1" != -- ]; do
        presets+=("$1")
        shift
    done
    shift
    if (($# == 1)) || asks_for_help "$@"; then
        "$ROOT/tools/setup" python
    else
        "$ROOT/tools/setup" run
        for preset in "${presets[@]}"; do
            launch_build "$preset"
        done
    fi
    # -I: nothing in the caller's folder or PYTHONPATH can stand in for a module.
    exec "$ROOT/.venv/bin/python" -I -m "$@"
}
