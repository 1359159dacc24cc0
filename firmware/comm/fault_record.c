#include "fault_record.h"

#include "crc32.h"
#include "quiesce_can.h"
#include "quiesce_version.h"

#define SUMMED_WORDS (FAULT_RECORD_WORDS - 1u) ///< all but the CRC
#define DRIVER_IS_ON 16
#define IS_LATCHED 0x8000u ///< in word 1
#define EMPTY 0x80007FFFu  ///< minimum 32767, maximum -32768

_Static_assert(4u * FAULT_RECORD_WORDS <= 2048u, "a record has 2 kB at most");
_Static_assert(2u * FAULT_RECORD_WORDS % FAULT_RECORD_PAGE_HALVES == 0u, "pages are full");

/// Of the firmware's unit in the record's.
static const int32_t unit[FAULT_RECORD_SIGNALS] = {
    [FAULT_RECORD_ACCEL] = 2000, [FAULT_RECORD_DISPLACEMENT] = 10000,
    [FAULT_RECORD_RMS] = 1000,   [FAULT_RECORD_FREQ] = 10000,
    [FAULT_RECORD_COMMAND] = 1,  [FAULT_RECORD_REQUEST] = 1,
    [FAULT_RECORD_MEASURED] = 1, [FAULT_RECORD_STATE] = 1,
};

static fault_record_ring_t *live(fault_record_t *self) {
    return &self->ring[self->live];
}

static const fault_record_ring_t *held(const fault_record_t *self) {
    return &self->ring[1u - self->live];
}

static void empty_bin(fault_record_t *self) {
    for (uint32_t i = 0; i < FAULT_RECORD_SIGNALS; i++) {
        self->low[i] = INT32_MAX;
        self->high[i] = INT32_MIN;
    }
}

static void start_ring(fault_record_t *self) {
    fault_record_ring_t *const ring = live(self);
    ring->head[0] = 0;
    ring->next = 0;
    ring->filled = 0;
    self->owed_ticks = 0;
    empty_bin(self);
}

static void use_rate(fault_record_t *self, uint32_t tick_rate_Hz) {
    self->bin_ticks = tick_rate_Hz / FAULT_RECORD_BINS_HZ;
    self->fault = QUIESCE_FAULT_NONE;
    self->fault_count = 0;
    self->state = QUIESCE_STATE_INIT;
    start_ring(self);
}

void fault_record_init(fault_record_t *self, uint32_t tick_rate_Hz) {
    *self = (fault_record_t){.was_reset = true, .summed = SUMMED_WORDS};
    use_rate(self, tick_rate_Hz);
}

// Rounded to the nearest, halves away from 0; saturated to 16 bits.
static uint32_t scaled(int32_t value, int32_t divisor) {
    int32_t rounded = value;
    if (divisor > 1) {
        const int32_t rest = value % divisor;
        rounded = value / divisor + (rest >= divisor / 2 ? 1 : 0) - (rest <= -divisor / 2 ? 1 : 0);
    }
    const int32_t limited = rounded > INT16_MAX ? INT16_MAX : rounded;
    return (uint32_t)(limited < INT16_MIN ? INT16_MIN : limited) & UINT16_MAX;
}

static void close_bin(fault_record_t *self) {
    fault_record_ring_t *const ring = live(self);
    uint32_t *const bin = ring->bins[ring->next];
    for (uint32_t i = 0; i < FAULT_RECORD_SIGNALS; i++) {
        bin[i] = self->low[i] > self->high[i]
                     ? EMPTY
                     : scaled(self->low[i], unit[i]) | scaled(self->high[i], unit[i]) << 16;
    }
    ring->next = ring->next + 1u < FAULT_RECORD_BINS ? ring->next + 1u : 0u;
    ring->filled += ring->filled < FAULT_RECORD_BINS ? 1u : 0u;
    empty_bin(self);
}

/// The record is complete but for its CRC; the other ring goes on.
static void hold(fault_record_t *self) {
    live(self)->crc = 0;
    self->live = 1u - self->live;
    self->left_bins = 0;
    self->summed = 0;
    self->is_held = true;
    self->is_acknowledged = false;
    self->next_page = self->end_page;
    start_ring(self);
}

/// A word of a record but its CRC. Bins that there was no time for are empty.
static uint32_t word_of(const fault_record_ring_t *ring, uint32_t index) {
    if (index < FAULT_RECORD_HEAD) {
        return ring->head[index];
    }
    const uint32_t bin = (index - FAULT_RECORD_HEAD) / FAULT_RECORD_SIGNALS;
    if (bin < FAULT_RECORD_BINS - ring->filled) {
        return EMPTY;
    }
    const uint32_t at = ring->next + bin; // the oldest is closed next
    return ring->bins[at < FAULT_RECORD_BINS ? at : at - FAULT_RECORD_BINS]
                     [(index - FAULT_RECORD_HEAD) % FAULT_RECORD_SIGNALS];
}

