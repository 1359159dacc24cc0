# The guest's side of the bus test: slcan0 leads to the host, which plays bench, sensor node and
# operator. A frame with id 0x7F0 from the host ends a step.
# shellcheck source=tests/system/vm/guest/lib.sh
. /vm/lib.sh
ECHOES=10000

# link NAME: what `ip -s link` counts.
link() {
    echo "RESULT {\"name\": \"$1\", \"link\": $(iproute2 -s -j link show slcan0)}"
}

until_host_says() {
    candump -n 1 slcan0,7F0:7FF >/dev/null
}

slcand -o -c -s6 /dev/ttyAMA0 slcan0
await test -d /sys/class/net/slcan0
iproute2 link set slcan0 txqueuelen 1000 up
config /run/bus.toml 's/vcan0/slcan0/' 's/"ENABLE"/"gpiochip0:1"/' 's/"FAULT"/"gpiochip0:2"/' \
    's/"ESTOP"/"gpiochip0:5"/' 's/recover_ticks = 20/recover_ticks = 1/' \
    '$a tick_rate_Hz = 500\nsensor_max_age_ticks = 1000'

# The host's bench drives the lock-step server.
"$CONTROLLER" --lockstep --config /run/bus.toml >"$LOG" 2>&1 &
PID=$!
until_host_says &
ASKED=$!
echo LOCKSTEP-READY
wait "$ASKED"
stop
report lockstep code="$CODE" said="$(cat "$LOG")"

# Frames there and back
link before_echo
vm_echo slcan0 256 "$ECHOES" || exit 1
link after_echo

# The controller at work, at half its default rate.
start /run/bus.toml
until_host_says
stop
report bus code="$CODE" said="$(cat "$LOG")"
link after_control
