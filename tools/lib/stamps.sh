# shellcheck shell=bash
# What a step of ./tools/test read when it last passed, so that `all` goes on where it stopped.
# build/tested/STEP: the hash of its inputs, seconds, CPU seconds, its runner's closing line. The summary, which is
# committed, has the same of other machines. Sourced by tools/test.

# In no test's inputs: what `all` itself writes.
TEST_SUMMARY="tests/summary.md"
HASH_LENGTH=16 # of the digits, in the summary

# inputs_of STEP: the paths that it reads, more rather than fewer. Programs on this machine are built
# from `code`.
inputs_of() {
    local compiled="CMakeLists.txt CMakePresets.json cmake firmware hal targets sim_hil tests/CMakeLists.txt
        tests/build_images tests/unit tests/golden tests/system/vm/guest examples" code
    code="$compiled $(benchmark_parts)"
    case "$1" in
    ctest-* | sizes-*) echo "$code" ;;
    cppcheck) echo "$code tools/check" ;;
    tidy) echo "$code tools/check .clang-tidy" ;;
    format) echo "$code examples tests tools/check .clang-format" ;;
    scripts) echo ".ci tools tests" ;;
    ruff) echo "ruff.toml tools tests examples" ;;
    bench-house) echo . ;;
    bench-fuzzy) echo "$code tools/benchmarks/mps2 tests/system/vm docs/results/bounds $(benchmark_reads fuzzy)" ;;
    bench-*) echo "$code tests/system/vm docs/results/bounds $(benchmark_reads "${1#bench-}")" ;;
    pytest-package) echo "$code tools tests/system docs README.md LICENSE pytest.ini" ;;
    pytest-vm) echo "$code pytest.ini tests tools" ;;
    proofs) echo "$code tests/proof tools" ;;
    *) echo . ;;
    esac
}

# benchmark_parts: of tools/benchmarks all but its Python and the peer that is a project of its own.
benchmark_parts() {
    local part
    for part in "$ROOT"/tools/benchmarks/* "$ROOT"/tools/benchmarks/mps2/*; do
        part="${part#"$ROOT/"}"
        case "$part" in
        */quiesce_benchmarks | tools/benchmarks/mps2 | */fuzzylite) ;;
        *) echo "$part" ;;
        esac
    done
}

# benchmark_reads NAME: what of Python it can import, and what lies beside that; all of tools where it runs the
# command line, or where nobody can tell. Found once for each state of the sources.
benchmark_reads() {
    local name="$1" known found
    [ "$name" != identify ] || name=damper
    known="$ROOT/build/tested/.reads-$(files_hash tools tests/python/gates/house | cut -c1-16)"
    if [ ! -f "$known" ] && [ -x "$ROOT/.venv/bin/python" ]; then
        mkdir -p "$ROOT/build/tested"
        rm -f "$ROOT"/build/tested/.reads-*
        "$ROOT/.venv/bin/python" "$ROOT/tools/check/reads.py" >"$known.part" 2>/dev/null &&
            mv "$known.part" "$known"
    fi
    found="$(sed -n "s/^$name //p" "$known" 2>/dev/null)" || true
    if [ "${found:-tools}" = tools ]; then
        found="tools $(other_benchmarks "$name")"
    fi
    echo "$found"
}

# other_benchmarks NAME: what only the other ones read, as paths to leave out.
other_benchmarks() {
    local folder
    for folder in "$ROOT"/tools/benchmarks/quiesce_benchmarks/*/; do
        folder="$(basename "$folder")"
        [ "$folder" = "$1" ] || echo ":!tools/benchmarks/quiesce_benchmarks/$folder"
    done
}

# files_hash PATH...: of these files here, committed or not.
files_hash() {
    (cd "$ROOT" && git ls-files -z --cached --others --exclude-standard -- "$@" ":!$TEST_SUMMARY" |
        sort -zu | xargs -0 sha256sum) 2>&1 | sha256sum | cut -c1-64
}

# inputs_hash STEP: of its files, of what all steps are run by, and of this machine's own part.
# Nothing outside of a git tree: there nobody can tell what a step reads.
inputs_hash() {
    local paths
    git -C "$ROOT" rev-parse --git-dir >/dev/null 2>&1 || return 0
    read -r -d '' -a paths < <(inputs_of "$1") || true
    {
        uname -m
        gcc --version | head -n 1
        sed '/^\//d' "$ROOT/.venv/.complete" # but for the folder, which is no input
        files_hash "${paths[@]}" tools/lib tools/test tools/setup tools/packages.txt
    } 2>&1 | sha256sum | cut -c1-64
}

# stamp_write STEP HASH SECONDS CPU_S LINE; a word in place of a hash: whatever another machine says of it, it is run.
stamp_write() {
    mkdir -p "$ROOT/build/tested"
    printf '%s\n' "${@:2}" >"$ROOT/build/tested/$1"
}

# stamp_field STEP NUMBER: 1 hash, 2 seconds, 3 CPU seconds, 4 closing line.
stamp_field() {
    if [ -f "$ROOT/build/tested/$1" ]; then
        sed -n "$2p" "$ROOT/build/tested/$1"
    elif [ -f "$ROOT/$TEST_SUMMARY" ]; then
        summary_field "$@"
    fi
}

# summary_field STEP NUMBER: likewise, where the summary says that it passed.
summary_field() {
    sed -n -E "s/^\| $1 \| (passed|kept|before) \| ([0-9a-f]{$HASH_LENGTH}) \| ([0-9]+) s \| ([0-9]+) s \| (.*) \|\$/\\$(($2 + 1))/p" \
        "$ROOT/$TEST_SUMMARY"
}

# has_passed STEP: with these very inputs.
has_passed() {
    local before now
    before="$(stamp_field "$1" 1)"
    now="$(inputs_hash "$1")"
    [ -n "$before" ] && [ "${before:0:HASH_LENGTH}" = "${now:0:HASH_LENGTH}" ]
}