static void sum_word(fault_record_t *self) {
    fault_record_ring_t *const ring = &self->ring[1u - self->live];
    const uint32_t word = word_of(ring, self->summed);
    ring->crc = crc32_continue(ring->crc, &word, 1);
    self->summed++;
    if (self->summed == SUMMED_WORDS) {
        self->generation++;
    }
}

// Where it ends early, the fault's bin is nearer to the end.
static void end_taking(fault_record_t *self) {
    fault_record_ring_t *const ring = live(self);
    close_bin(self);
    self->left_bins--;
    ring->head[1] |= (FAULT_RECORD_BEFORE + self->left_bins) << 16;
    hold(self);
}

void fault_record_restart(fault_record_t *self, uint32_t tick_rate_Hz) {
    if (self->left_bins > 0u) {
        end_taking(self);
    }
    use_rate(self, tick_rate_Hz);
}

void fault_record_finish(fault_record_t *self) {
    if (self->left_bins > 0u) {
        end_taking(self);
    }
    while (self->summed < SUMMED_WORDS) {
        sum_word(self);
    }
}

static void add(fault_record_t *self, fault_record_signal_t signal, int32_t value) {
    if (value < self->low[signal]) {
        self->low[signal] = value;
    }
    if (value > self->high[signal]) {
        self->high[signal] = value;
    }
}

static void add_tick(fault_record_t *self, const can_node_tick_t *tick, const quiesce_out_t *out) {
    const quiesce_telemetry_t *const t = &out->telemetry;
    add(self, FAULT_RECORD_ACCEL, t->accel_um_s2);
    add(self, FAULT_RECORD_DISPLACEMENT, t->displacement_nm);
    add(self, FAULT_RECORD_RMS, t->rms_um_s2);
    if (t->freq_is_valid != 0u) {
        add(self, FAULT_RECORD_FREQ, t->freq_uHz);
    }
    add(self, FAULT_RECORD_COMMAND, out->damper[0].current_cmd_mA);
    add(self, FAULT_RECORD_REQUEST, t->current_law_mA);
    if (tick->current_is_measured) {
        add(self, FAULT_RECORD_MEASURED, tick->current_meas_mA);
    }
    add(self, FAULT_RECORD_STATE,
        (int32_t)(t->state & 15u) + (out->damper[0].driver_enable ? DRIVER_IS_ON : 0));
}

static void begin(fault_record_t *self, const can_node_tick_t *tick, const quiesce_telemetry_t *t) {
    uint32_t *const head = live(self)->head;
    head[0] = 0; // until it is said what runs
    self->is_latched = t->state == QUIESCE_STATE_FAULT;
    head[1] = (t->fault & 255u) | (self->state & 15u) << 8 | (self->is_latched ? IS_LATCHED : 0u) |
              FAULT_RECORD_BINS << 24;
    head[2] = t->tick;
    head[7] = t->fault_count;
    head[8] = (uint32_t)tick->accel_counts;
    head[9] = tick->overruns;
    head[10] = t->bad_sample_count;
    self->number = (self->number + 1u) & UINT16_MAX;
    head[11] = self->number;
    self->left_bins = FAULT_RECORD_AFTER + 1u;
    self->later = 0;
    self->is_reset_seen = false;
}

void fault_record_about(fault_record_t *self, const fault_record_about_t *about) {
    uint32_t *const head = live(self)->head;
    head[0] = FAULT_RECORD_MAGIC;
    head[3] = self->bin_ticks | about->tick_rate_Hz << 16;
    head[4] = about->param_hash;
    head[5] = about->table_hash;
    head[6] = QUIESCE_VERSION_MAJOR + ((uint32_t)QUIESCE_VERSION_MINOR << 8) +
              ((uint32_t)QUIESCE_VERSION_PATCH << 16) +
              ((uint32_t)QUIESCE_CAN_INTERFACE_VERSION << 24);
    head[11] |= (about->law & 255u) << 16; // damper 0
}

static void note_fault(fault_record_t *self, const can_node_tick_t *tick,
                       const quiesce_telemetry_t *t) {
    const bool is_free = (!self->is_held || self->is_acknowledged) && !fault_record_is_busy(self);
    const bool outranks = t->state == QUIESCE_STATE_FAULT && !self->is_latched;
    if (is_free || outranks) {
        begin(self, tick, t);
    } else {
        self->later += self->later < UINT16_MAX ? 1u : 0u;
        self->is_reset_seen = false;
    }
}

/// Pressed, and no fault is left.
static void note_reset(fault_record_t *self, bool is_reset, bool is_faulted) {
    self->is_reset_seen = self->is_reset_seen || (is_reset && !self->was_reset);
    self->was_reset = is_reset;
    if (self->is_reset_seen && !is_faulted && !fault_record_is_busy(self)) {
        self->generation += self->is_held && !self->is_acknowledged ? 1u : 0u;
        self->is_acknowledged = self->is_held;
        self->is_reset_seen = false;
    }
}

