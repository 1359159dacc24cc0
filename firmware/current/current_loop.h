/// Coil current by the duty of a PWM bridge: a proportional-integral loop for an interrupt of
/// CURRENT_LOOP_HZ, and what its voltage tells of the coil.
///
/// The voltage for the command by the coil's nominal resistance comes first (feed-forward), the
/// loop adds what is missing; the duty is that voltage over the supply that is measured, so that
/// neither a low supply nor a hot coil changes the gains. One set of them serves inductances of
/// 20 .. 200 mH: what limits the step of a large coil is the supply, not the loop.
///
/// Formats: currents mA, voltages mV, duty in units of 1 / CURRENT_LOOP_FULL of the supply.
/// Scaling: the error is limited to +-16383 mA, gains to Q8 and Q12 of at most 65535, so that each
/// product keeps within 2^30; the integral is mV in Q12, within +-integral_mV (at most 32767), so
/// that its sum keeps within 2^31; the voltage is limited to the supply, at most 60 V, before its
/// one division. Rounding: products and the integral floor, the duty towards zero. Saturation: the
/// voltage within least_duty .. CURRENT_LOOP_FULL of the supply; while it is, the integral takes
/// only what leads out of it (anti-windup).
#ifndef CURRENT_LOOP_H
#define CURRENT_LOOP_H

#include <stdbool.h>
#include <stdint.h>

#define CURRENT_LOOP_HZ 10000u
#define CURRENT_LOOP_FULL 32768
/// Of a window, whose ends have the same current to CURRENT_LOOP_SAME_mA: then it holds the same
/// flux, whatever the current did between, and mean voltage over mean current is the resistance.
#define CURRENT_LOOP_WINDOW 1024u
#define CURRENT_LOOP_WINDOW_MOST 4096u ///< then it is given up
#define CURRENT_LOOP_SAME_mA 16

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    int32_t resistance_mohm;  ///< of the coil when it is cold, 100 .. 100000
    int32_t gain_mV_a_mA_q8;  ///< 1 .. 65535: up to 256 V/A
    int32_t integral_time_us; ///< 1000 .. 1000000
    int32_t integral_mV;      ///< most that the integral adds, 0 .. 32767
    int32_t least_duty;       ///< 0: one switch and a freewheel; -CURRENT_LOOP_FULL: a full bridge
    int32_t full_scale_mA;    ///< 100 .. 16383; commands beyond it are limited
} current_loop_cfg_t;

typedef enum {
    CURRENT_LOOP_UNKNOWN = 0, ///< too little current, or no window has ended yet
    CURRENT_LOOP_FOLLOWS = 1,
    CURRENT_LOOP_OPEN = 2,  ///< a quarter of the supply and more, and next to no current
    CURRENT_LOOP_SHORT = 3, ///< less than a quarter of the nominal resistance
} current_loop_coil_t;

/// Sums over a window.
typedef struct {
    int32_t sum_mV;
    int32_t sum_mA;
    int32_t first_mA;
    uint32_t count;
} current_loop_window_t;

typedef struct {
    current_loop_cfg_t cfg;
    int32_t integral_gain_q12; ///< mV a mA and step
    int32_t command_mA;
    int32_t command_mV; ///< feed-forward
    int32_t integral_mV_q12;
    current_loop_window_t window; ///< under way
    current_loop_window_t last;   ///< ended; count 0: taken
} current_loop_t;

/// What the last window tells.
typedef struct {
    current_loop_coil_t coil;
    int32_t resistance_mohm; ///< 0 while not known
    int32_t rise_degC;       ///< of copper above the cold coil; 0 while not known
} current_loop_report_t;

/// Returns false, with *self idle, iff a value of cfg is out of its range.
bool current_loop_init(current_loop_t *self, const current_loop_cfg_t *cfg);

/// From the control tick. command_mA: limited to 0 .. full scale, with a full bridge to -full scale
/// too.
void current_loop_command(current_loop_t *self, int32_t command_mA);

/// The interrupt: duty from the measured current and supply (below 1 V counts as 1 V, above 60 V as
/// 60 V), least_duty .. CURRENT_LOOP_FULL. Some 80 instructions and one division.
int32_t current_loop_step(current_loop_t *self, int32_t current_mA, int32_t supply_mV);

/// The driver is off: the integral is forgotten, and the window under way.
void current_loop_rest(current_loop_t *self);

/// From the control tick, with the interrupt held off: what the window that has ended since the
/// last call tells. Returns false, and leaves *report alone, iff none has. supply_mV: measured.
bool current_loop_report(current_loop_t *self, int32_t supply_mV, current_loop_report_t *report);

#ifdef __cplusplus
}
#endif

#endif
