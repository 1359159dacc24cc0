#include "can_stm32f4.h"

#include "reg.h"
#include "stm32f4_can.h"
#include "stm32f4_rcc.h"

#define CAN(r) (CAN1_BASE + (r))
#define CAN_FUNCTION 9u // alternate function of CAN1's pins
#define ENTER_POLLS 20000u
#define MAILBOXES 3u
#define EMPTY (CAN_TSR_TME0 | CAN_TSR_TME1 | CAN_TSR_TME2)
#define WORD_BYTES 4u

// A bit: one quantum of synchronisation, then both segments; the sample about seven eighths in.
#define QUANTA_LEAST 8u
#define QUANTA_MOST 18u
#define DIVIDER_MOST 1024u

static bool bit_timing(uint32_t bus_Hz, uint32_t bit_rate_Hz, uint32_t *word) {
    for (uint32_t quanta = QUANTA_MOST; bit_rate_Hz > 0u && quanta >= QUANTA_LEAST; quanta--) {
        const uint32_t divider = bus_Hz / (bit_rate_Hz * quanta);
        const uint32_t after = (quanta + 4u) / 8u; // the sample
        const uint32_t before = quanta - 1u - after;
        if (divider >= 1u && divider <= DIVIDER_MOST && divider * quanta * bit_rate_Hz == bus_Hz) {
            *word = (divider - 1u) << CAN_BTR_BRP_AT | (before - 1u) << CAN_BTR_TS1_AT |
                    (after - 1u) << CAN_BTR_TS2_AT;
            return true;
        }
    }
    return false;
}

// One filter that lets all through, into the first FIFO.
static void pass_all(void) {
    reg_set(CAN(CAN_FMR), CAN_FMR_FINIT);
    reg_clear(CAN(CAN_FA1R), 1u);
    reg_clear(CAN(CAN_FM1R), 1u); // a mask
    reg_set(CAN(CAN_FS1R), 1u);   // of 32 bits
    reg_write(CAN(CAN_FB_FR1(0u)), 0);
    reg_write(CAN(CAN_FB_FR2(0u)), 0);
    reg_clear(CAN(CAN_FFA1R), 1u);
    reg_set(CAN(CAN_FA1R), 1u);
    reg_clear(CAN(CAN_FMR), CAN_FMR_FINIT);
}

bool can_stm32f4_open(can_stm32f4_t *self, const can_wiring_t *wiring, uint32_t bus_Hz) {
    uint32_t timing;
    *self = (can_stm32f4_t){0};
    if (!bit_timing(bus_Hz, wiring->bit_rate_Hz, &timing)) {
        return false;
    }
    reg_set(RCC_BASE + RCC_APB1ENR, RCC_APB1ENR_CAN1EN);
    (void)reg_read(RCC_BASE + RCC_APB1ENR);
    reg_change(CAN(CAN_MCR), CAN_MCR_SLEEP, CAN_MCR_INRQ);
    if (!reg_wait(CAN(CAN_MSR), CAN_MSR_INAK | CAN_MSR_SLAK, CAN_MSR_INAK, ENTER_POLLS)) {
        return false;
    }
    reg_set(CAN(CAN_MCR), CAN_MCR_ABOM | CAN_MCR_TXFP); // in the order of the requests
    reg_write(CAN(CAN_BTR), timing);
    pass_all();
    pin_function(wiring->rx, CAN_FUNCTION, PIN_UP);
    pin_function(wiring->tx, CAN_FUNCTION, PIN_UP);
    reg_clear(CAN(CAN_MCR), CAN_MCR_INRQ); // it joins once the bus has been quiet for 11 bits
    self->is_open = true;
    return true;
}

