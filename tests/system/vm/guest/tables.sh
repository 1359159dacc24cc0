# The guest's side of the test of tables: slcan0 leads to the host, whose `quiesce can` loads one. A
# frame with id 0x7F0 from the host ends a step.
# shellcheck source=tests/system/vm/guest/lib.sh
. /vm/lib.sh

slcand -o -c -s6 /dev/ttyAMA0 slcan0
await test -d /sys/class/net/slcan0
iproute2 link set slcan0 txqueuelen 1000 up
config /run/tables.toml 's/vcan0/slcan0/' '/_output = {/d' '/_input = {/d' \
    's/law = "constant"/law = "phase"/' '/constant_current_mA/d' '$a tick_rate_Hz = 500'

# serve NAME: a controller that the host works with until it says so.
serve() {
    start /run/tables.toml
    await says 'parameter hash'
    candump -n 1 slcan0,7F0:7FF >/dev/null &
    ASKED=$!
    echo "READY $1"
    wait "$ASKED"
}

told() {
    report "$1" code="$CODE" said="$(grep -e table -e saved "$LOG")"
}

# Killed once it has said that it is saved: no orderly end is needed.
serve loaded
await says "saved: the law's table"
kill -KILL "$PID"
wait "$PID"
CODE=$?
await says 'its outputs are safe'
told loaded

serve restarted
stop
told restarted

# A record that is damaged
printf '\252' | dd of=/run/state/law_table.bin bs=1 seek=200 conv=notrunc 2>/dev/null
serve damaged
stop
told damaged
