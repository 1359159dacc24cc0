# shellcheck shell=bash
# Debian packages: which are missing, and how they are installed. Sourced by tools/setup.

# packages_of GROUP: package names of tools/packages.txt; every group includes group run, and all is
# what the whole of ./tools/test needs.
packages_of() {
    awk -v group="$1" '/^#/ || NF == 0 { next }
        $1 == "run" || $1 == group || (group == "all" && $1 != "bench") { print $2 }' \
        "$ROOT/tools/packages.txt"
}

# packages_missing PACKAGE...: those that dpkg does not know as installed.
packages_missing() {
    local installed package
    installed=" $(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null |
        awk '$1 == "installed" { printf "%s ", $2 }' || true)"
    for package in "$@"; do
        [[ "$installed" == *" $package "* ]] || printf '%s\n' "$package"
    done
}

# packages_as_root: how to become root, in AS_ROOT; false iff there is no way.
packages_as_root() {
    AS_ROOT=()
    [ "$(id -u)" -eq 0 ] && return 0
    command -v sudo >/dev/null || return 1
    AS_ROOT=(sudo)
    # Without a terminal sudo cannot ask for a password.
    [ -t 0 ] || sudo -n true 2>/dev/null
}

packages_unavailable() {
    local package
    for package in "$@"; do
        apt-get install --simulate "$package" >/dev/null 2>&1 || printf '%s ' "$package"
    done
}

# packages_reason: apt-get's last error, in its words.
packages_reason() {
    grep -h '^E:' "$LOG_DIR/setup-apt-install.log" | tail -n 1 | cut -c1-300 || true
}

# packages_install PACKAGE...: installs them or says which cannot be had, and stops.
packages_install() {
    local line="apt-get update && apt-get install -y --no-install-recommends $*" unavailable apt
    local hint="install them by hand, then run again with QUIESCE_SKIP_PACKAGES=1"
    command -v apt-get >/dev/null ||
        fail "Debian packages missing: $*. There is no apt-get on this system: $hint"
    packages_as_root ||
        fail "Debian packages missing: $*. Neither root nor sudo here. As root run: $line"
    say "set-up: installing Debian packages: $*"
    apt=("${AS_ROOT[@]}" env DEBIAN_FRONTEND=noninteractive apt-get
        -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300)
    retry setup-apt-update "${apt[@]}" update ||
        say "set-up: 'apt-get update' failed (build/logs/setup-apt-update.log); trying the lists at hand"
    retry setup-apt-install "${apt[@]}" install -y --no-install-recommends "$@" && return 0
    unavailable="$(packages_unavailable "$@")"
    if [ -n "$unavailable" ]; then
        fail "this machine's package sources do not offer: ${unavailable% }. Quiesce is built on Debian 12 (bookworm): add its source, or $hint"
    fi
    fail "apt-get could not install: $* ($(packages_reason)). Check the network, then run again, or as root run: $line (log: build/logs/setup-apt-install.log)"
}

# packages_are_installed PACKAGE...: or nobody wants to know.
packages_are_installed() {
    [ -n "${QUIESCE_SKIP_PACKAGES:-}" ] || [ -z "$(packages_missing "$@")" ]
}

# packages_setup PACKAGE...: nothing where all are installed.
packages_setup() {
    local missing
    packages_are_installed "$@" && return 0
    mapfile -t missing < <(packages_missing "$@")
    packages_install "${missing[@]}"
}
