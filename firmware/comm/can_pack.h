/// The controller's words of a tick as the data of its messages: pure, saturating, not protected
/// yet. Each writes the 8 data bytes of *frame.
#ifndef CAN_PACK_H
#define CAN_PACK_H

#include "can_frame.h"
#include "can_receive.h"
#include "quiesce.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Frames that never left since the start, by class; wrapping.
typedef struct {
    uint32_t demands;   ///< demands and Status, for newer ones
    uint32_t answers;   ///< service replies, frames of transfers, pages of the freeze frame
    uint32_t telemetry; ///< all others
} can_unsent_t;

/// Counts a frame of this id.
void can_unsent_count(can_unsent_t *unsent, uint32_t id);

/// Of the processor's cycle counter; all 0 where the target has none.
typedef struct {
    uint32_t work;      ///< of the last tick
    uint32_t interrupt; ///< the longest since the tick before
    uint32_t core_kHz;  ///< clock of the core
} can_cycles_t;

/// What the target tells the bus beyond the controller's output.
typedef struct {
    bool enable;          ///< in force in this tick, from wherever it came
    bool estop;           ///< likewise
    int32_t accel_counts; ///< the sample that the controller was given, or the last one
    bool accel_is_fresh;
    int32_t current_meas_mA;
    bool current_is_measured;
    uint32_t overruns;    ///< ticks lost since the start
    uint32_t lateness_us; ///< of this tick's start; 0 where the target cannot tell
    uint32_t work_us;     ///< of the last tick
    can_cycles_t cycles;
    can_unsent_t unsent;
    uint32_t bus_off_count;
    uint32_t rx_lost; ///< times that a line or an interface lost what had come, since the start
    uint32_t ticks;   ///< since the last one; 1, more where ticks were lost
    bool fault_reset; ///< in force in this tick
} can_node_tick_t;

void can_pack_demand(uint32_t state, int32_t current_mA, bool is_enabled, can_frame_t *frame);
void can_pack_status(const can_node_tick_t *tick, const quiesce_telemetry_t *t, bool is_streaming,
                     can_frame_t *frame);
void can_pack_motion(const quiesce_telemetry_t *t, can_frame_t *frame);
/// peak: 0 .. QUIESCE_PEAKS - 1; their messages have one layout.
void can_pack_peak(const quiesce_telemetry_t *t, uint32_t peak, can_frame_t *frame);
/// report_number: 0 .. QUIESCE_REPORT_WORDS - 1, whose word is report_word.
void can_pack_law(int32_t law, const quiesce_telemetry_t *t, uint32_t report_number,
                  int32_t report_word, can_frame_t *frame);
void can_pack_timing(uint32_t overruns, uint32_t lateness_max_us, uint32_t work_max_us,
                     can_frame_t *frame);
/// most: of each the largest.
void can_pack_cycles(const can_cycles_t *most, can_frame_t *frame);
void can_pack_health(const can_node_counters_t *counters, const can_node_tick_t *tick,
                     can_frame_t *frame);
void can_pack_shed(const can_unsent_t *unsent, can_frame_t *frame);
void can_pack_identification(uint32_t param_hash, can_frame_t *frame);
void can_pack_raw(const can_node_tick_t *tick, uint32_t number, can_frame_t *frame);

#ifdef __cplusplus
}
#endif

#endif
