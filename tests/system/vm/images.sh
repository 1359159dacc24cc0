# shellcheck shell=bash
# Debian's arm64 packages: libraries that the Linux controller is cross-built with, and the real-time
# kernel and tools of the virtual machine that it is tested in. They come from an apt root of our own
# in build/vm/apt: nothing of this system's package state changes, and no architecture is added to it.
# Sourced by tests/system/vm/build_images.

VM_FOLDER="$ROOT/build/vm"
VM_CACHE="${QUIESCE_VM_CACHE:-$VM_FOLDER/cache}"
ARM64_ROOT="$ROOT/build/deps/arm64"
VM_KERNEL="$VM_FOLDER/kernel"

# For the cross build, and what its programs are linked with at run time.
ARM64_PACKAGES=(libc6 libgcc-s1 libstdc++6 libgpiod-dev libgpiod2 libtomlplusplus-dev
    libtomlplusplus3 libgtest-dev)
# The guest's tools and their libraries.
ARM64_PACKAGES+=(busybox-static can-utils gpiod rt-tests libnuma1
    iproute2 libbpf1 libelf1 libmnl0 libbsd0 libcap2 libmd0 zlib1g)
VM_FLAVOUR=rt-arm64
VM_KERNEL_PARTS=('./boot/vmlinuz-*' './lib/modules/*/kernel/net/can/*'
    './lib/modules/*/kernel/drivers/net/can/*' './lib/modules/*/kernel/drivers/watchdog/*'
    './lib/modules/*/kernel/fs/configfs/*')

# gpio-sim is in no Debian kernel: it is built from Debian's own sources (GPL-2.0), out of tree. The
# sums are those of one version of the sources; another one's files are as apt has verified them.
GPIO_SIM_VERSION=6.1.176-1
GPIO_SIM_FILES=(drivers/gpio/gpio-sim.c drivers/gpio/gpiolib.h kernel/irq/irq_sim.c)
GPIO_SIM_SHA256="119a85063ac76efcfb9ff8ce87990f38133930a35d013e614a2e631ce8a67b95  gpio-sim.c
56b20e6827aa7eafded0bb997b3549924f4462c0018c111a35147c797cc1ffd5  gpiolib.h
5ede5ec621858bb56cd7cd891c324eec6ddc7d27a7e92e2663a8b5b5a0ff615b  irq_sim.c"

# vm_apt: the options in VM_APT make apt use build/vm/apt and this system's first Debian mirror.
vm_apt() {
    local apt="$VM_FOLDER/apt" mirror
    mirror="$(sed -n 's/^URIs: *//p' /etc/apt/sources.list.d/debian.sources 2>/dev/null | head -n 1)"
    [ -n "$mirror" ] || mirror="$(sed -n 's/^deb \(\[[^]]*\] \)*\(http[^ ]*\) bookworm .*/\2/p' \
        /etc/apt/sources.list 2>/dev/null | head -n 1)"
    mkdir -p "$apt"/etc/apt/{apt.conf.d,preferences.d} "$apt"/var/lib/{apt/lists/partial,dpkg} \
        "$apt"/var/cache/apt/archives/partial
    : >"$apt/var/lib/dpkg/status"
    printf 'deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] %s bookworm main\n' \
        "${mirror:-http://deb.debian.org/debian}" >"$apt/etc/apt/sources.list"
    VM_APT=(-o "Dir=$apt" -o "Dir::State::status=$apt/var/lib/dpkg/status"
        -o Dir::Etc::sourceparts=- -o Acquire::Languages=none -o APT::Update::Error-Mode=any
        -o APT::Architecture=arm64 -o APT::Architectures::=arm64 -o APT::Architectures::=amd64
        -o "APT::Sandbox::User=$(id -un)")
}

# vm_stamp: what everything here was made from.
vm_stamp() {
    printf '%s\n' "$ROOT"
    sha256sum <"$ROOT/tests/system/vm/images.sh"
}

vm_has_stamp() {
    [ -f "$1/.complete" ] && [ "$(cat "$1/.complete")" = "$(vm_stamp)" ]
}

# vm_index: the newest packages that Debian has, once a run.
vm_index() {
    [ -z "${VM_HAS_INDEX:-}" ] || return 0
    vm_apt
    retry setup-vm-index apt-get "${VM_APT[@]}" update ||
        fail "could not fetch Debian's list of arm64 packages (log: build/logs/setup-vm-index.log). Check the network, then run again, or name a folder with all packages: QUIESCE_VM_CACHE=FOLDER"
    VM_HAS_INDEX=1
}

# vm_cache_is_whole NAME: the cache has that list and every file in it.
vm_cache_is_whole() {
    [ -f "$VM_CACHE/$1.sha256" ] &&
        (cd "$VM_CACHE" && tail -n +2 "$1.sha256" | sha256sum --status --check - 2>/dev/null)
}

