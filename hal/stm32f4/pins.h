/// Pins: a byte each, port and number. Untested on silicon; what to measure: docs/howto/stm32f4.md.
#ifndef PINS_H
#define PINS_H

#include <stdbool.h>
#include <stdint.h>

#define PIN_A(n) ((uint8_t)(n))
#define PIN_B(n) ((uint8_t)(0x10u + (n)))
#define PIN_C(n) ((uint8_t)(0x20u + (n)))
#define PIN_NONE ((uint8_t)0xFFu) ///< not wired: reads low, takes every call

typedef enum { PIN_FLOATS = 0, PIN_UP = 1, PIN_DOWN = 2 } pin_pull_t;

void pin_input(uint8_t pin, pin_pull_t pull);

/// The level is there before the pin drives it.
void pin_output(uint8_t pin, bool is_high);

/// function: 0 .. 15, of the data sheet's table of alternate functions.
void pin_function(uint8_t pin, uint32_t function, pin_pull_t pull);

void pin_analog(uint8_t pin);

bool pin_read(uint8_t pin);
void pin_write(uint8_t pin, bool is_high);

#endif
