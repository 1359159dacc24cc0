# shellcheck shell=bash
# uPlot (MIT licence), which draws the page of `quiesce live`: a package of npm. What the Python package carries
# of it is taken from here. Sourced by tools/setup.

UPLOT_FOLDER="$ROOT/build/deps/uplot"
UPLOT_ARCHIVE="uplot-1.6.32.tgz"
UPLOT_ARCHIVE_SHA256="4b8a8191e425658e3ea8c8c1314b0fc679c861ee3a1af2b20c7b16ba50b5133d"
UPLOT_SHA256="8f989229699b4fe2f1a0432d0e9edc338a8a911e250e2d1b01ecd770a5f5b1bd  LICENSE
19c8d4c6ad88929a79f4ae49d6f7161566dfd0ba3d15cc495e974f787eb78f1f  uPlot.iife.min.js
df630c6a8d6f8eeaff264b50f73ce5b114f646ffd9a0bb74f049b0a00135fa04  uPlot.min.css"

# uplot_is_complete FOLDER: its files are there, with the right contents.
uplot_is_complete() {
    [ -d "$1" ] && (cd "$1" && sha256sum --status --check - <<<"$UPLOT_SHA256" 2>/dev/null)
}

# uplot_fetch FOLDER: the archive into it, from QUIESCE_UPLOT_ARCHIVE where that is set.
uplot_fetch() {
    if [ -n "${QUIESCE_UPLOT_ARCHIVE:-}" ]; then
        cp -- "$QUIESCE_UPLOT_ARCHIVE" "$1/$UPLOT_ARCHIVE" 2>/dev/null ||
            fail "QUIESCE_UPLOT_ARCHIVE: cannot read $QUIESCE_UPLOT_ARCHIVE"
        return 0
    fi
    command -v npm >/dev/null || packages_setup npm
    retry setup-uplot npm pack --pack-destination "$1" uplot@1.6.32 ||
        fail "could not fetch $UPLOT_ARCHIVE. Check the network and run again, or get the file elsewhere and name it: QUIESCE_UPLOT_ARCHIVE=/path/to/$UPLOT_ARCHIVE (log: build/logs/setup-uplot.log)"
}

# uplot_unpack FOLDER: the files beside the archive; refuses any other contents.
uplot_unpack() {
    local sum
    sum="$(sha256sum <"$1/$UPLOT_ARCHIVE")"
    [ "${sum%% *}" = "$UPLOT_ARCHIVE_SHA256" ] ||
        fail "$UPLOT_ARCHIVE refused: its sha256 is ${sum%% *}, expected $UPLOT_ARCHIVE_SHA256. Nothing was installed; fetch the genuine file"
    tar -xzf "$1/$UPLOT_ARCHIVE" -C "$1" --strip-components=2 --no-same-owner \
        package/dist/uPlot.iife.min.js package/dist/uPlot.min.css
    tar -xzf "$1/$UPLOT_ARCHIVE" -C "$1" --strip-components=1 --no-same-owner package/LICENSE
    rm "$1/$UPLOT_ARCHIVE"
    uplot_is_complete "$1" || fail "the files in $UPLOT_ARCHIVE are not the expected ones"
}

uplot_setup() {
    uplot_is_complete "$UPLOT_FOLDER" && return 0
    say "set-up: uPlot from $UPLOT_ARCHIVE into build/deps/uplot"
    mkdir -p "$ROOT/build/deps"
    UPLOT_WORK="$(mktemp -d "$ROOT/build/deps/uplot.XXXXXX")"
    trap 'rm -rf "$UPLOT_WORK"' EXIT
    uplot_fetch "$UPLOT_WORK"
    uplot_unpack "$UPLOT_WORK"
    chmod 755 "$UPLOT_WORK"
    rm -rf "$UPLOT_FOLDER"
    mv "$UPLOT_WORK" "$UPLOT_FOLDER"
}
