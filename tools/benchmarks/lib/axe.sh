# shellcheck shell=bash
# axe-core (MPL 2.0), which judges pages in a browser: a package of npm. Run in benchmarks only, no part of
# what ships. Sourced by tools/benchmarks/fetch_peers.

AXE_FOLDER="$ROOT/build/deps/axe"
AXE_ARCHIVE="axe-core-4.14.1.tgz"
AXE_ARCHIVE_SHA256="e6b0ce02b84d892e2e33e403485e7f3d6c29e2be6df65daf44d89ba564139745"

axe_is_complete() {
    [ -f "$AXE_FOLDER/axe.min.js" ] && [ "$(cat "$AXE_FOLDER/.complete" 2>/dev/null)" = "$AXE_ARCHIVE_SHA256" ]
}

# axe_fetch FOLDER: the archive into it, from QUIESCE_AXE_ARCHIVE where that is set.
axe_fetch() {
    if [ -n "${QUIESCE_AXE_ARCHIVE:-}" ]; then
        cp -- "$QUIESCE_AXE_ARCHIVE" "$1/$AXE_ARCHIVE" 2>/dev/null ||
            fail "QUIESCE_AXE_ARCHIVE: cannot read $QUIESCE_AXE_ARCHIVE"
        return 0
    fi
    command -v npm >/dev/null || packages_setup npm
    retry setup-axe npm pack --pack-destination "$1" axe-core@4.14.1 ||
        fail "could not fetch $AXE_ARCHIVE. Check the network and run again, or get the file elsewhere and name it: QUIESCE_AXE_ARCHIVE=/path/to/$AXE_ARCHIVE (log: build/logs/setup-axe.log)"
}

axe_setup() {
    local sum
    axe_is_complete && return 0
    say "set-up: axe-core from $AXE_ARCHIVE into build/deps/axe"
    mkdir -p "$ROOT/build/deps"
    AXE_WORK="$(mktemp -d "$ROOT/build/deps/axe.XXXXXX")"
    trap 'rm -rf "$AXE_WORK"' EXIT
    axe_fetch "$AXE_WORK"
    sum="$(sha256sum <"$AXE_WORK/$AXE_ARCHIVE")"
    [ "${sum%% *}" = "$AXE_ARCHIVE_SHA256" ] ||
        fail "$AXE_ARCHIVE refused: its sha256 is ${sum%% *}, expected $AXE_ARCHIVE_SHA256. Nothing was installed; fetch the genuine file"
    tar -xzf "$AXE_WORK/$AXE_ARCHIVE" -C "$AXE_WORK" --strip-components=1 --no-same-owner \
        package/axe.min.js package/LICENSE
    rm "$AXE_WORK/$AXE_ARCHIVE"
    printf '%s\n' "$AXE_ARCHIVE_SHA256" >"$AXE_WORK/.complete"
    chmod 755 "$AXE_WORK"
    rm -rf "$AXE_FOLDER"
    mv "$AXE_WORK" "$AXE_FOLDER"
}
