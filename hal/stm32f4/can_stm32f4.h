/// CAN1, polled: every standard and extended frame is received, three frames at a time are on their
/// way out, in the order in which they were put. After bus-off it comes back by itself. Untested on
/// silicon; what to measure: docs/howto/stm32f4.md.
#ifndef CAN_STM32F4_H
#define CAN_STM32F4_H

#include "can_frame.h"
#include "pins.h"

/// bit_rate_Hz 0: there is none.
typedef struct {
    uint8_t rx, tx;
    uint32_t bit_rate_Hz;
} can_wiring_t;

typedef struct {
    bool is_open;
    bool is_bus_off;
    uint32_t bus_off_count; ///< times, wraps
    uint32_t rx_lost;       ///< times that frames were lost before they were read, wraps
} can_stm32f4_t;

/// bus_Hz: of the APB1, which must be a crystal's: the internal oscillator is too far off. Returns
/// false iff the bit rate cannot be made or the registers do not answer.
bool can_stm32f4_open(can_stm32f4_t *self, const can_wiring_t *wiring, uint32_t bus_Hz);

/// The oldest frame that has come; written only where the function returns true.
bool can_stm32f4_receive(can_stm32f4_t *self, can_frame_t *frame);

/// Returns false iff three frames are on their way, or it is not open; then nothing is sent.
bool can_stm32f4_send(can_stm32f4_t *self, const can_frame_t *frame);

/// Of the three frames on their way, a bit each; which bit is whose says nothing.
uint32_t can_stm32f4_waiting(const can_stm32f4_t *self);

/// Takes back those that are not on the bus this moment.
void can_stm32f4_abort(can_stm32f4_t *self);

/// Once a tick: counts what has happened to the bus.
void can_stm32f4_watch(can_stm32f4_t *self);

#endif
