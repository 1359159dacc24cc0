# shellcheck shell=bash
# Python peers of the benchmarks, in a virtual environment of their own. Sourced by tools/benchmarks/fetch_peers.

PEERS_VENV="$ROOT/build/deps/peers"
PEERS_REQUIREMENTS="$ROOT/tools/benchmarks/requirements-peers.txt"

# What a complete environment was made from. Environments do not survive a move of the folder.
peers_stamp() {
    sha256sum <"$PEERS_REQUIREMENTS"
    printf '%s\n' "$ROOT"
    "$PEERS_VENV/bin/python" -V
}

peers_is_complete() {
    [ -x "$PEERS_VENV/bin/python" ] && [ -f "$PEERS_VENV/.complete" ] &&
        [ "$(cat "$PEERS_VENV/.complete")" = "$(peers_stamp)" ]
}

peers_setup() {
    peers_is_complete && return 0
    say "set-up: peers of the benchmarks in build/deps/peers: tools/benchmarks/requirements-peers.txt"
    rm -rf "$PEERS_VENV"
    mkdir -p "$ROOT/build/deps"
    run_logged setup-peers-venv "$VENV/bin/python" -I -m venv "$PEERS_VENV" ||
        fail "'python -m venv build/deps/peers' failed (log: build/logs/setup-peers-venv.log)"
    retry setup-peers "$PEERS_VENV/bin/python" -I -m pip --disable-pip-version-check --no-input \
        install --require-hashes -r "$PEERS_REQUIREMENTS" ||
        fail "could not install the peers' Python packages: $(pip_reason setup-peers). Check the network and pip's settings, then run again (log: build/logs/setup-peers.log)"
    # Last, and in one step: an interrupted set-up has no such file and starts again.
    peers_stamp >"$PEERS_VENV/.complete.new"
    mv "$PEERS_VENV/.complete.new" "$PEERS_VENV/.complete"
}
