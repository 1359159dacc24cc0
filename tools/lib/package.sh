# shellcheck shell=bash
# Debian packages of the Linux controller, and the clean Debian roots that they are made against and
# tried in. Sourced by tools/package.

PACKAGING="$ROOT/targets/linux/packaging"
CLEAN_ROOTS="$ROOT/build/package"
PACKAGE_NAMES=(quiesced libquiesce-dev)

# package_version: that of the newest entry of the change log.
package_version() {
    dpkg-parsechangelog --file "$PACKAGING/debian/changelog" --show-field Version
}

# need_root: into AS_ROOT; ends the script where there is no way. What as_root is called in logs all
# that is said: ask before.
need_root() {
    packages_as_root ||
        fail "a clean Debian root needs root rights, and here is neither root nor sudo: run as root"
}

as_root() {
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
# Those of root-ARCH are kept in build/package/fetched-ARCH: no other root fetches them again.
root_fetch() {
    local name="$1" folder="$CLEAN_ROOTS/root-$1"
    shift
    root_has "$folder" fetched && return 0
    need_root
    say "package: a clean Debian 12 for $1 into build/package/root-$name"
    mkdir -p "$CLEAN_ROOTS"
    [ "$name" != "$1" ] || as_root rm -rf "$CLEAN_ROOTS/fetched-$1"
    retry "package-root-$name" as_root "$ROOT/tools/lib/clean_root" fetch "$1" "$folder" \
        "$CLEAN_ROOTS/fetched-$1" "${@:2}" ||
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
    need_root
    say "package: configuring build/package/root-$1"
    run_logged "$log" as_root "$ROOT/tools/lib/clean_root" configure "$folder" ||
        fail "build/package/root-$1 cannot be configured (log: build/logs/$log.log). Remove it, then run again" 1
    root_mark "$folder" configured
}

# package_libraries ARCH FOLDER: the libraries of build/package/root-ARCH into FOLDER/root, and its
# database into FOLDER/database as dpkg-shlibdeps wants to see it: with the paths of those.
package_libraries() {
    local origin="$CLEAN_ROOTS/root-$1" libraries
    libraries="usr/lib/$(dpkg-architecture --host-arch "$1" --query DEB_HOST_MULTIARCH)"
    mkdir -p "$2/root/$libraries"
    find "$origin/$libraries" -maxdepth 1 -name '*.so*' -exec cp -P -t "$2/root/$libraries" {} +
    cp -R "$origin/var/lib/dpkg" "$2/database"
    sed -i -e 's#^/lib/#/usr/lib/#' -e "s#^/#$2/root/#" "$2"/database/info/*.list
}

# package_build ARCH OUT: OUT/packages/NAME_VERSION_ARCH.deb of each package. Debian's tools take no
# space in a path: they see the sources through a link. The same sources give the same files,
# wherever and whenever they are made.
package_build() {
    local arch="$1" work name file cmake="" start_s=$SECONDS
    work_folder
    work="$WORK_FOLDER/$arch"
    mkdir -p "$work/quiesce" "$2/packages"
    cp -R "$PACKAGING/debian" "$work/quiesce/debian"
    ln -s "$ROOT" "$work/source"
    [ "$arch" = amd64 ] ||
        cmake="-DCMAKE_TOOLCHAIN_FILE=$work/source/cmake/aarch64-linux-gnu.cmake"
    package_libraries "$arch" "$work"
    (cd "$work/quiesce" && umask 022 &&
        QUIESCE_SOURCE="$work/source" QUIESCE_ROOT="$work/root" \
            QUIESCE_DATABASE="$work/database" QUIESCE_CMAKE="$cmake" \
            DEB_BUILD_OPTIONS="noautodbgsym nocheck" run_logged "package-$arch" \
            dpkg-buildpackage --build=binary --no-sign --no-check-builddeps --host-arch "$arch") || {
        tail -n 40 "$LOG_DIR/package-$arch.log" >&2
        fail "the package for $arch cannot be built; the whole log is build/logs/package-$arch.log" 1
    }
    for name in "${PACKAGE_NAMES[@]}"; do
        file="${name}_$(package_version)_$arch.deb"
        mv "$work/$file" "$2/packages/$file"
        say "package: ${2#"$ROOT/"}/packages/$file"
    done
    say "package: $arch took $((SECONDS - start_s)) s"
}
