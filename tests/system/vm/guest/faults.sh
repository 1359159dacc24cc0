# Faults, one after the other. Each step waits for what the one before has caused.
# shellcheck source=tests/system/vm/guest/lib.sh
. /vm/lib.sh

# refused NAME FILE: the controller must not start.
refused() {
    start "$2"
    wait "$PID"
    report "$1" code=$? said="$(cat "$LOG")"
}

# end_record: the recorder stops at this frame and says what it has seen.
end_record() {
    cansend vcan0 7FF#
    wait "$RECORD"
}

record() {
    vm_record vcan0 "$1" &
    RECORD=$!
    await test -e "/run/$1.ready"
}

lines() {
    enable="$(cat "$SIM/sim_gpio1/value")"
    fault="$(cat "$SIM/sim_gpio2/value")"
}

# The backends' own tests, which elsewhere find no such kernel
for program in test_can_kernel test_gpio_lines_1 test_gpio_lines_2; do
    $program >/run/$program.log 2>&1
    report $program code=$? said="$(grep -e FAIL -e IGNORE -e Tests /run/$program.log)"
done

gpio_sim ESTOP ENABLE FAULT
vcan
vm_node vcan0 all &
NODE=$!
config /run/good.toml

# The operator acknowledges until the controller runs.
runs_again() {
    kill -USR1 "$NODE"
    is_in_state RUN
}

# What is not there
config /run/no_bus.toml 's/vcan0/nocan0/'
refused missing_interface /run/no_bus.toml
config /run/no_line.toml 's/ESTOP/NO_SUCH_LINE/'
refused missing_line /run/no_line.toml
config /run/no_device.toml 's/source = "can"/source = "iio"\ndevice = "no_such_device"/'
refused missing_device /run/no_device.toml
config /run/no_watchdog.toml '$a [watchdog]\ndevice = "/dev/no_such_watchdog"'
refused missing_watchdog /run/no_watchdog.toml

# What another process has
gpioset --mode=signal "$(basename "$SIM")" 0=0 &
HOLDER=$!
is_held() { gpioinfo | grep -q '"ESTOP".*used'; }
await is_held
refused taken_line /run/good.toml
kill "$HOLDER"
wait "$HOLDER"

# A second instance
running /run/good.toml
first="$PID"
log="$LOG"
LOG=/run/second.log
refused second_instance /run/good.toml
LOG=$log
PID=$first
lines
report first_instance state="$(field state)" enable="$enable" fault="$fault"

# The interface goes down and comes back
status
down="$(field down)"
iproute2 link set vcan0 down
await says 'interface is down'
ticks_down="$(field ticks)"
await says 'fault DRIVER_FAILED is kept'
status
report interface_down down=$(($(field down) - down)) \
    ticks_go_on=$(($(field ticks) > ticks_down)) said="$(grep 'CAN: interface is down' "$LOG")"
iproute2 link set vcan0 up
await says 'interface is up'
await runs_again
report interface_up state="$(field state)" said="$(grep 'CAN: interface is up' "$LOG")"

# Error frames, as a controller chip would report them: passive, bus-off, restarted
cansend vcan0 20000004#0010000000000000
await says 'CAN: error passive'
cansend vcan0 20000040#0000000000000000
await says 'CAN: bus-off'
await says 'CAN: bus-off: restart'
cansend vcan0 20000100#0000000000000000
await says 'CAN: error active'
await runs_again
report error_frames bus_off="$(field bus_off)" restarts="$(field restarts)" \
    error_frames="$(field error_frames)" state="$(field state)" said="$(grep 'CAN: ' "$LOG")"

# A flood of everything that is wrong
status
overruns="$(field overruns)"
crc="$(field rejected_crc)"
faults="$(grep -c 'fault [^N]' "$LOG")"
record flood
vm_flood vcan0 20000
end_record
status
report flooded state="$(field state)" rejected_crc=$(($(field rejected_crc) - crc)) \
    rejected_shape="$(field rejected_shape)" overruns=$(($(field overruns) - overruns)) \
    faults=$(($(grep -c 'fault [^N]' "$LOG") - faults))

# SIGTERM: the safe frame is the last
record sigterm
stop
end_record
lines
report terminated code="$CODE" enable="$enable" fault="$fault"

# kill -9, what systemd does then, and the next start
running /run/good.toml
record killed
kill -KILL "$PID"
wait "$PID"
await says 'its outputs are safe'
end_record
record make_safe
"$CONTROLLER" --make-safe --config /run/good.toml >/run/make_safe.log 2>&1
code=$?
end_record
lines
report made_safe code=$code enable="$enable" said="$(cat /run/make_safe.log)"
running /run/good.toml
report restarted state="$(field state)"
stop

# A full disk for log and state
mkdir /run/tiny
mount -t tmpfs -o size=96k tiny /run/tiny
mkdir /run/tiny/state
config /run/tiny.toml 's#/run/state#/run/tiny/state#' 's#to = "stderr"#to = "/run/tiny/log"#'
STATUS=/run/tiny/state/state.json
running /run/tiny.toml
dd if=/dev/zero of=/run/tiny/fill bs=512 2>/dev/null
refused_save="$(vm_request vcan0 5 0 0)"
log_is_full() {
    vm_request vcan0 5 0 0 >/dev/null
    says 'lines are dropped'
}
await log_is_full
record full_disk_control
vm_request vcan0 1 0 0 >/dev/null
end_record
rm /run/tiny/fill
await is_in_state RUN
saved="$(vm_request vcan0 5 0 0)"
await says 'takes lines again'
report full_disk refused="$refused_save" saved="$saved" state="$(field state)" said="$(cat "$LOG")"
stop
umount /run/tiny
STATUS=/run/state/state.json

# The last event: a controller that dies with the watchdog armed takes the machine with it.
insmod /lib/modules/softdog.ko
config /run/watchdog.toml '$a [watchdog]\ndevice = "/dev/watchdog"\ntimeout_s = 2'
running /run/watchdog.toml
report watchdog_armed state="$(field state)"
dmesg -n 5
echo "TEST-RC 0"
kill -KILL "$PID"
wait
