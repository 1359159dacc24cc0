# shellcheck shell=bash
# Builds a CMake preset where something has changed. Sourced by tools/hil, test and quiesce.

# What the bench drives in the emulator.
# shellcheck disable=SC2034 # for those who source this
DRIVEN_IMAGES=(quiesce_mps2_shm quiesce_mps2_shm_8x4 quiesce_mps2_live quiesce_mps2_uart quiesce_mps2_uart_8x4
  uart_echo)

# Where ccache is installed, what another preset, another clone or an earlier state of this one has
# compiled is not compiled again. Paths inside of the project count as relative.
build_cache() {
    command -v ccache >/dev/null || return 0
    export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
    export CCACHE_BASEDIR="${CCACHE_BASEDIR:-$ROOT}"
}

# The firmware on other processors under QEMU: core, C tests, golden traces (cmake/, CMakePresets.json).
# shellcheck disable=SC2034 # for those who source this
PORTS=(m3 m4f m7 m33 rv32 aarch64)
# Compiled for its sizes: QEMU has no Cortex-M0+.
# shellcheck disable=SC2034
SIZED_PORTS=(m0plus)
# What prints the golden traces.
# shellcheck disable=SC2034
GOLDEN_PROGRAMS=(golden_streams golden_fft golden_guards)

# What a build folder was configured from; another value needs a fresh one.
build_stamp() {
    printf '%s %s %s\n' "$ROOT" "$1" "${CMAKE_C_COMPILER_LAUNCHER:-}"
    grep -m 1 '^flags' /proc/cpuinfo | sha256sum || true # the damper models are for this processor
    cat "$ROOT/CMakePresets.json" "$ROOT"/cmake/{arm-none-eabi,aarch64-linux-gnu,riscv64-unknown-elf}.cmake | sha256sum
}

# build_progress PRESET: reads ninja's lines; a counter on a terminal, one line elsewhere.
build_progress() {
    local line at_work=0
    while IFS= read -r line; do
        [[ "$line" =~ ^\[([0-9]+)/([0-9]+)\] ]] || continue
        if [ -t 2 ]; then
            printf '\rbuild %s: %s of %s  ' "$1" "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}" >&2
        elif ((at_work == 0)); then
            say "build $1: ${BASH_REMATCH[2]} steps"
        fi
        at_work=1
    done
    return $((at_work == 0))
}

build_failed() {
    say ""
    tail -n 40 "$2" >&2
    fail "build $1 failed; the whole log is ${2#"$ROOT/"}" 1
}

build_configure() {
    local preset="$1" folder="$ROOT/build/$1" log="$LOG_DIR/configure-$1.log"
    [ -f "$folder/build.ninja" ] && [ -f "$folder/.configured" ] &&
        [ "$(cat "$folder/.configured")" = "$(build_stamp "$preset")" ] && return 0
    say "build $preset: configuring"
    (cd "$ROOT" && run_logged "configure-$preset" cmake --fresh --preset "$preset") ||
        build_failed "$preset" "$log"
    build_stamp "$preset" >"$folder/.configured"
}

# build_preset PRESET [TARGET...]: says nothing where nothing is to do; ends the script on failure.
build_preset() {
    local preset="$1" log="$LOG_DIR/build-$1.log" start_s=$SECONDS codes
    shift
    local targets=()
    (($# == 0)) || targets=(--target "$@")
    mkdir -p "$LOG_DIR"
    build_cache
    lock "build-$preset" 9
    build_configure "$preset"
    set +e
    (cd "$ROOT" && cmake --build --preset "$preset" "${targets[@]}" --parallel "$(nproc)" \
        </dev/null 2>&1) | tee "$log" | build_progress "$preset"
    codes=("${PIPESTATUS[@]}")
    set -e
    ((codes[0] == 0)) || build_failed "$preset" "$log"
    exec 9>&-
    ((codes[2] != 0)) || build_done "$preset" $((SECONDS - start_s))
}

build_done() {
    [ ! -t 2 ] || printf '\r' >&2
    say "build $1: ok ($2 s)                "
}