// One bin a tick at the most: after lost ticks the others follow, with the ticks after the gap.
static void pass(fault_record_t *self, uint32_t ticks) {
    const uint32_t most = FAULT_RECORD_BINS * self->bin_ticks;
    self->owed_ticks = ticks < most - self->owed_ticks ? self->owed_ticks + ticks : most;
    if (self->owed_ticks < self->bin_ticks) {
        return;
    }
    self->owed_ticks -= self->bin_ticks;
    if (self->left_bins == 1u) {
        end_taking(self);
    } else {
        close_bin(self);
        self->left_bins -= self->left_bins > 0u ? 1u : 0u;
    }
}

void fault_record_watch(fault_record_t *self, const can_node_tick_t *tick,
                        const quiesce_out_t *out) {
    const quiesce_telemetry_t *const t = &out->telemetry;
    const bool is_faulted = t->fault != QUIESCE_FAULT_NONE;
    add_tick(self, tick, out);
    if (is_faulted && (t->fault != self->fault || t->fault_count != self->fault_count)) {
        note_fault(self, tick, t);
    }
    pass(self, tick->ticks);
    note_reset(self, tick->fault_reset, is_faulted);
    if (self->summed < SUMMED_WORDS) {
        sum_word(self);
    }
    self->fault = t->fault;
    self->fault_count = t->fault_count;
    self->state = t->state;
}

bool fault_record_is_busy(const fault_record_t *self) {
    return self->left_bins > 0u || self->summed < SUMMED_WORDS;
}

bool fault_record_request(fault_record_t *self, uint32_t first, uint32_t count) {
    if (!self->is_held || fault_record_is_busy(self) || first >= FAULT_RECORD_PAGES) {
        return false;
    }
    const uint32_t left = FAULT_RECORD_PAGES - first;
    self->next_page = first;
    self->end_page = first + (count == 0u || count > left ? left : count);
    return true;
}

bool fault_record_clear(fault_record_t *self) {
    const bool was_held = self->is_held && !fault_record_is_busy(self);
    if (was_held) {
        self->is_held = false;
        self->is_acknowledged = false;
        self->later = 0;
        self->next_page = self->end_page;
        self->generation++;
    }
    return was_held;
}

static uint32_t half_of(const fault_record_ring_t *ring, uint32_t index) {
    const uint32_t word = index / 2u < SUMMED_WORDS ? word_of(ring, index / 2u) : ring->crc;
    return (index % 2u == 0u ? word : word >> 16) & UINT16_MAX;
}

bool fault_record_page(fault_record_t *self, can_frame_t *frame) {
    if (self->next_page >= self->end_page) {
        return false;
    }
    const fault_record_ring_t *const ring = held(self);
    const uint32_t at = self->next_page * FAULT_RECORD_PAGE_HALVES;
    const struct quiesce_can_fault_record_t page = {
        .record_page = (uint16_t)self->next_page,
        .record_number = (uint8_t)(ring->head[11] & 15u),
        .record_half0 = (uint16_t)half_of(ring, at),
        .record_half1 = (uint16_t)half_of(ring, at + 1u),
        .record_half2 = (uint16_t)half_of(ring, at + 2u),
    };
    (void)quiesce_can_fault_record_pack(frame->data, &page, sizeof frame->data);
    self->next_page++;
    return true;
}

bool fault_record_copy(const fault_record_t *self, uint32_t words[FAULT_RECORD_WORDS]) {
    if (!self->is_held || self->summed < SUMMED_WORDS) {
        return false;
    }
    for (uint32_t i = 0; i < SUMMED_WORDS; i++) {
        words[i] = word_of(held(self), i);
    }
    words[SUMMED_WORDS] = held(self)->crc;
    return true;
}

bool fault_record_load(fault_record_t *self, const uint32_t words[FAULT_RECORD_WORDS],
                       bool is_acknowledged) {
    if (words[0] != FAULT_RECORD_MAGIC || words[1] >> 24 != FAULT_RECORD_BINS ||
        words[SUMMED_WORDS] != crc32_words(words, SUMMED_WORDS)) {
        return false;
    }
    fault_record_ring_t *const ring = &self->ring[1u - self->live];
    for (uint32_t i = 0; i < FAULT_RECORD_HEAD; i++) {
        ring->head[i] = words[i];
    }
    for (uint32_t i = 0; i < FAULT_RECORD_BINS * FAULT_RECORD_SIGNALS; i++) {
        ring->bins[i / FAULT_RECORD_SIGNALS][i % FAULT_RECORD_SIGNALS] =
            words[FAULT_RECORD_HEAD + i];
    }
    ring->next = 0;
    ring->filled = FAULT_RECORD_BINS;
    ring->crc = words[SUMMED_WORDS];
    self->number = words[11] & UINT16_MAX;
    self->is_latched = (words[1] & IS_LATCHED) != 0u;
    self->is_held = true;
    self->is_acknowledged = is_acknowledged;
    return true;
}
