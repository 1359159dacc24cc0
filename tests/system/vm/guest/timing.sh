# How late the controller's ticks begin, what they cost, and how long an emergency stop takes, in
# the virtual time of the instructions. cyclictest is the ruler: same priority, interval and load.
# shellcheck source=tests/system/vm/guest/lib.sh
. /vm/lib.sh
PRESSES=16
CONTROLLER=quiesced-gpiod2

gpio_sim ESTOP ENABLE FAULT
vcan
config /run/timing.toml

# The load: one process that never waits, one that calls the kernel all the time, and one that reads
# every frame of the bus.
while :; do :; done &
dd if=/dev/zero of=/dev/null bs=4096 2>/dev/null &
candump vcan0 >/dev/null &

vm_node vcan0 sensor &
start /run/timing.toml
vm_estop vcan0 "$SIM/sim_gpio0/pull" "$PRESSES" || exit 1
stop
report timing code="$CODE" said="$(grep 'parameter hash' "$LOG")"
echo "RESULT {\"name\": \"status\", \"status\": $(tr -d '\n' <"$STATUS")}"
grep 'emergency stop' "$LOG" | sed 's/^/LOG /'
ticks="$(field ticks)"
report cyclictest summary="$(cyclictest -q -m -p 80 -t 1 -i 1000 -l "$ticks" | tail -n 1)"
