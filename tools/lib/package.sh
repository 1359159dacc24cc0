# shellcheck shell=bash
# Debian packages of the Linux controller, and the clean Debian roots that they are made against and
# tried in. Sourced by tools/package.

PACKAGING="$ROOT/linux/packaging"
CLEAN_ROOTS="$ROOT/build/package"

# package_version: that of the newest entry of the change log.
package_version() {
    dpkg-parsechangelog --file "$PACKAGING/debian/changelog" --show-field Version
}

# as_root COMMAND...: ends the script where there is no way to become root.
as_root() {
    packages_as_root || fail "a clean Debian root needs root rights: neither root nor sudo here"
    "${AS_ROOT[@]}" "$@"
}

# root_stamp: what the clean roots are made from. Debian's newest versions come when build/package
# is removed.
root_stamp() {
    printf '%s\n' "$ROOT"
    sha256sum <"$ROOT/tools/lib/clean_root"
}

# root_has FOLDER STEP, root_mark FOLDER STEP: a step is marked last, so that an interrupted one
# starts again.
root_has() {
    [ -f "$1/.$2" ] && [ "$(cat "$1/.$2")" = "$(root_stamp)" ]
}

root_mark() {
    root_stamp | as_root tee "$1/.$2" >/dev/null
}

# root_fetch NAME ARCH PACKAGE...: build/package/root-NAME, unpacked: a Debian with these packages.
root_fetch() {
    local name="$1" folder="$CLEAN_ROOTS/root-$1"
    shift
    root_has "$folder" fetched && return 0
    say "package: a clean Debian 12 for $1 into build/package/root-$name"
    mkdir -p "$CLEAN_ROOTS"
    retry "package-root-$name" as_root "$ROOT/tools/lib/clean_root" fetch "$1" "$folder" "${@:2}" ||
        fail "could not fetch a clean Debian 12 for $1 (log: build/logs/package-root-$name.log). Check the network, then run again"
    root_mark "$folder" fetched
}

# root_of ARCH: to build against and to install packages in.
root_of() {
    root_fetch "$1" "$1" systemd-standalone-sysusers
}

# root_service: to boot in a virtual machine.
root_service() {
    root_fetch service arm64 systemd udev kmod iproute2
}

# root_configure ARCH: the packages' own scripts have run in it: packages can be installed.
root_configure() {
    local folder="$CLEAN_ROOTS/root-$1" log="package-configure-$1"
    root_has "$folder" configured && return 0
    say "package: configuring build/package/root-$1"
    run_logged "$log" as_root "$ROOT/tools/lib/clean_root" configure "$folder" ||
        fail "build/package/root-$1 cannot be configured (log: build/logs/$log.log). Remove it, then run again" 1
    root_mark "$folder" configured
}

# package_cmake ARCH: the arguments of CMake that only this architecture needs.
package_cmake() {
    [ "$1" = amd64 ] || printf '%s' "-DCMAKE_TOOLCHAIN_FILE=$ROOT/cmake/aarch64-linux-gnu.cmake"
}

# package_database ARCH FOLDER: the database of build/package/root-ARCH into FOLDER as dpkg-shlibdeps
# wants to see it: with the paths that the libraries have here.
package_database() {
    local origin="$CLEAN_ROOTS/root-$1"
    cp -R "$origin/var/lib/dpkg" "$2"
    sed -i -e 's#^/lib/#/usr/lib/#' -e "s#^/#$origin/#" "$2"/info/*.list
}

# package_build ARCH OUT: OUT/packages/quiesced_VERSION_ARCH.deb, made in OUT/package/ARCH. The same
# sources give the same file, wherever and whenever it is made.
package_build() {
    local arch="$1" work="$2/package/$1" file start_s=$SECONDS
    file="quiesced_$(package_version)_$arch.deb"
    rm -rf "$work"
    mkdir -p "$work/quiesce" "$2/packages"
    cp -R "$PACKAGING/debian" "$work/quiesce/debian"
    package_database "$arch" "$work/database"
    (cd "$work/quiesce" && umask 022 &&
        QUIESCE_SOURCE="$ROOT" QUIESCE_ROOT="$CLEAN_ROOTS/root-$arch" \
            QUIESCE_DATABASE="$work/database" QUIESCE_CMAKE="$(package_cmake "$arch")" \
            DEB_BUILD_OPTIONS="noautodbgsym nocheck" run_logged "package-$arch" \
            dpkg-buildpackage --build=binary --no-sign --no-check-builddeps --host-arch "$arch") || {
        tail -n 40 "$LOG_DIR/package-$arch.log" >&2
        fail "the package for $arch cannot be built; the whole log is build/logs/package-$arch.log" 1
    }
    mv "$work/$file" "$2/packages/$file"
    say "package: ${2#"$ROOT/"}/packages/$file ($((SECONDS - start_s)) s)"
}
