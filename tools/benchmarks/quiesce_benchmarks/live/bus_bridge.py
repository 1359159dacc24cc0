"""A program of its own: carries frames between a controller's SLCAN line and UDP multicast.

    bus_bridge.py LINE GROUP PORT

Says `ready` once both are open. Ends with its line, or by a signal.
"""

import sys
import threading

from quiesce.can.slcan import SlcanBus

from can.interfaces.udp_multicast import UdpMulticastBus  # isort: skip  (after quiesce's python-can)


def carry(source, target) -> None:
    while True:
        message = source.recv(None)
        if message is not None:
            target.send(message)


def main(line: str, group: str, port: str) -> None:
    with SlcanBus(line) as wire, UdpMulticastBus(group, port=int(port), fd=False) as network:
        print("ready", flush=True)
        threading.Thread(target=carry, args=(network, wire), daemon=True).start()
        carry(wire, network)


if __name__ == "__main__":
    main(*sys.argv[1:])
