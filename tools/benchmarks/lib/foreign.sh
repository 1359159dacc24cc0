# shellcheck shell=bash
# Rule files of other projects, out of the registries' own archives: FuzzyLite's examples (GPL, those of its
# Python port and of the C++ library as Debian has it) and Octave's (GPL). Read by a benchmark only, no part of
# what ships. Sourced by tools/benchmarks/fetch_peers.

FOREIGN_FOLDER="$ROOT/build/deps/foreign"
# name sha256
FOREIGN_ARCHIVES=(
    "pyfuzzylite-8.0.6.tar.gz 69b28241f283fd2ef1b359f3530b752ecbbf7e5908518d452ecf2f2e71c6599f"
    "fuzzylite_6.0+dfsg.orig.tar.xz 31c871149f63143cd8f25dafcb945cebc56ddd4ba711a020a41b34fa7df643a3"
    "octave-fuzzy-logic-toolkit_0.4.6-4_all.deb 60dae93144e2ac3f3c3c12a545800ee8694af691381ef23fceb623c9dacdc28e"
)

foreign_is_complete() {
    [ "$(cat "$FOREIGN_FOLDER/.complete" 2>/dev/null)" = "${FOREIGN_ARCHIVES[*]}" ]
}

# foreign_apt FOLDER ARGUMENT...: apt-get there, with this machine's mirrors as sources of source packages.
foreign_apt() {
    local folder="$1" apt="$1/apt"
    shift
    mkdir -p "$apt/lists/partial"
    # shellcheck disable=SC2016 # apt's own variables
    apt-get indextargets --format 'deb-src $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
        sort -u | awk '$3 == "bookworm"' >"$apt/sources.list"
    (cd "$folder" && apt-get -o Dir::Etc::SourceList="$apt/sources.list" -o Dir::Etc::SourceParts=- \
        -o Dir::State::Lists="$apt/lists" -o APT::Sandbox::User=root -o Acquire::Retries=3 "$@")
}

# foreign_fetch FOLDER NAME: from QUIESCE_FOREIGN, a folder, where that is set.
foreign_fetch() {
    if [ -n "${QUIESCE_FOREIGN:-}" ]; then
        cp -- "$QUIESCE_FOREIGN/$2" "$1/$2" 2>/dev/null || fail "QUIESCE_FOREIGN: cannot read $QUIESCE_FOREIGN/$2"
        return 0
    fi
    case "$2" in
    pyfuzzylite*) retry setup-foreign "$VENV/bin/python" -I -m pip --disable-pip-version-check --no-input \
        download --no-deps --no-binary :all: --dest "$1" pyfuzzylite==8.0.6 ;;
    fuzzylite*) retry setup-foreign foreign_apt "$1" update &&
        retry setup-foreign foreign_apt "$1" source --download-only --tar-only fuzzylite=6.0+dfsg-6 ;;
    *) (cd "$1" && retry setup-foreign apt-get -o APT::Sandbox::User=root download \
        octave-fuzzy-logic-toolkit=0.4.6-4) ;;
    esac || fail "could not fetch $2. Check the network and run again, or get the file elsewhere and name its folder: QUIESCE_FOREIGN=/path (log: build/logs/setup-foreign.log)"
}

# foreign_unpack FOLDER NAME: into FOLDER/unpacked.
foreign_unpack() {
    mkdir -p "$1/unpacked/$2"
    case "$2" in
    *.deb) dpkg-deb -x "$1/$2" "$1/unpacked/$2" ;;
    *) tar -xf "$1/$2" -C "$1/unpacked/$2" --no-same-owner ;;
    esac
}

# foreign_sort FOLDER: every rule file into FOLDER/files, by the hash of what is in it.
foreign_sort() {
    local file sum
    mkdir "$1/files"
    while IFS= read -r -d '' file; do
        sum="$(sha256sum <"$file")"
        cp -- "$file" "$1/files/${sum:0:16}.${file##*.}"
    done < <(find "$1/unpacked" -type f \( -name '*.fll' -o -name '*.fis' -o -name '*.fcl' \) -print0)
}

foreign_setup() {
    local archive name wanted sum
    foreign_is_complete && return 0
    say "set-up: rule files of other projects into build/deps/foreign"
    mkdir -p "$ROOT/build/deps"
    FOREIGN_WORK="$(mktemp -d "$ROOT/build/deps/foreign.XXXXXX")"
    trap 'rm -rf "$FOREIGN_WORK"' EXIT
    for archive in "${FOREIGN_ARCHIVES[@]}"; do
        read -r name wanted <<<"$archive"
        foreign_fetch "$FOREIGN_WORK" "$name"
        sum="$(sha256sum <"$FOREIGN_WORK/$name")"
        [ "${sum%% *}" = "$wanted" ] ||
            fail "$name refused: its sha256 is ${sum%% *}, expected $wanted. Nothing was installed; fetch the genuine file"
        foreign_unpack "$FOREIGN_WORK" "$name"
    done
    foreign_sort "$FOREIGN_WORK"
    rm -rf "$FOREIGN_FOLDER"
    mkdir "$FOREIGN_FOLDER"
    mv "$FOREIGN_WORK/files" "$FOREIGN_FOLDER/files"
    printf '%s\n' "${FOREIGN_ARCHIVES[*]}" >"$FOREIGN_FOLDER/.complete"
}
