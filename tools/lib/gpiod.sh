# shellcheck shell=bash
# libgpiod 2.x (LGPL-2.1-or-later), which Debian 12 does not have: the C library in the PyPI source
# archive of gpiod. It is built as a shared library of its own. Sourced by tools/setup.

GPIOD_FOLDER="$ROOT/build/deps/gpiod"
GPIOD_NAME="gpiod-2.5.0"
GPIOD_SHA256="53ae5a1f14d6388c155b591ca0fc0cfa73b44d4f6d8d117e8a9e68f5902d187a"

# gpiod_is_complete FOLDER: it was unpacked to the end, from this very archive.
gpiod_is_complete() {
    [ -f "$1/.complete" ] && [ "$(cat "$1/.complete")" = "$GPIOD_SHA256" ]
}

# gpiod_fetch FOLDER: the archive into it, from QUIESCE_GPIOD_ARCHIVE where that is set.
gpiod_fetch() {
    if [ -n "${QUIESCE_GPIOD_ARCHIVE:-}" ]; then
        cp -- "$QUIESCE_GPIOD_ARCHIVE" "$1/$GPIOD_NAME.tar.gz" 2>/dev/null ||
            fail "QUIESCE_GPIOD_ARCHIVE: cannot read $QUIESCE_GPIOD_ARCHIVE"
        return 0
    fi
    # The environment's own pinned build tools: nothing else is fetched.
    retry setup-gpiod python_pip download --no-deps --no-build-isolation \
        --no-binary gpiod --dest "$1" gpiod==2.5.0 ||
        fail "could not fetch $GPIOD_NAME.tar.gz: $(pip_reason setup-gpiod). Check the network and run again, or get the file elsewhere and name it: QUIESCE_GPIOD_ARCHIVE=/path/to/$GPIOD_NAME.tar.gz (log: build/logs/setup-gpiod.log)"
}

# gpiod_unpack FOLDER: headers, sources and licence into it, as new as now, so that they are compiled
# again; refuses any other archive.
gpiod_unpack() {
    local sum archive="$1/$GPIOD_NAME.tar.gz"
    sum="$(sha256sum <"$archive")"
    if [ "${sum%% *}" != "$GPIOD_SHA256" ]; then
        fail "$GPIOD_NAME.tar.gz refused: its sha256 is ${sum%% *}, expected $GPIOD_SHA256. Nothing was installed; fetch the genuine file"
    fi
    tar -xzf "$archive" -C "$1" --strip-components=1 --no-same-owner --touch \
        "$GPIOD_NAME/include" "$GPIOD_NAME/lib" "$GPIOD_NAME/LICENSE" \
        "$GPIOD_NAME/libgpiod-version.txt"
    rm "$archive"
    printf '%s\n' "$GPIOD_SHA256" >"$1/.complete"
}

gpiod_setup() {
    gpiod_is_complete "$GPIOD_FOLDER" && return 0
    say "set-up: libgpiod 2.x from $GPIOD_NAME.tar.gz into build/deps/gpiod"
    mkdir -p "$ROOT/build/deps"
    GPIOD_WORK="$(mktemp -d "$ROOT/build/deps/gpiod.XXXXXX")"
    trap 'rm -rf "$GPIOD_WORK"' EXIT
    gpiod_fetch "$GPIOD_WORK"
    gpiod_unpack "$GPIOD_WORK"
    chmod 755 "$GPIOD_WORK"
    rm -rf "$GPIOD_FOLDER"
    mv "$GPIOD_WORK" "$GPIOD_FOLDER"
}
