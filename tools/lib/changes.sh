# shellcheck shell=bash
# What changed, for the steps that look at no more than that. Sourced by tools/test.

# changed_base: the commit to compare with: QUIESCE_BASE; where this branch left main; else (on main
# itself, or in a clone that knows no main) the commit before the last. Nothing where there is none.
changed_base() {
    local main base
    if [ -n "${QUIESCE_BASE:-}" ]; then
        git rev-parse --quiet --verify --end-of-options "$QUIESCE_BASE^{commit}" ||
            fail "QUIESCE_BASE: no commit '$QUIESCE_BASE' here"
        return 0
    fi
    for main in origin/main main; do
        base="$(git merge-base HEAD "$main" 2>/dev/null)" || continue
        [ "$base" = "$(git rev-parse HEAD)" ] || { echo "$base" && return 0; }
    done
    git rev-parse --quiet --verify HEAD~1 || true
}

# changed_lines: "LINES PATH" of every file that is not as in the base, committed or not.
changed_lines() {
    local base
    base="$(changed_base)" || return
    git diff --numstat --no-renames --diff-filter=d "${base:-HEAD}" 2>/dev/null |
        awk -F '\t' '{ print $1 + $2, $3 }'
    git ls-files --others --exclude-standard 2>/dev/null | sed 's/^/100 /'
}

# edited_files: those that differ from the last commit, or are new.
edited_files() {
    git diff --name-only --no-renames --diff-filter=d HEAD
    git ls-files --others --exclude-standard
}

# touched QUESTION: tools/lib/touched.py about the lines on standard input.
touched() {
    "$ROOT/.venv/bin/python" -I "$ROOT/tools/lib/touched.py" "$1"
}
