/// Freeze frame: what was when a fault was entered, in pages of FaultFreeze.
#ifndef CAN_FREEZE_H
#define CAN_FREEZE_H

#include "can_frame.h"
#include "quiesce.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CAN_FREEZE_PAGES 6u

/// The controller's inputs and outputs of a tick, as far as a freeze frame has them.
typedef struct {
    int32_t accel_counts;
    int32_t current_meas_mA;
    bool current_is_measured;
    const quiesce_out_t *out;
} can_freeze_tick_t;

/// Words of one freeze frame.
typedef struct {
    uint32_t tick;
    uint32_t fault;
    uint32_t state; ///< of the tick before, like the next two
    int32_t current_cmd_mA;
    int32_t current_law_mA;
    int32_t accel_counts;
    int32_t accel_um_s2;
    int32_t rms_um_s2;
    int32_t freq_uHz;
    int32_t current_meas_mA;
    int32_t displacement_amp_nm;
    bool freq_is_valid;
    bool current_is_measured;
} can_freeze_words_t;

typedef struct {
    can_freeze_words_t held;
    uint8_t number;     ///< of the one that is held, modulo 16; the first is 1
    uint8_t next_page;  ///< CAN_FREEZE_PAGES: all are sent
    bool is_held;       ///< there was a fault
    uint32_t repeat_ms; ///< since it was sent last
    // Of the tick before.
    uint32_t state;
    uint32_t fault;
    uint32_t fault_count;
    int32_t current_cmd_mA;
    int32_t current_law_mA;
} can_freeze_t;

/// Nothing held. safe_current_mA: what is commanded before the first tick.
void can_freeze_init(can_freeze_t *self, int32_t safe_current_mA);

/// The controller starts from rest; what is held stays.
void can_freeze_restart(can_freeze_t *self, int32_t safe_current_mA);

/// After each control step, passed_ms after the last one: captures where a fault was entered, and
/// begins to send again where a second has passed and a fault holds.
void can_freeze_watch(can_freeze_t *self, uint32_t passed_ms, const can_freeze_tick_t *tick);

/// Sends what is held once more, from its first page. Returns false iff there was no fault yet.
bool can_freeze_request(can_freeze_t *self);

/// The next page. Returns false iff there is none to send.
bool can_freeze_page(can_freeze_t *self, can_frame_t *frame);

#ifdef __cplusplus
}
#endif

#endif
