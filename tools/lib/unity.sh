# shellcheck shell=bash
# Unity (C unit tests, MIT licence): its three files ship in the PyPI source archive of cantools.
# Sourced by tools/setup.

UNITY_FOLDER="$ROOT/build/deps/unity"
UNITY_ARCHIVE="cantools-45.1.0.tar.gz"
UNITY_ARCHIVE_SHA256="ea1619f3d6108a1c3ecd0f81c952ff2dffd023b244704f6f7a17c4f4dca75f73"
UNITY_INSIDE="cantools-45.1.0/tests/test_c_code/test_framework"
UNITY_SHA256="ee69607f977cf2653762cb3a84da8a122a0a5bbe6c3308ca1f59e443b1890cf5  unity.c
e20bed56a8172986ff9f65933351b8b9df62996b77045ed8787d631223fe6eb3  unity.h
c4220e36bc7c66f81a0f0b026e694865f3f33e6c8b48113dedd8db1d50ce0716  unity_internals.h"

# unity_is_complete FOLDER: all three files are there, with the right contents.
unity_is_complete() {
    [ -d "$1" ] && (cd "$1" && sha256sum --status --check - <<<"$UNITY_SHA256" 2>/dev/null)
}

# unity_fetch FOLDER: the archive into it, from QUIESCE_UNITY_ARCHIVE where that is set.
unity_fetch() {
    if [ -n "${QUIESCE_UNITY_ARCHIVE:-}" ]; then
        cp -- "$QUIESCE_UNITY_ARCHIVE" "$1/$UNITY_ARCHIVE" 2>/dev/null ||
            fail "QUIESCE_UNITY_ARCHIVE: cannot read $QUIESCE_UNITY_ARCHIVE"
        return 0
    fi
    # The environment's own pinned build tools: nothing else is fetched.
    retry setup-unity python_pip download --no-deps --no-build-isolation \
        --no-binary cantools --dest "$1" cantools==45.1.0 ||
        fail "could not fetch $UNITY_ARCHIVE: $(pip_reason setup-unity). Check the network and run again, or get the file elsewhere and name it: QUIESCE_UNITY_ARCHIVE=/path/to/$UNITY_ARCHIVE (log: build/logs/setup-unity.log)"
}

# unity_unpack FOLDER: the three files beside the archive; refuses any other contents.
unity_unpack() {
    local sum
    sum="$(sha256sum <"$1/$UNITY_ARCHIVE")"
    if [ "${sum%% *}" != "$UNITY_ARCHIVE_SHA256" ]; then
        fail "$UNITY_ARCHIVE refused: its sha256 is ${sum%% *}, expected $UNITY_ARCHIVE_SHA256. Nothing was installed; fetch the genuine file"
    fi
    tar -xzf "$1/$UNITY_ARCHIVE" -C "$1" --strip-components=4 --no-same-owner \
        "$UNITY_INSIDE/unity.c" "$UNITY_INSIDE/unity.h" "$UNITY_INSIDE/unity_internals.h"
    rm "$1/$UNITY_ARCHIVE"
    unity_is_complete "$1" || fail "the Unity files in $UNITY_ARCHIVE are not the expected ones"
}

unity_setup() {
    unity_is_complete "$UNITY_FOLDER" && return 0
    say "set-up: Unity's files from $UNITY_ARCHIVE into build/deps/unity"
    mkdir -p "$ROOT/build/deps"
    UNITY_WORK="$(mktemp -d "$ROOT/build/deps/unity.XXXXXX")"
    trap 'rm -rf "$UNITY_WORK"' EXIT
    unity_fetch "$UNITY_WORK"
    unity_unpack "$UNITY_WORK"
    chmod 755 "$UNITY_WORK"
    rm -rf "$UNITY_FOLDER"
    mv "$UNITY_WORK" "$UNITY_FOLDER"
}
