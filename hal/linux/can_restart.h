/// Restart of a CAN controller after a bus-off, as `ip link set can0 type can restart` asks for it:
/// a request to the kernel's routing socket (RTM_NEWLINK with IFLA_CAN_RESTART). Needs
/// CAP_NET_ADMIN.
#ifndef CAN_RESTART_H
#define CAN_RESTART_H

#include <stddef.h>
#include <stdint.h>

#define CAN_RESTART_BYTES 64u

/// The routing socket, which does not block; -1 and errno where there is none.
int can_restart_open(void);

/// Writes the request for the interface. Returns its length in bytes.
size_t can_restart_request(uint8_t out[CAN_RESTART_BYTES], int interface_index, uint32_t sequence);

/// The kernel's answer to a request: 0 done, else an errno; -1: these bytes are no answer to it.
int can_restart_answer(const uint8_t *bytes, size_t length, uint32_t sequence);

/// Asks for the restart. Returns 0, or why not:
/// EPERM no right, EBUSY the controller is not bus-off, EINVAL it restarts by itself (restart-ms),
/// EOPNOTSUPP or ENODEV the interface is no CAN controller.
int can_restart(int socket_fd, int interface_index, uint32_t sequence);

#endif
