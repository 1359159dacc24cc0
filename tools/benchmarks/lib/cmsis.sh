# shellcheck shell=bash
# CMSIS-DSP (Apache-2.0), which benchmarks compare with: the C sources in the PyPI source archive of
# cmsisdsp. Sourced by tools/benchmarks/build_images.

CMSIS_FOLDER="$ROOT/build/deps/cmsisdsp"
CMSIS_NAME="cmsisdsp-1.10.3"
CMSIS_SHA256="307d32298faa7c58db912851027fce35f886fec7eb1a27c4b309ce1a97f47519"

# cmsis_is_complete FOLDER: it was unpacked to the end, from this very archive.
cmsis_is_complete() {
    [ -f "$1/.complete" ] && [ "$(cat "$1/.complete")" = "$CMSIS_SHA256" ]
}

# cmsis_fetch FOLDER: the archive into it, from QUIESCE_CMSIS_ARCHIVE where that is set.
cmsis_fetch() {
    if [ -n "${QUIESCE_CMSIS_ARCHIVE:-}" ]; then
        cp -- "$QUIESCE_CMSIS_ARCHIVE" "$1/$CMSIS_NAME.tar.gz" 2>/dev/null ||
            fail "QUIESCE_CMSIS_ARCHIVE: cannot read $QUIESCE_CMSIS_ARCHIVE"
        return 0
    fi
    # The environment's own pinned build tools: nothing else is fetched.
    retry setup-cmsis python_pip download --no-deps --no-build-isolation \
        --no-binary cmsisdsp --dest "$1" cmsisdsp==1.10.3 ||
        fail "could not fetch $CMSIS_NAME.tar.gz: $(pip_reason setup-cmsis). Check the network and run again, or get the file elsewhere and name it: QUIESCE_CMSIS_ARCHIVE=/path/to/$CMSIS_NAME.tar.gz (log: build/logs/setup-cmsis.log)"
}

# cmsis_unpack FOLDER: headers, sources and licence into it, as new as now, so that they are compiled
# again; refuses any other archive.
cmsis_unpack() {
    local sum archive="$1/$CMSIS_NAME.tar.gz"
    sum="$(sha256sum <"$archive")"
    if [ "${sum%% *}" != "$CMSIS_SHA256" ]; then
        fail "$CMSIS_NAME.tar.gz refused: its sha256 is ${sum%% *}, expected $CMSIS_SHA256. Nothing was installed; fetch the genuine file"
    fi
    tar -xzf "$archive" -C "$1" --strip-components=1 --no-same-owner --touch \
        "$CMSIS_NAME/Include" "$CMSIS_NAME/PrivateInclude" "$CMSIS_NAME/Source" "$CMSIS_NAME/LICENSE"
    rm "$archive"
    printf '%s\n' "$CMSIS_SHA256" >"$1/.complete"
}

cmsis_setup() {
    cmsis_is_complete "$CMSIS_FOLDER" && return 0
    say "set-up: CMSIS-DSP from $CMSIS_NAME.tar.gz into build/deps/cmsisdsp"
    mkdir -p "$ROOT/build/deps"
    CMSIS_WORK="$(mktemp -d "$ROOT/build/deps/cmsisdsp.XXXXXX")"
    trap 'rm -rf "$CMSIS_WORK"' EXIT
    cmsis_fetch "$CMSIS_WORK"
    cmsis_unpack "$CMSIS_WORK"
    chmod 755 "$CMSIS_WORK"
    rm -rf "$CMSIS_FOLDER"
    mv "$CMSIS_WORK" "$CMSIS_FOLDER"
}
