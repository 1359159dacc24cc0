# The guest's side of the bus test: slcan0 leads to the host. Each step begins when the host asks
# for it with a frame, or by itself when it says so on the console.
. /vm/lib.sh
ECHOES=10000

slcand -o -c -s6 /dev/hvc0 slcan0
await test -d /sys/class/net/slcan0
iproute2 link set slcan0 txqueuelen 1000 up

# link NAME: what `ip -s link` counts.
link() {
    echo "RESULT {\"name\": \"$1\", \"link\": $(iproute2 -s -j link show slcan0)}"
}

link before_echo
vm_echo slcan0 256 $ECHOES || exit 1
link after_echo