static void take(can_frame_t *frame) {
    const uint32_t id = reg_read(CAN(CAN_RX_RIR(0u)));
    const uint32_t length = reg_read(CAN(CAN_RX_RDTR(0u))) & CAN_RX_RDTR_DLC;
    const uint32_t words[2] = {reg_read(CAN(CAN_RX_RDLR(0u))), reg_read(CAN(CAN_RX_RDHR(0u)))};
    *frame = (can_frame_t){
        .is_extended = (id & CAN_RX_RIR_IDE) != 0u,
        .is_remote = (id & CAN_RX_RIR_RTR) != 0u,
        .length = (uint8_t)(length < CAN_MAX_BYTES ? length : CAN_MAX_BYTES),
    };
    frame->id = frame->is_extended ? id >> CAN_RX_RIR_EXID_AT : id >> CAN_RX_RIR_STID_AT;
    const uint32_t bytes = frame->is_remote ? 0u : frame->length;
    for (uint32_t i = 0; i < CAN_MAX_BYTES; i++) {
        const uint32_t byte = words[i / WORD_BYTES] >> (8u * (i % WORD_BYTES));
        frame->data[i] = i < bytes ? (uint8_t)byte : 0u;
    }
}

bool can_stm32f4_receive(can_stm32f4_t *self, can_frame_t *frame) {
    if (!self->is_open || (reg_read(CAN(CAN_RF0R)) & CAN_RF0R_FMP) == 0u) {
        return false;
    }
    take(frame);
    reg_write(CAN(CAN_RF0R), CAN_RF0R_RFOM);
    return true;
}

static uint32_t word_of(const can_frame_t *frame, uint32_t first) {
    uint32_t word = 0;
    for (uint32_t i = 0; i < WORD_BYTES; i++) {
        word |= (uint32_t)frame->data[first + i] << (8u * i);
    }
    return word;
}

static void put(uint32_t mailbox, const can_frame_t *frame) {
    const uint32_t id = frame->is_extended ? frame->id << CAN_TX_TIR_EXID_AT | CAN_TX_TIR_IDE
                                           : frame->id << CAN_TX_TIR_STID_AT;
    reg_write(CAN(CAN_TX_TDTR(mailbox)), frame->length);
    reg_write(CAN(CAN_TX_TDLR(mailbox)), word_of(frame, 0));
    reg_write(CAN(CAN_TX_TDHR(mailbox)), word_of(frame, WORD_BYTES));
    reg_write(CAN(CAN_TX_TIR(mailbox)),
              id | (frame->is_remote ? CAN_TX_TIR_RTR : 0u) | CAN_TX_TIR_TXRQ);
}

bool can_stm32f4_send(can_stm32f4_t *self, const can_frame_t *frame) {
    const uint32_t free = reg_read(CAN(CAN_TSR));
    for (uint32_t mailbox = 0; self->is_open && mailbox < MAILBOXES; mailbox++) {
        if ((free & CAN_TSR_TME0 << mailbox) != 0u) {
            put(mailbox, frame);
            return true;
        }
    }
    return false;
}

uint32_t can_stm32f4_waiting(const can_stm32f4_t *self) {
    return self->is_open ? ~reg_read(CAN(CAN_TSR)) & EMPTY : 0u;
}

void can_stm32f4_abort(can_stm32f4_t *self) {
    if (self->is_open) {
        reg_write(CAN(CAN_TSR), CAN_TSR_ABRQ0 | CAN_TSR_ABRQ1 | CAN_TSR_ABRQ2);
    }
}

void can_stm32f4_watch(can_stm32f4_t *self) {
    if (!self->is_open) {
        return;
    }
    const bool is_bus_off = (reg_read(CAN(CAN_ESR)) & CAN_ESR_BOFF) != 0u;
    self->bus_off_count += is_bus_off && !self->is_bus_off ? 1u : 0u;
    self->is_bus_off = is_bus_off;
    if ((reg_read(CAN(CAN_RF0R)) & CAN_RF0R_FOVR) != 0u) {
        reg_write(CAN(CAN_RF0R), CAN_RF0R_FOVR);
        self->rx_lost++;
    }
}
