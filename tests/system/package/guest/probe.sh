#!/bin/sh
# Drives the service and tells the host what came of it, a line a fact, on the console. Steps follow
# events: systemctl returns when a job is done, and what takes longer is waited for.
exec >/dev/ttyAMA0 2>&1

tell() { echo "FACT $*"; }
property() { systemctl show quiesced --property "$1" --value; }
logged() { journalctl --unit quiesced --output cat --no-pager | grep -F -c "$1"; }
await() { # await WHAT COMMAND...: for a minute at most
    what="$1"
    shift
    tries=0
    until "$@"; do
        tries=$((tries + 1))
        [ "$tries" -lt 60 ] || { tell "$what" never; return; }
        sleep 1 # costs nothing: idle time is skipped
    done
    tell "$what" yes
}
other_process() { # asked at once: between two questions an old process can end, and 0 is no process
    now="$(systemctl show quiesced --property ActiveState --property MainPID | sort | tr '\n' ' ')"
    case "$now" in
    "ActiveState=active MainPID=0 " | "ActiveState=active MainPID=$pid ") false ;;
    "ActiveState=active "*) true ;;
    *) false ;;
    esac
}
is_active() { [ "$(property ActiveState)" = active ]; }
has_tried() { [ "$(property NRestarts)" -ge "$1" ]; }
has_logged() { [ "$(logged "$1")" -gt 0 ]; }

udevadm settle
for device in gpiochip0 watchdog watchdog0; do
    tell "$device" "$(stat -c '%G %a' "/dev/$device")"
done

systemctl start quiesced
tell start "$(property ActiveState)"
pid="$(property MainPID)"
tell user "$(stat -c %U "/proc/$pid")"
tell groups "$(ps_groups="$(sed -n 's/^Groups://p' "/proc/$pid/status")"; for id in $ps_groups; do getent group "$id" | cut -d: -f1; done | sort | tr '\n' ' ')"
tell capabilities "$(sed -n 's/^CapEff:[^0-9a-f]*//p' "/proc/$pid/status")"
tell seccomp "$(sed -n 's/^Seccomp:[^0-9]*//p' "/proc/$pid/status")"
tell priorities "$(cut -d ' ' -f 40 /proc/"$pid"/task/*/stat | sort -n | tr '\n' ' ')"
tell locked "$(sed -n 's/^VmLck:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$pid/status")"

systemctl reload quiesced
await reload has_logged "restarted with new parameters"
sed -i 's/^law = .*/law = "nonsense"/' /etc/quiesced/quiesced.toml
systemctl reload quiesced
await refusal has_logged "parameters and tables stay"
tell after_refusal "$(property ActiveState) $([ "$(property MainPID)" = "$pid" ] && echo same)"
sed -i 's/^law = .*/law = "phase"/' /etc/quiesced/quiesced.toml

kill -KILL "$pid"
await restart_after_kill other_process
pid="$(property MainPID)"
kill -STOP "$pid"
await hang_is_noticed has_logged "Watchdog timeout"
await restart_after_hang other_process
systemctl stop quiesced
tell stop "$(property ActiveState) $(property Result)"
tell farewell "$(has_logged "safe current, output off" && echo yes)"
tell failures_to_make_safe "$(logged "Control process exited")"

# A CAN interface that comes late.
ip link del vcan0
systemctl start quiesced
await tries has_tried 6
ip link add vcan0 type vcan
ip link set vcan0 up
await late_interface is_active
tell end
systemctl poweroff --force --force
