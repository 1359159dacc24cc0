# shellcheck shell=bash
# A folder to build in for tools that take no space in a path. Sourced by tools/vm_images and
# tools/package.

# work_folder: WORK, empty, without a space in its name; it goes with the script.
work_folder() {
    local parent="${TMPDIR:-/tmp}"
    [[ "$parent" != *[[:space:]]* ]] || parent=/tmp
    [ -z "${WORK:-}" ] || return 0
    WORK="$(mktemp -d "$parent/quiesce.XXXXXX")" ||
        fail "cannot make a folder in $parent. Is the disk full?"
    trap 'rm -rf "$WORK"' EXIT
}
