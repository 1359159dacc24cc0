# shellcheck shell=bash
# What a command runs of compiled code: the one table of it. Sourced by tools/lib/launch.sh.
#
#   bench    quiesce_bench on this machine     images   what it drives in the emulator
#   plant    the library of quiesce.plant      linux    the Linux controller
#   dampers  the module of quiesce.damper          trust    what its benchmark abuses and mutates
#   fmu      the library of `quiesce fmu`
#   tables   what its benchmark loads tables into
#   ports    the golden traces for every processor    budget   the images that a board's budget is held by
#   coil     the current loop on its coils, and records through power cuts
#   compilers  nothing yet: the command compiles by itself; boards  images of boards that are bought
#   page     nothing compiled: what draws the page of `quiesce live`; node: what its benchmark shows

# needs_of COMMAND [ACTION] ...: of `quiesce`; nothing where it starts without a build. A command
# that is not here needs nothing: `quiesce` refuses what it does not know.
needs_of() {
    case "${1:-} ${2:-}" in
    "hil "* | "replay "*) needs_of_target "$@" ;;
    "board "* | "chain "* | "params "* | "plant "* | "record "*) echo bench ;;
    "rules lookup" | "rules optimize" | "rules show") echo bench ;;
    "rules "*) ;;
    "campaign "*) echo bench ;;
    "compare "*) needs_of_compare "$@" ;;
    "law make" | "law rules" | "law fit") echo bench ;;
    "law "*) ;;
    "table check" | "table stamp") echo bench ;;
    "table "*) ;;
    "new "* | "sweep "*) echo bench plant ;;
    "identify plan") ;;
    "identify "*) echo dampers ;;
    "tune law") echo bench ;;
    "tune "*) echo bench plant dampers ;;
    "can "* | "report "*) ;;
    "fmu "*) echo bench fmu ;;
    "commission "*) echo bench plant dampers ;;
    "firmware build") echo compilers ;;
    "firmware "*) ;;
    "live "*) needs_of_live "$@" ;;
    "completion "*) ;;
    esac
}

# needs_of_live OPTION...: a rig in the computer is the bench, and its controller's target; a guided session needs
# what commission does.
needs_of_live() {
    local target=
    case "$*" in
    *--target[\ =]mps2*) target=" images" ;;
    *--target[\ =]linux*) target=" linux" ;;
    esac
    case "$*" in
    *--commission*) echo "$(needs_of commission) page$target" ;;
    *--sim*) echo "bench page$target" ;;
    *) echo page ;;
    esac
}

# needs_of_target COMMAND OPTION...: what its --target, or the default, needs.
needs_of_target() {
    case "$*" in
    *--target[\ =]linux*) echo bench linux ;;
    *--target[\ =]host*) echo bench ;;
    hil* | *--target[\ =]*) echo bench images ;;
    *) echo bench ;;
    esac
}

# needs_of_compare OPTION...: the clairvoyant goes by the plant's own slopes.
needs_of_compare() {
    case "$*" in
    *--clairvoyant*) echo bench plant ;;
    *) echo bench ;;
    esac
}

# needs_of_benchmark NAME...: of `benchmark`. Images that only benchmarks run: their build_images.
needs_of_benchmark() {
    case "${1:-}" in
    can | fuzzy | house | signal) echo bench ;;
    campaign) echo bench fmu ;;
    controller) echo bench dampers images ;;
    laws) echo bench plant dampers ;;
    control | sweep) echo bench plant ;;
    live) echo bench plant dampers node page ;;
    board) echo bench ports budget coil boards ;;
    trust) echo bench images trust ;;
    tables) echo bench plant dampers images linux tables ;;
    *) echo bench plant dampers ;;
    esac
}

# needs_ports: what prints the golden traces, for this machine and the others; libraries for their sizes.
needs_ports() {
    local preset
    "$ROOT/tools/setup" ports
    for preset in host sanitize m32 "${PORTS[@]}"; do
        build_preset "$preset" "${GOLDEN_PROGRAMS[@]}"
    done
    for preset in "${SIZED_PORTS[@]}"; do
        build_preset "$preset" quiesce_core_1x1
    done
}

# needs_build NEED...: builds that, and nothing else.
needs_build() {
    local need host=() mps2=()
    for need in "$@"; do
        case "$need" in
        bench) host+=(quiesce_bench icount_plugin) ;;
        plant) host+=(quiesce_plant) ;;
        fmu) host+=(quiesce_fmu) ;;
        dampers) host+=(quiesce_dampers) ;;
        linux) host+=(quiesced) ;;
        node) host+=(live_node) ;;
        tables) host+=(table_node) mps2+=(quiesce_mps2_node) ;;
        trust) host+=(all trust_programs) mps2+=(all) ;;
        images) mps2+=("${DRIVEN_IMAGES[@]}") ;;
        ports) needs_ports ;;
        budget) build_preset budget quiesce_mps2_node quiesce_mps2_shm node_cost current_cost ;;
        compilers) ;;
        boards) build_preset stm32f4 ;;
        coil) host+=(coil_steps test_nvm_cuts test_slots) ;;
        esac
    done
    ((${#host[@]} == 0)) || build_preset host "${host[@]}"
    ((${#mps2[@]} == 0)) || build_preset mps2 "${mps2[@]}"
}
