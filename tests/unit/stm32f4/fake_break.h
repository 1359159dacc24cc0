/// TIM1's break input on the fakes, as RM0090 describes it (TIM1 and TIM8, "Using the break
/// function"): while the input is active MOE is cleared and cannot be set, and BIF is set and
/// cannot be cleared. PB12 is the input; where it is not the timer's it reads low.
#ifndef FAKE_BREAK_H
#define FAKE_BREAK_H

#include <stdbool.h>
#include <stdint.h>

/// High.
void fake_break_reset(void);

void fake_break_line(bool is_low);

/// From a test's hook, for every read and write.
void fake_break_behave(void);

#endif
