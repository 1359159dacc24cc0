# shellcheck shell=bash
# The Python package: wheel and source archive. Sourced by tools/package.
# shellcheck source=tools/lib/python.sh
source "$ROOT/tools/lib/python.sh"
# shellcheck source=tools/lib/build.sh
source "$ROOT/tools/lib/build.sh"

PACKAGE_PYTHONS="$ROOT/build/package/python" # an environment for each version
PACKAGE_REQUIREMENTS="$ROOT/tools/requirements-package.txt"

# wheel_python: PACKAGE_PYTHON, the environment that makes packages for $PYTHON, of pinned tools.
wheel_python() {
    local stamp
    python_require
    PACKAGE_PYTHON="$PACKAGE_PYTHONS-$("$PYTHON" -c 'import sys; print("%d.%d" % sys.version_info[:2])')"
    stamp="$(sha256sum <"$PACKAGE_REQUIREMENTS") $("$PYTHON" -V) $ROOT"
    [ "$(cat "$PACKAGE_PYTHON/.complete" 2>/dev/null)" = "$stamp" ] && return 0
    say "package: environment ${PACKAGE_PYTHON#"$ROOT/"} with the packages of tools/requirements-package.txt"
    rm -rf "$PACKAGE_PYTHON"
    run_logged package-venv "$PYTHON" -m venv "$PACKAGE_PYTHON" ||
        fail "'$PYTHON -m venv' failed (log: build/logs/package-venv.log). Is the disk full?"
    retry package-python pip_of "$PACKAGE_PYTHON" install --require-hashes -r "$PACKAGE_REQUIREMENTS" ||
        fail "could not install the packages' tools: $(pip_reason package-python) (log: build/logs/package-python.log)"
    printf '%s' "$stamp" >"$PACKAGE_PYTHON/.complete"
}

# made_package LOG FOLDER OPTION...: runs `python -m build`; the name of the file that is in FOLDER then.
made_package() {
    local log="$1" folder="$2"
    run_logged "$log" "$PACKAGE_PYTHON/bin/python" -I -m build --no-isolation --outdir "$folder" \
        "${@:3}" "$ROOT" || {
        tail -n 20 "$LOG_DIR/$log.log" >&2
        fail "the package cannot be built; the whole log is build/logs/$log.log" 1
    }
    ls "$folder"
}

# sdist_build OUT: OUT/packages/quiesce-VERSION.tar.gz.
sdist_build() {
    local file
    wheel_python
    work_folder
    mkdir -p "$1/packages" "$WORK_FOLDER/sdist"
    file="$(made_package package-sdist "$WORK_FOLDER/sdist" --sdist)"
    mv "$WORK_FOLDER/sdist/$file" "$1/packages/$file"
    say "package: ${1#"$ROOT/"}/packages/$file"
}

# wheel_build OUT OPTION...: OUT/packages/quiesce-VERSION-PYTHON-PLATFORM.whl, for the Python that made it and
# for every Linux with this machine's C library or a newer one.
wheel_build() {
    local out="$1" file plain libc start_s=$SECONDS
    shift
    wheel_python
    build_preset mps2 "${DRIVEN_IMAGES[@]}"
    build_cache
    work_folder
    mkdir -p "$out/packages" "$WORK_FOLDER/plain" "$WORK_FOLDER/wheel"
    say "package: wheel: compiling bench, plant and damper models (minutes the first time)"
    plain="$(made_package package-wheel "$WORK_FOLDER/plain" --wheel -Cbuild-dir='build/wheel-{wheel_tag}' \
        -Ccmake.define.QUIESCE_IMAGES="$ROOT/build/mps2/targets/mps2" "$@")"
    libc="$(getconf GNU_LIBC_VERSION)"
    libc="${libc##* }"
    PATH="$PACKAGE_PYTHON/bin:$PATH" run_logged package-platform "$PACKAGE_PYTHON/bin/auditwheel" \
        repair --plat "manylinux_${libc/./_}_$(uname -m)" --wheel-dir "$WORK_FOLDER/wheel" \
        "$WORK_FOLDER/plain/$plain" ||
        fail "the wheel needs more than a Linux with glibc $libc has (log: build/logs/package-platform.log)" 1
    file="$(ls "$WORK_FOLDER/wheel")"
    mv "$WORK_FOLDER/wheel/$file" "$out/packages/$file"
    say "package: ${out#"$ROOT/"}/packages/$file ($((SECONDS - start_s)) s)"
}
