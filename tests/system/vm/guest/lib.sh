# What the guest's scripts share.
CONTROLLER=quiesced
LOG=/run/quiesced.log
STATUS=/run/state/state.json

# Results for the host: report NAME KEY=VALUE... prints one line; numbers stay numbers.
report() {
    line="{\"name\": \"$1\""
    shift
    for pair in "$@"; do
        value="${pair#*=}"
        case "$value" in
        '' | *[!0-9]*) value="\"$(printf '%s' "$value" | tr '\n' '|' | sed 's/["\\]/\\&/g')\"" ;;
        esac
        line="$line, \"${pair%%=*}\": $value"
    done
    echo "RESULT $line}"
}

# Waits until a command succeeds. What is waited for is an event; the time only ends a hung guest.
await() {
    tries=3000
    until "$@"; do
        tries=$((tries - 1))
        if [ "$tries" -eq 0 ]; then
            echo "waited in vain for: $*"
            tail -n 8 "$LOG"
            exit 1
        fi
        usleep 10000
    done
}

# gpio_sim LINE...: a simulated chip of 8 lines, those named from offset 0 on; SIM is its folder.
gpio_sim() {
    chip=/sys/kernel/config/gpio-sim/vm
    mkdir $chip $chip/bank0
    echo 8 >$chip/bank0/num_lines
    offset=0
    for name in "$@"; do
        mkdir "$chip/bank0/line$offset"
        echo "$name" >"$chip/bank0/line$offset/name"
        offset=$((offset + 1))
    done
    echo 1 >$chip/live
    SIM="/sys/devices/platform/$(cat $chip/dev_name)/$(cat $chip/bank0/chip_name)"
}

vcan() {
    iproute2 link add dev vcan0 type vcan
    iproute2 link set vcan0 txqueuelen 1000 up
}

# config FILE [SED EXPRESSION]...: a configuration of its own.
config() {
    file="$1"
    cp /vm/controller.toml "$file"
    shift
    for expression in "$@"; do
        sed -i "$expression" "$file"
    done
}

# start FILE: the controller; PID is its process, what it says goes to LOG.
start() {
    mkdir -p /run/state
    : >"$LOG" # what an earlier one said must not be taken for this one's
    "$CONTROLLER" --config "$1" >"$LOG" 2>&1 &
    PID=$!
}

# stop: SIGTERM; CODE is how it ended.
stop() {
    kill -TERM "$PID"
    wait "$PID"
    CODE=$?
}

# says TEXT: on stderr, or in a log file of its own.
says() {
    cat "$LOG" /run/tiny/log 2>/dev/null | grep -q -- "$1"
}

# status: the status file as it is now.
status() {
    rm -f "$STATUS"
    kill -USR1 "$PID"
    await test -s "$STATUS"
}

# field KEY: a number or word of the status file.
field() {
    sed -n "s/.*\"$1\": \"\{0,1\}\([^\",}]*\).*/\1/p" "$STATUS" | head -n 1
}

is_in_state() {
    status
    [ "$(field state)" = "$1" ]
}

# running FILE: starts it and waits until the law's current is on the bus.
running() {
    start "$1"
    await says 'parameter hash' # from here on it takes signals
    await is_in_state RUN
}