# vm_list NAME PACKAGE...: "SHA256  FILE" of each into CACHE/NAME.sha256. The list of a cache that
# holds all its files stays as it is: versions change when the cache is removed.
vm_list() {
    local name="$1" list="$VM_CACHE/$1.sha256" wanted
    shift
    wanted="# $*"
    vm_cache_is_whole "$name" && [ "$(head -n 1 "$list")" = "$wanted" ] && return 0
    vm_index
    run_logged setup-vm-list apt-get "${VM_APT[@]}" --print-uris download "$@" ||
        fail "Debian's arm64 packages lack one of: $* (log: build/logs/setup-vm-list.log)"
    {
        printf '%s\n' "$wanted"
        sed -n "s/^'[^']*' \([^ ]*\) [0-9]* SHA256:\([0-9a-f]*\)\$/\2  \1/p" \
            "$LOG_DIR/setup-vm-list.log"
    } >"$list.new"
    mv "$list.new" "$list"
}

# vm_fetch NAME PACKAGE...: each package file into the cache, where it is not there already.
vm_fetch() {
    local list="$VM_CACHE/$1.sha256" sum file package missing=()
    mkdir -p "$VM_CACHE"
    vm_list "$@"
    shift
    while read -r sum file; do
        [ "$sum" != "#" ] || continue
        (cd "$VM_CACHE" && sha256sum --status --check - <<<"$sum  $file" 2>/dev/null) && continue
        package="${file%%_*}"
        [[ "$file" != *_amd64.deb ]] || package+=":amd64"
        missing+=("$package")
    done <"$list"
    ((${#missing[@]} > 0)) || return 0
    vm_index
    vm_download "${missing[@]}"
}

# vm_download PACKAGE...: apt compares with the signed index.
vm_download() {
    say "set-up: fetching ${#} Debian packages for arm64"
    (cd "$VM_CACHE" && retry setup-vm-fetch apt-get "${VM_APT[@]}" download "$@") ||
        fail "could not fetch the Debian arm64 packages $* (log: build/logs/setup-vm-fetch.log). Check the network, then run again"
}

# vm_files NAME: paths of the list's package files.
vm_files() {
    awk -v cache="$VM_CACHE" '$1 != "#" { print cache "/" $2 }' "$VM_CACHE/$1.sha256"
}

# arm64_setup: build/deps/arm64, Debian's arm64 packages unpacked.
arm64_setup() {
    local file work="$ARM64_ROOT.new"
    vm_has_stamp "$ARM64_ROOT" && return 0
    say "set-up: Debian's arm64 libraries into build/deps/arm64"
    vm_fetch arm64 "${ARM64_PACKAGES[@]}"
    rm -rf "$work"
    mkdir -p "$work"
    while IFS= read -r file; do
        dpkg-deb -x "$file" "$work" || fail "cannot unpack $file. Is the disk full?"
    done < <(vm_files arm64)
    vm_stamp >"$work/.complete"
    rm -rf "$ARM64_ROOT"
    mv "$work" "$ARM64_ROOT"
}

# gpio_sim_is_complete FOLDER: the three files, as the folder's own sums say, or those of here.
gpio_sim_is_complete() {
    local sums="$GPIO_SIM_SHA256"
    [ ! -f "$1/sums" ] || sums="$(cat "$1/sums")"
    [ -d "$1" ] && (cd "$1" && sha256sum --status --check - <<<"$sums" 2>/dev/null)
}

# gpio_sim_note FOLDER VERSION: notes the sums of another version's files where all three are there.
gpio_sim_note() {
    [ "$2" != "$GPIO_SIM_VERSION" ] || return 0
    gpio_sim_is_complete "$1" && return 0
    (cd "$1" && sha256sum "${GPIO_SIM_FILES[@]##*/}") >"$1/sums.new" 2>/dev/null || return 0
    mv "$1/sums.new" "$1/sums"
    say "set-up: linux-source-6.1 is $2, the checksums in tests/system/vm/images.sh are of $GPIO_SIM_VERSION; gpio-sim's files are those that apt verified"
}

# gpio_sim_fetch: three files of Debian's kernel sources (139 MB) into CACHE/gpio-sim.
gpio_sim_fetch() {
    local folder="$VM_CACHE/gpio-sim" archive version
    gpio_sim_is_complete "$folder" && return 0
    vm_index
    vm_download linux-source-6.1
    archive="$(find "$VM_CACHE" -name 'linux-source-6.1_*.deb' | sort -V | tail -n 1)"
    rm -rf "$folder"
    mkdir -p "$folder"
    # tar stops reading when it has all three: that the others' pipes break is no error.
    (set +o pipefail
        dpkg-deb --fsys-tarfile "$archive" 2>/dev/null |
            tar -xO ./usr/src/linux-source-6.1.tar.xz 2>/dev/null | xz -dc 2>/dev/null |
            tar -x -C "$folder" --no-same-owner --occurrence=1 --transform 's#.*/##' \
                "${GPIO_SIM_FILES[@]/#/linux-source-6.1/}") || true
    version="${archive##*/linux-source-6.1_}"
    gpio_sim_note "$folder" "${version%_all.deb}"
    gpio_sim_is_complete "$folder" ||
        fail "gpio-sim refused: its files in ${archive##*/} are not the ones with the checksums in tests/system/vm/images.sh. See what has changed in them, then change the checksums"
    rm "$archive"
}

# gpio_sim_build FOLDER VERSION: FOLDER/gpio-sim.ko for the kernel whose headers are in FOLDER/headers.
# The kernel's Makefile takes no space in a path.
gpio_sim_build() {
    local headers="$1/headers/usr/src/linux-headers-$2" work="$1/gpio-sim"
    mkdir -p "$work"
    cp "$VM_CACHE/gpio-sim"/* "$work/"
    mv "$work/gpio-sim.c" "$work/gpio_sim_main.c"
    # One module of both: what the kernel does not export it does not need.
    sed -i 's/handle_simple_irq(irq_to_desc(irqnum))/generic_handle_irq_safe(irqnum)/
        /^EXPORT_SYMBOL_GPL/d' "$work/irq_sim.c"
    printf 'obj-m += gpio-sim.o\ngpio-sim-y := gpio_sim_main.o irq_sim.o\n' >"$work/Kbuild"
    # Debian's headers name absolute paths.
    sed -i "s#^include /usr/src#include $1/headers/usr/src#" "$headers/Makefile"
    run_logged build-gpio-sim make -C "$headers" "M=$work" ARCH=arm64 \
        CROSS_COMPILE=aarch64-linux-gnu- modules ||
        fail "gpio-sim.ko does not build (log: build/logs/build-gpio-sim.log)" 1
    aarch64-linux-gnu-strip --strip-debug -o "$1/gpio-sim.ko" "$work/gpio-sim.ko"
}

# vm_kernel_packages: into VM_KERNEL_PACKAGES. A whole cache knows the version that it has.
vm_kernel_packages() {
    local image version
    VM_KERNEL_PACKAGES=()
    if vm_cache_is_whole kernel; then
        read -r -a VM_KERNEL_PACKAGES < <(sed -n '1s/^# //p' "$VM_CACHE/kernel.sha256")
        return 0
    fi
    vm_index
    image="$(apt-cache "${VM_APT[@]}" depends "linux-image-$VM_FLAVOUR" 2>/dev/null |
        sed -n 's/.*Depends: \(linux-image-\)/\1/p' | head -n 1 || true)"
    version="${image#linux-image-}"
    [ -n "$version" ] || fail "Debian has no linux-image-$VM_FLAVOUR: is the list of packages whole?"
    VM_KERNEL_PACKAGES=("$image" "linux-headers-$version"
        "linux-headers-${version%-"$VM_FLAVOUR"}-common-rt" linux-kbuild-6.1:amd64)
}

# vm_kernel_unpack FOLDER HEADERS: kernel and modules into FOLDER/root, headers into HEADERS.
vm_kernel_unpack() {
    local file
    mkdir -p "$1/root" "$2"
    while IFS= read -r file; do
        case "${file##*/}" in
        linux-image-*)
            dpkg-deb --fsys-tarfile "$file" |
                tar -x -C "$1/root" --no-same-owner --wildcards "${VM_KERNEL_PARTS[@]}"
            ;;
        *) dpkg-deb -x "$file" "$2" ;;
        esac
    done < <(vm_files kernel)
}

# vm_kernel_setup: build/vm/kernel with vmlinuz, version, root/lib/modules and gpio-sim.ko.
vm_kernel_setup() {
    local version work="$VM_KERNEL.new"
    vm_has_stamp "$VM_KERNEL" && return 0
    say "set-up: Debian's real-time kernel for arm64 into build/vm/kernel"
    mkdir -p "$VM_CACHE"
    vm_kernel_packages
    vm_fetch kernel "${VM_KERNEL_PACKAGES[@]}"
    gpio_sim_fetch
    rm -rf "$work"
    work_folder
    vm_kernel_unpack "$work" "$WORK_FOLDER/headers" || fail "cannot unpack the kernel's packages. Is the disk full?"
    version="${VM_KERNEL_PACKAGES[0]#linux-image-}"
    gpio_sim_build "$WORK_FOLDER" "$version"
    mv "$WORK_FOLDER/gpio-sim.ko" "$work/gpio-sim.ko"
    mv "$work/root/boot/vmlinuz-$version" "$work/vmlinuz"
    printf '%s\n' "$version" >"$work/version"
    vm_stamp >"$work/.complete"
    rm -rf "$VM_KERNEL"
    mv "$work" "$VM_KERNEL"
}
