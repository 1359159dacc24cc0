# shellcheck shell=bash
# libfuzzylite (GPL) for the emulated Cortex-M4, which a benchmark counts the instructions of: its
# Debian source archive, and the C++ library of the cross compiler, of which only what the one image
# needs is unpacked. Both come from this system's own package sources. Sourced by tools/benchmarks/build_images.

FUZZYLITE_FOLDER="$ROOT/build/deps/fuzzylite"
FUZZYLITE_NAME="fuzzylite_6.0+dfsg.orig.tar.xz"
FUZZYLITE_SHA256="31c871149f63143cd8f25dafcb945cebc56ddd4ba711a020a41b34fa7df643a3"
ARM_CXX_PACKAGES=(libstdc++-arm-none-eabi-dev libstdc++-arm-none-eabi-newlib)
ARM_CXX_MULTILIB="usr/lib/arm-none-eabi/newlib/thumb/v7e-m+fp/hard"

# fuzzylite_is_complete: both were unpacked to the end, from this very archive.
fuzzylite_is_complete() {
    [ -f "$FUZZYLITE_FOLDER/.complete" ] &&
        [ "$(cat "$FUZZYLITE_FOLDER/.complete")" = "$FUZZYLITE_SHA256" ]
}

# apt_sources FOLDER: the system's package sources as source packages; what apt is to use instead of
# its own folders goes into APT_PRIVATE. Nothing of the system changes.
apt_sources() {
    local file
    mkdir -p "$1/parts" "$1/lists/partial" "$1/cache/archives/partial"
    for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
        [ ! -f "$file" ] || sed -n 's/^deb[[:space:]]/deb-src /p' "$file" >"$1/parts/${file##*/}.list"
    done
    for file in /etc/apt/sources.list.d/*.sources; do
        [ ! -f "$file" ] || sed 's/^Types:.*/Types: deb-src/' "$file" >"$1/parts/${file##*/}"
    done
    APT_PRIVATE=(-o "Dir::Etc::SourceList=/dev/null" -o "Dir::Etc::SourceParts=$1/parts"
        -o "Dir::State::Lists=$1/lists" -o "Dir::Cache=$1/cache" -o "Acquire::Retries=3"
        -o "APT::Sandbox::User=$(id -un)")
}

# fuzzylite_fetch FOLDER: the source archive into it, from QUIESCE_FUZZYLITE_ARCHIVE where that is set.
fuzzylite_fetch() {
    local sum
    if [ -n "${QUIESCE_FUZZYLITE_ARCHIVE:-}" ]; then
        cp -- "$QUIESCE_FUZZYLITE_ARCHIVE" "$1/$FUZZYLITE_NAME" 2>/dev/null ||
            fail "QUIESCE_FUZZYLITE_ARCHIVE: cannot read $QUIESCE_FUZZYLITE_ARCHIVE"
    else
        apt_sources "$1/apt"
        run_logged setup-fuzzylite-lists apt-get "${APT_PRIVATE[@]}" update || true
        # Of the files of the source package only this one is needed: its checksum decides.
        (cd "$1" && run_logged setup-fuzzylite apt-get "${APT_PRIVATE[@]}" \
            source --download-only --only-source fuzzylite=6.0+dfsg-6) || true
        rm -rf "$1/apt"
    fi
    [ -f "$1/$FUZZYLITE_NAME" ] ||
        fail "could not fetch $FUZZYLITE_NAME from Debian's source packages (log: build/logs/setup-fuzzylite.log). Get it elsewhere and name it: QUIESCE_FUZZYLITE_ARCHIVE=/path/to/$FUZZYLITE_NAME"
    sum="$(sha256sum <"$1/$FUZZYLITE_NAME")"
    [ "${sum%% *}" = "$FUZZYLITE_SHA256" ] ||
        fail "$FUZZYLITE_NAME refused: its sha256 is ${sum%% *}, expected $FUZZYLITE_SHA256. Nothing was installed; fetch the genuine file"
    tar -xJf "$1/$FUZZYLITE_NAME" -C "$1" --strip-components=2 --no-same-owner --touch \
        fuzzylite-6.0/fuzzylite/fl fuzzylite-6.0/fuzzylite/src
    rm "$1/$FUZZYLITE_NAME"
}

# arm_cxx_fetch FOLDER: headers and libraries of C++ for the image's processor, 70 MB of 1.5 GB.
arm_cxx_fetch() {
    local package members
    (cd "$1" && retry setup-arm-cxx apt-get download "${ARM_CXX_PACKAGES[@]}") ||
        fail "could not fetch the Debian packages ${ARM_CXX_PACKAGES[*]} (log: build/logs/setup-arm-cxx.log). Run apt-get update, then again"
    mkdir -p "$1/arm"
    for package in "${ARM_CXX_PACKAGES[@]}"; do
        members=(./usr/include)
        [[ "$package" != *newlib ]] || members=("./$ARM_CXX_MULTILIB")
        dpkg-deb --fsys-tarfile "$1/$package"_*.deb | tar -x -C "$1/arm" "${members[@]}"
    done
    rm "$1"/*.deb
}

fuzzylite_setup() {
    fuzzylite_is_complete && return 0
    say "set-up: libfuzzylite's sources and C++ for the Cortex-M4 (315 MB) into build/deps/fuzzylite"
    mkdir -p "$ROOT/build/deps"
    FUZZYLITE_WORK="$(mktemp -d "$ROOT/build/deps/fuzzylite.XXXXXX")"
    trap 'rm -rf "$FUZZYLITE_WORK"' EXIT
    fuzzylite_fetch "$FUZZYLITE_WORK"
    arm_cxx_fetch "$FUZZYLITE_WORK"
    printf '%s\n' "$FUZZYLITE_SHA256" >"$FUZZYLITE_WORK/.complete"
    chmod 755 "$FUZZYLITE_WORK"
    rm -rf "$FUZZYLITE_FOLDER"
    mv "$FUZZYLITE_WORK" "$FUZZYLITE_FOLDER"
}

# fuzzylite_build: build/mps2/tools/benchmarks/fuzzylite_cost.elf.
fuzzylite_build() {
    local folder="$ROOT/build/fuzzylite" log="$LOG_DIR/build-fuzzylite.log"
    lock build-fuzzylite 9
    if [ ! -f "$folder/build.ninja" ]; then
        say "build fuzzylite: configuring"
        run_logged configure-fuzzylite cmake -G Ninja -S "$ROOT/tools/benchmarks/mps2/fuzzylite" -B "$folder" \
            --toolchain "$ROOT/cmake/arm-none-eabi.cmake" -DCMAKE_BUILD_TYPE=Release \
            -DCMAKE_CXX_COMPILER=arm-none-eabi-g++ "-DARM_CXX_DIR=$FUZZYLITE_FOLDER/arm" \
            "-DCMAKE_RUNTIME_OUTPUT_DIRECTORY=$ROOT/build/mps2/tools/benchmarks" ||
            build_failed fuzzylite "$LOG_DIR/configure-fuzzylite.log"
    fi
    [ -f "$ROOT/build/mps2/tools/benchmarks/fuzzylite_cost.elf" ] || say "build fuzzylite: a minute or two"
    run_logged build-fuzzylite cmake --build "$folder" --parallel "$(nproc)" ||
        build_failed fuzzylite "$log"
    exec 9>&-
}
