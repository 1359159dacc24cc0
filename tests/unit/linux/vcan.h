/// Virtual CAN interfaces of the kernel (vcan), where there are such and the right to make them.
#ifndef VCAN_H
#define VCAN_H

#include <stdbool.h>

/// Makes an interface, which is down. Returns false where this machine cannot.
bool vcan_make(const char *name);
void vcan_remove(const char *name);
void vcan_set_up(const char *name, bool is_up);
/// 16: classic, 72: CAN FD; while it is down.
void vcan_set_mtu(const char *name, int mtu);

/// A raw socket on it for the other side, with CAN FD frames; reads do not wait.
int vcan_peer(const char *name);

#endif
