#include "fake_can.h"

#include "fake_registers.h"
#include "stm32f4_can.h"

#define CAN(r) (CAN1_BASE + (r))
#define MAILBOXES 3u
#define ABORTS (CAN_TSR_ABRQ0 | CAN_TSR_ABRQ1 | CAN_TSR_ABRQ2)

fake_can_t fake_can;
static uint32_t asked[MAILBOXES]; ///< the number of the request

void fake_can_reset(void) {
    fake_can = (fake_can_t){0};
}

void fake_can_put_levels(void) {
    const uint32_t others = fake_get(CAN(CAN_RF0R)) & ~(CAN_RF0R_FMP | CAN_RF0R_RFOM);
    fake_set(CAN(CAN_RF0R), others | fake_can.waiting);
}

static bool is_empty(uint32_t mailbox) {
    return (fake_get(CAN(CAN_TSR)) & CAN_TSR_TME0 << mailbox) != 0u;
}

static void end(uint32_t mailbox) {
    fake_set(CAN(CAN_TSR), (fake_get(CAN(CAN_TSR)) & ~ABORTS) | CAN_TSR_TME0 << mailbox |
                               CAN_TSR_RQCP0 << (8u * mailbox));
    fake_set(CAN(CAN_TX_TIR(mailbox)), fake_get(CAN(CAN_TX_TIR(mailbox))) & ~CAN_TX_TIR_TXRQ);
}

static void ask(uint32_t mailbox) {
    fake_set(CAN(CAN_TSR), fake_get(CAN(CAN_TSR)) & ~(CAN_TSR_TME0 << mailbox));
    asked[mailbox] = ++fake_can.sent;
}

static bool is_before(uint32_t one, uint32_t other) {
    const uint32_t one_id = fake_get(CAN(CAN_TX_TIR(one)));
    const uint32_t other_id = fake_get(CAN(CAN_TX_TIR(other)));
    if ((fake_get(CAN(CAN_MCR)) & CAN_MCR_TXFP) != 0u) {
        return asked[one] < asked[other];
    }
    return one_id < other_id;
}

uint32_t fake_can_carry(void) {
    uint32_t next = MAILBOXES;
    for (uint32_t i = 0; i < MAILBOXES; i++) {
        if (!is_empty(i) && (next == MAILBOXES || is_before(i, next))) {
            next = i;
        }
    }
    if (next == MAILBOXES) {
        return UINT32_MAX;
    }
    const uint32_t word = fake_get(CAN(CAN_TX_TDLR(next)));
    end(next);
    return word;
}

// INAK follows INRQ; RFOM releases a frame; TXRQ fills a mailbox, ABRQ empties it.
void fake_can_behave(uint32_t address, bool is_write, uint32_t value) {
    if (address == CAN(CAN_MSR) && !is_write) {
        const uint32_t mcr = fake_get(CAN(CAN_MCR));
        const bool is_in = (mcr & CAN_MCR_INRQ) != 0u && !fake_can.is_deaf;
        fake_set(address,
                 (is_in ? CAN_MSR_INAK : 0u) | ((mcr & CAN_MCR_SLEEP) != 0u ? CAN_MSR_SLAK : 0u));
    } else if (address == CAN(CAN_RF0R) && is_write) {
        fake_can.waiting -= (value & CAN_RF0R_RFOM) != 0u ? 1u : 0u;
        fake_can_put_levels();
    }
    for (uint32_t i = 0; i < MAILBOXES; i++) {
        if (address == CAN(CAN_TX_TIR(i)) && is_write && (value & CAN_TX_TIR_TXRQ) != 0u) {
            ask(i);
        } else if (address == CAN(CAN_TSR) && is_write &&
                   (value & CAN_TSR_ABRQ0 << (8u * i)) != 0u && !is_empty(i)) {
            fake_can.aborted++;
            end(i);
        }
    }
    if (address == CAN(CAN_TSR) && is_write) {
        fake_set(address, fake_get(address) & ~ABORTS);
    }
}
