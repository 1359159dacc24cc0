# shellcheck shell=bash
# A folder to build in for tools that take no space in a path. Sourced by tests/system/vm/build_images and
# tools/package.

WORK_FOLDER=""

# work_folder: WORK_FOLDER, empty, without a space in its name; it goes with the script.
work_folder() {
    local parent="${TMPDIR:-/tmp}"
    [ -z "$WORK_FOLDER" ] || return 0
    [[ "$parent" != *[[:space:]]* ]] || parent=/tmp
    WORK_FOLDER="$(mktemp -d "$parent/quiesce.XXXXXX")" ||
        fail "cannot make a folder in $parent. Is the disk full?"
    trap 'rm -rf "$WORK_FOLDER"' EXIT
}
