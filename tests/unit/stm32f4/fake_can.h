/// CAN1 on the fakes, as RM0090 describes the bxCAN: its initialisation, FIFO and mailboxes.
#ifndef FAKE_CAN_H
#define FAKE_CAN_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    bool is_deaf;     ///< it never enters its initialisation
    uint32_t waiting; ///< frames in the FIFO
    uint32_t sent;    ///< requests
    uint32_t aborted; ///< requests
} fake_can_t;

extern fake_can_t fake_can;

void fake_can_reset(void);

/// From a test's hook, for every read and write.
void fake_can_behave(uint32_t address, bool is_write, uint32_t value);

/// After a change of fake_can.waiting.
void fake_can_put_levels(void);

/// The bus carries the frame whose turn it is: with TXFP the oldest request, else the lowest
/// identifier, and of those the lowest mailbox. Returns its first data word, UINT32_MAX: there is
/// none.
uint32_t fake_can_carry(void);

#endif
