/// State of law phase; contents are private to it.
#ifndef PHASE_STATE_H
#define PHASE_STATE_H

#include "adapt.h"
#include "phase_table.h"

typedef struct {
    adapt_t adapt;
    uint32_t blend_step_q16; ///< a tick
    uint32_t blend_q16;      ///< 0: unlock current, 65536: pulses
    uint32_t freq_mHz;
    phase_place_t place;
    phase_pulse_t pulse;  ///< trimmed
    adapt_trim_t trim;    ///< in effect
    uint16_t first_point; ///< in the table: of the setting in use
    uint16_t point_count;
    bool is_stale; ///< place and pulse are to be found anew
} phase_t;

#endif
