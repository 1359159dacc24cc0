# shellcheck shell=bash
# The headers of FMI 2.0 and 3.0 (BSD licence), which come with fmpy: what the library of `quiesce fmu` is
# built with. Sourced by tools/setup, after python.sh.

FMI_FOLDER="$ROOT/build/deps/fmi"
FMI_SHA256="756da446057a5a6dec47a5938e099ba3a9b1882326672b393c6f7dd8571e3456  fmi2FunctionTypes.h
9df3cb9d50d810ef993e1fc2925d19b5886e08809b31ac10de361ceeba62ad1a  fmi2Functions.h
50a180641623f47f2e48fc445707549ce4ec2e27358e2451a2dad5b6dfc55287  fmi2TypesPlatform.h
77bb086dbf9b9123f75edc2a90a0f27fb5c32f913ab3f9b69fe2e2cbc2448b24  fmi3FunctionTypes.h
6367e9f7895848ed8d06c8a9b7f77e72d9f3eae102f64c313d51c10049b720ee  fmi3Functions.h
19ea19ae07cdab582931fc1a545d9aeef3d5066da131ee96a7e393e72164fa30  fmi3PlatformTypes.h"

# fmi_is_complete FOLDER: its files are there, with the right contents.
fmi_is_complete() {
    [ -d "$1" ] && (cd "$1" && sha256sum --status --check - <<<"$FMI_SHA256" 2>/dev/null)
}

fmi_setup() {
    local from name
    fmi_is_complete "$FMI_FOLDER" && return 0
    from="$("$VENV/bin/python" -I -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/fmpy/c-code"
    mkdir -p "$FMI_FOLDER"
    while read -r _ name; do
        cp -- "$from/$name" "$FMI_FOLDER/$name" ||
            fail "the headers of FMI are not in $from; remove .venv and run again"
    done <<<"$FMI_SHA256"
    fmi_is_complete "$FMI_FOLDER" || fail "the headers of FMI in $from are not the expected ones"
}
