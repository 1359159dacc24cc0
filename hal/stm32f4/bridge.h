/// A coil's bridge: PWM of 20 kHz on TIM1's first channel, current and supply measured by the ADC
/// at the begin of every second period, which calls the board's interrupt at 10 kHz. A break input
/// of the timer (low) cuts the bridge off without a program, and so does a crystal that stops.
/// Untested on silicon; what to measure: docs/howto/stm32f4.md.
#ifndef BRIDGE_H
#define BRIDGE_H

#include "pins.h"

#define BRIDGE_PWM_HZ 20000u
#define BRIDGE_FULL 32768 ///< of a duty

/// Scales: what a count of the ADC, 0 .. 4095, is.
typedef struct {
    uint8_t pwm;     ///< PA8: TIM1_CH1
    uint8_t cut_off; ///< PB12: TIM1_BKIN, pulled up: the driver's fault output, open drain
    uint8_t current; ///< analogue pins, and the ADC's channels behind them
    uint8_t supply;
    uint8_t current_channel;
    uint8_t supply_channel;
    int32_t current_zero_counts; ///< at no current
    int32_t current_uA_a_count;  ///< 1 .. 16000
    int32_t supply_uV_a_count;   ///< 1 .. 16000
} bridge_wiring_t;

typedef struct {
    int32_t current_mA;
    int32_t supply_mV;
} bridge_measured_t;

typedef struct {
    bridge_wiring_t wiring;
    uint32_t period_counts;
    bool is_wanted; ///< on
} bridge_t;

/// Everything is set up, the bridge off, the ADC measuring. timer_Hz: of TIM1, at least 2 MHz.
void bridge_open(bridge_t *self, const bridge_wiring_t *wiring, uint32_t timer_Hz);

/// In the interrupt, first of all: what has been measured, in the order of the pins.
bridge_measured_t bridge_take(const bridge_t *self);

/// duty: 0 .. BRIDGE_FULL, limited; takes effect with the next period.
void bridge_duty(const bridge_t *self, int32_t duty);

/// On: from duty 0. Off: the output is low at once. After a cut-off it comes on again only where it
/// has been switched off first, and the break input is high.
void bridge_enable(bridge_t *self, bool is_on);

/// Whether the output is on: not where the break input has cut it off.
bool bridge_is_on(void);

/// Whether it is switched on and something has cut it off. The break has no interrupt: its flag
/// cannot be cleared while the input is low, so that it would never end.
bool bridge_is_cut(const bridge_t *self);

/// Off, whatever else is the matter: for a fault of the processor. Takes no state.
void bridge_cut(void);

#endif
