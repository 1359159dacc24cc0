/// Record of a fault: the second before it and what followed, eight signals with their least and
/// greatest value in bins of 20 ms, and what ran then. Integers only, no clock.
///
/// It records all the time into a ring. A fault that is entered ends that AFTER bins later: the
/// record is held, and the other ring goes on. It stays, as the first of its kind, until an
/// operator's acknowledgement or a request releases it; faults meanwhile are counted. One that was
/// acknowledged can be read until the next one takes its place.
///
/// A latched fault takes the place of one that heals by itself: a lost tick must not hide it.
///
/// A record is FAULT_RECORD_WORDS words, on the wire and on a disk little-endian:
///
/// | word | what |
/// |---|---|
/// | 0 | FAULT_RECORD_MAGIC: kind and version |
/// | 1 | fault, state of the tick before and 128 for a latched fault, bin of the fault, bins: a
/// byte | | 2 | number of the tick of the fault | | 3 | ticks a bin; ticks a second from bit 16 on
/// | | 4 | hash of the parameters, as Identification has it | | 5 | hash of the table in use
/// (quiesce_table_hash) | | 6 | version of the firmware, major, minor, patch, and of the CAN
/// interface: a byte each | | 7 | faults entered since the start | | 8 | last raw sample, counts |
/// | 9 | ticks lost since the start |
/// | 10 | samples refused since the start |
/// | 11 | number of the record; law and damper from bits 16 and 24 on |
/// | 12 .. | bins, the oldest first: a word a signal, minimum in the low half, maximum in the high
/// | | last | CRC-32 of all words before it |
///
/// A half is the signal in its unit, rounded to the nearest and saturated at -32768 and 32767. A
/// bin without a value has minimum 32767 and maximum -32768.
#ifndef FAULT_RECORD_H
#define FAULT_RECORD_H

#include "can_pack.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FAULT_RECORD_MAGIC 0x31524651u ///< "QFR1"
#define FAULT_RECORD_BINS_HZ 50u
#define FAULT_RECORD_SIGNALS 8u
#define FAULT_RECORD_BEFORE 50u ///< bins before the one of the fault
#define FAULT_RECORD_AFTER 7u
#define FAULT_RECORD_BINS (FAULT_RECORD_BEFORE + 1u + FAULT_RECORD_AFTER)
#define FAULT_RECORD_HEAD 12u
#define FAULT_RECORD_WORDS (FAULT_RECORD_HEAD + FAULT_RECORD_BINS * FAULT_RECORD_SIGNALS + 1u)
#define FAULT_RECORD_PAGE_HALVES 3u ///< of a frame of FaultRecord
#define FAULT_RECORD_PAGES (2u * FAULT_RECORD_WORDS / FAULT_RECORD_PAGE_HALVES)

/// Signals in their order; damper 0's, the board's tracked sensor.
typedef enum {
    FAULT_RECORD_ACCEL = 0,        ///< conditioned acceleration, 2 mm/s2
    FAULT_RECORD_DISPLACEMENT = 1, ///< 10 um
    FAULT_RECORD_RMS = 2,          ///< of the acceleration, 1 mm/s2
    FAULT_RECORD_FREQ = 3,         ///< dominant, while it is valid, 10 mHz
    FAULT_RECORD_COMMAND = 4,      ///< 1 mA
    FAULT_RECORD_REQUEST = 5,      ///< of the law, 1 mA
    FAULT_RECORD_MEASURED = 6,     ///< while it is measured, 1 mA
    FAULT_RECORD_STATE = 7,        ///< supervisor state, plus 16 while the driver is on
} fault_record_signal_t;

/// What runs, beyond what a tick says.
typedef struct {
    uint32_t tick_rate_Hz;
    uint32_t param_hash;
    uint32_t table_hash;
    uint32_t law;
} fault_record_about_t;

/// Contents are private but generation.
typedef struct {
    uint32_t head[FAULT_RECORD_HEAD];
    uint32_t bins[FAULT_RECORD_BINS][FAULT_RECORD_SIGNALS]; ///< a ring
    uint32_t next;                                          ///< bin of the ring to be closed next
    uint32_t filled;
    uint32_t crc;
} fault_record_ring_t;

typedef struct {
    fault_record_ring_t ring[2];
    uint32_t live;       ///< the ring that records; the other one is held
    uint32_t generation; ///< one more with every change of what is to be kept over a restart
    uint32_t number;     ///< of the record that was begun last
    uint32_t later;      ///< faults that are not recorded, since the one that is
    uint32_t left_bins;  ///< until the fault's record is complete, 0: none is being taken
    uint32_t summed;     ///< words that crc covers so far
    bool is_held;
    bool is_latched;      ///< the fault of the record that was begun last
    bool is_acknowledged; ///< the next fault takes its place
    // The bin that is being filled, in the firmware's units.
    int32_t low[FAULT_RECORD_SIGNALS];
    int32_t high[FAULT_RECORD_SIGNALS];
    uint32_t owed_ticks; ///< that have passed and are in no bin yet
    uint32_t bin_ticks;
    // Of the tick before.
    uint32_t fault;
    uint32_t fault_count;
    uint32_t state;
    bool was_reset;
    bool is_reset_seen; ///< pressed since the last fault was entered
    // Pages under way.
    uint32_t next_page;
    uint32_t end_page;
} fault_record_t;

void fault_record_init(fault_record_t *self, uint32_t tick_rate_Hz);

/// The controller starts from rest: what is held stays, a record that is being taken ends here.
void fault_record_restart(fault_record_t *self, uint32_t tick_rate_Hz);

/// After each control step. Where a fault is entered, and only then, asks for what runs.
void fault_record_watch(fault_record_t *self, const can_node_tick_t *tick,
                        const quiesce_out_t *out);

/// Whether the tick that was watched last began a record: then say at once what runs.
static inline bool fault_record_wants_about(const fault_record_t *self) {
    return self->left_bins > 0u && self->ring[self->live].head[0] == 0u;
}
void fault_record_about(fault_record_t *self, const fault_record_about_t *about);

/// A record is being taken, or its CRC computed: ask again.
bool fault_record_is_busy(const fault_record_t *self);

/// Sends count pages from first on, 0: all. Returns false iff there is no record, or no such page.
bool fault_record_request(fault_record_t *self, uint32_t first, uint32_t count);

/// Forgets what is held. Returns false iff nothing is.
bool fault_record_clear(fault_record_t *self);

/// The next page, of FaultRecord. Returns false iff there is none to send.
bool fault_record_page(fault_record_t *self, can_frame_t *frame);

/// The controller leaves: ends what is being taken, at once. Some 30,000 instructions.
void fault_record_finish(fault_record_t *self);

/* To keep it over a restart: copy what is held whenever generation has changed, put it back before
   the first tick. */

/// Returns false iff nothing is held, or it is not complete yet.
bool fault_record_copy(const fault_record_t *self, uint32_t words[FAULT_RECORD_WORDS]);

/// Returns false, and changes nothing, iff it is no whole record of this version.
bool fault_record_load(fault_record_t *self, const uint32_t words[FAULT_RECORD_WORDS],
                       bool is_acknowledged);

#ifdef __cplusplus
}
#endif

#endif
