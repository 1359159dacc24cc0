/// Quiesce: vibration control with a magnetorheological damper. The only header of the controller
/// that the outside sees.
///
/// Integer arithmetic only; the same input stream gives the same bits on every target. No heap, no
/// globals, no clock: the caller owns the state and calls quiesce_step once a control tick.
#ifndef QUIESCE_H
#define QUIESCE_H

#include <stdbool.h>
#include <stdint.h>

#include "quiesce_board.h"
#include "quiesce_faults.h"
#include "quiesce_params.h"
#include "quiesce_valid.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Spectral peaks in telemetry, strongest acceleration first.
#define QUIESCE_PEAKS 3

/// Supervisor states. Only RUN and DEGRADED let a law's request through; all others command
/// safe_current_mA, INIT, SELF_TEST and FAULT with the drivers off. Numbers are never reused.
typedef enum {
    QUIESCE_STATE_INIT = 0,     ///< nothing is known yet
    QUIESCE_STATE_IDLE = 1,     ///< healthy, not armed
    QUIESCE_STATE_RUN = 2,      ///< the law's request passes the guard
    QUIESCE_STATE_SAFE = 3,     ///< a fault that clears by itself is present or has just gone
    QUIESCE_STATE_FAULT = 4,    ///< a latched fault; left only by fault_reset
    QUIESCE_STATE_ARMED = 5,    ///< enable has risen; runs as soon as all that it needs is there
    QUIESCE_STATE_DEGRADED = 6, ///< as RUN, with a coil's current limited by its heat, or without a
                                ///< sensor that the law does not need
    QUIESCE_STATE_SELF_TEST = 7, ///< gathering samples; drivers that are off carry no current
    QUIESCE_STATE_COUNT
} quiesce_state_t;

/// What a sensor delivered in a tick.
typedef struct {
    int32_t counts;    ///< raw ADC counts; ignored unless is_fresh
    bool is_fresh;     ///< a sample arrived since the last tick
    bool is_saturated; ///< the sensor says that it is; ignored unless is_fresh
} quiesce_sample_t;

/// What a damper's current driver said in a tick.
typedef struct {
    int32_t current_mA; ///< measured coil current; ignored unless is_measured
    bool is_measured;   ///< there is a measurement
    bool is_old;        ///< it is that of an earlier tick, once more; ignored unless is_measured
    bool has_failed;    ///< it reports a fault, or cannot be told its current
} quiesce_driver_t;

/// One tick's input.
typedef struct {
    uint32_t tick; ///< number of this tick; the last one + 1 (wraps)
    quiesce_sample_t sensor[QUIESCE_SENSORS];
    quiesce_driver_t driver[QUIESCE_DAMPERS];
    bool enable;      ///< operator enables the output; its rising edge arms, see quiesce_step
    bool estop;       ///< emergency stop
    bool fault_reset; ///< operator acknowledges a latched fault (acts on its rising edge)
} quiesce_in_t;

/// One sinusoidal component of the acceleration: amp x cos(phase).
typedef struct {
    int32_t freq_uHz;
    int32_t amp_um_s2;  ///< acceleration amplitude (peak, not RMS)
    int32_t phase_mdeg; ///< at this tick, -180000 .. 179999
} quiesce_peak_t;

/// Everything that a tick leaves behind to look at; 32-bit words only, the same layout everywhere.
typedef struct {
    uint32_t tick;
    uint32_t state;            ///< quiesce_state_t
    uint32_t fault;            ///< quiesce_fault_t that led to SAFE or FAULT, else NONE
    uint32_t fault_count;      ///< faults entered since init, saturating
    uint32_t bad_sample_count; ///< samples refused since init, saturating
    int32_t accel_um_s2;       ///< conditioned acceleration, DC removed
    int32_t velocity_um_s;     ///< leaky integral of it
    int32_t rms_um_s2;         ///< windowed RMS of it
    uint32_t freq_is_valid;    ///< 1: the dominant component can be trusted now
    uint32_t freq_age_ticks;   ///< since it was last valid, saturating
    int32_t freq_uHz;          ///< dominant component, last estimate: its frequency
    int32_t freq_amp_um_s2;    ///< acceleration amplitude
    int32_t freq_phase_mdeg;   ///< phase at this tick, -180000 .. 179999: accel = amp x cos(phase)
    int32_t freq_sigma_uHz;    ///< standard deviation expected of freq_uHz
    uint32_t freq_window_ms;   ///< length of the window that it was estimated from
    int32_t displacement_nm;   ///< now; dominant component and its third harmonic
    int32_t displacement_amp_nm;         ///< half peak-to-peak of that over a cycle
    int32_t velocity_rms_um_s;           ///< of the whole band, from the last spectrum
    quiesce_peak_t peaks[QUIESCE_PEAKS]; ///< 0 Hz where there are fewer
    int32_t current_law_mA;              ///< what the law requests
    int32_t current_cmd_mA;              ///< what leaves the guard
    uint32_t lock_is_on;                 ///< law phase has locked on to the dominant component
} quiesce_telemetry_t;

/// For a damper's current driver.
typedef struct {
    int32_t current_cmd_mA; ///< 0 .. max_current_mA
    bool driver_enable;     ///< false in INIT, SELF_TEST and FAULT
} quiesce_command_t;

/// One tick's output.
typedef struct {
    quiesce_command_t damper[QUIESCE_DAMPERS];
    quiesce_telemetry_t telemetry;
} quiesce_out_t;

/// Controller state, owned by the caller; contents are private. Copying it copies the controller.
#define QUIESCE_STATE_BYTES                                                                        \
    (12320 + 512 * (QUIESCE_SENSORS - 1) + 64 * (QUIESCE_BODIES - 1) + 256 * (QUIESCE_DAMPERS - 1))
typedef struct {
    uint64_t opaque[QUIESCE_STATE_BYTES / 8];
} quiesce_t;

// The names that the linker sees have the sizes in them: what was compiled for other ones than the
// library does not link, instead of handing over memory that is too small.
#define QUIESCE_JOIN_SIZES(name, sensors, bodies, dampers) name##_##sensors##_##bodies##_##dampers
#define QUIESCE_SIZED(name, sensors, bodies, dampers)                                              \
    QUIESCE_JOIN_SIZES(name, sensors, bodies, dampers)
#define quiesce_init QUIESCE_SIZED(quiesce_init, QUIESCE_SENSORS, QUIESCE_BODIES, QUIESCE_DAMPERS)
#define quiesce_init_board                                                                         \
    QUIESCE_SIZED(quiesce_init_board, QUIESCE_SENSORS, QUIESCE_BODIES, QUIESCE_DAMPERS)

/// Starts the controller from rest with a copy of the parameters: one accelerometer and one damper
/// to the ground, as they say (accel_*, sensor_*, safe_current_mA, current_*).
/// Returns false iff quiesce_params_check refuses them; the controller is then in FAULT with
/// QUIESCE_FAULT_PARAMETER and commands quiesce_params_safe_current_mA. Call it before the first
/// step.
bool quiesce_init(quiesce_t *self, const quiesce_params_t *params);

/// The same with the sensors and dampers of a board, which take the place of those parameters.
/// Returns false, with that fault, also where quiesce_board_check refuses the board, or where
/// quiesce_missing names a signal; it then commands the board's safe currents, 0 where the board is
/// the one that is refused.
bool quiesce_init_board(quiesce_t *self, const quiesce_board_t *board,
                        const quiesce_params_t *params);

/// A signal, for a message.
typedef struct {
    const char *name; ///< "stroke", "force", ..
    int32_t at;       ///< of which body or damper, from 0; -1: there is one only
} quiesce_signal_t;

/// The first signal that the law of parameters needs, or the tracker of the forces that it demands,
/// and no sensor of a board provides; both have been checked. Returns false iff there is none.
bool quiesce_missing(const quiesce_board_t *board, const quiesce_params_t *params,
                     quiesce_signal_t *missing);

/// The signals that laws see with the sensors of a board, which has been checked: index 0, 1, ..
/// until it returns false.
bool quiesce_provided(const quiesce_board_t *board, uint32_t index, quiesce_signal_t *provided);

/// What the controller makes of its sensors: all bodies and dampers that there can be, so that the
/// layout is the same in every build. 32-bit words only.
typedef struct {
    uint32_t valid[2]; ///< bits QUIESCE_VALID_x, low word first
    int32_t supply_mV;
    struct {
        int32_t accel_um_s2, velocity_um_s, displacement_nm;
    } body[QUIESCE_MAX_BODIES];
    struct {
        int32_t stroke_nm, velocity_um_s, force_mN, current_mA, voltage_mV, temperature_mdegC;
        int32_t current_law_mA; ///< what the law requests
        int32_t current_cmd_mA; ///< what leaves the guard
    } damper[QUIESCE_MAX_DAMPERS];
} quiesce_picture_t;

/// Of the last step. Made when it is asked for, some 200 instructions.
void quiesce_picture(const quiesce_t *self, quiesce_picture_t *out);

/// The same on a controller that has been running: it starts from rest, disarmed, but does not
/// forget how hot its coils are, nor what it watches. board: that of the start, NULL after
/// quiesce_init.
bool quiesce_restart(quiesce_t *self, const quiesce_board_t *board, const quiesce_params_t *params);

/// Goes on where another controller stands, in every bit: for a simulation that is put back to an
/// earlier instant, or continued elsewhere. from: a copy of it, maybe its bytes from another
/// process on such a machine. self: started by the same build with the same board, law, tracker and
/// tables, which stay its own; parameters that were changed since are taken over. Returns false,
/// and changes nothing, iff law, tracker, tables or watched words differ. What else is in the bytes
/// is not looked at: they must be a controller's.
bool quiesce_go_on(quiesce_t *self, const quiesce_t *from);

/// Other parameters between two steps, also while it runs: those that are live
/// (quiesce_param_info_t). Nothing starts anew; the slew limit bounds what they do to the command.
/// Returns false, and changes nothing, iff quiesce_params_check refuses them, others differ from
/// those in use, or the start was refused.
bool quiesce_params_use(quiesce_t *self, const quiesce_params_t *params);

/// Words of the caller that are not to change while it runs, such as a board or the program itself:
/// number which, 0 .. QUIESCE_WATCHES - 1; count 0: none any more. The controller reads them, as it
/// does its parameters and tables, twice a second, and is in MEMORY once they differ. Reads
/// them all now.
#define QUIESCE_WATCHES 2
void quiesce_watch(quiesce_t *self, uint32_t which, const uint32_t *words, uint32_t count);

/// The target keeps its drivers off, whatever the state: called after each step for as long as it
/// does, as while flash is erased. in, out: the step's, whose driver_enable falls. Where they would
/// be on, what is measured is what is expected, and counts from there when it ends; where they are
/// off (self-test, a fault) nothing changes. A trip and heat go on. Whoever holds them gives no
/// enable.
void quiesce_hold_drivers(quiesce_t *self, const quiesce_in_t *in, quiesce_out_t *out);

/// Whether the operator has armed it: it runs, or will as soon as all that it needs is there.
bool quiesce_is_armed(const quiesce_t *self);

/// One control tick. Bounded; safe in an interrupt. Writes all of *out.
///
/// The output needs an arming edge: enable that rises before the output is on, and stays. After the
/// start, a latched fault or a restart an enable that is held runs nothing until it has been let
/// go. A driver is to be off until the first step has said otherwise.
void quiesce_step(quiesce_t *self, const quiesce_in_t *in, quiesce_out_t *out);

/// The current that these parameters make safe, even where they are refused as a whole:
/// safe_current_mA, or 0 where it or max_current_mA is outside its own range or they contradict.
int32_t quiesce_params_safe_current_mA(const quiesce_params_t *params);

/// Why a table is refused. Numbers are for logs and are never reused.
typedef enum {
    QUIESCE_TABLE_OK = 0,
    QUIESCE_TABLE_SIZE = 1,   ///< shorter than it says, or too long
    QUIESCE_TABLE_MAGIC = 2,  ///< not a table of the kind that the law works with, or of another
                              ///< version; or the law has none
    QUIESCE_TABLE_CRC = 3,    ///< damaged
    QUIESCE_TABLE_SHAPE = 4,  ///< numbers of inputs, outputs, rules, points
    QUIESCE_TABLE_CELL = 5,   ///< memberships
    QUIESCE_TABLE_RULE = 6,   ///< a rule names what is not there
    QUIESCE_TABLE_OUTPUT = 7, ///< a term out of range
    QUIESCE_TABLE_FIT = 8,    ///< inputs, outputs or their units are not the law's; it needs a
                              ///< signal or a damper that the board does not have; it is made for
                              ///< another tick rate
    QUIESCE_TABLE_POINT = 9,  ///< a frequency that does not rise, a floor above its level, a long
                              ///< ramp; an axis or a force of a map; a coefficient, limit, band,
                              ///< power or current of a law in form of a table
    QUIESCE_TABLE_BOARD = 10, ///< its file is of another board
} quiesce_table_verdict_t;

/// What a table is of: there is one of each in use.
typedef enum {
    QUIESCE_OF_LAW = 0,     ///< rules, pulses, gains, ..
    QUIESCE_OF_TRACKER = 1, ///< a damper's map, .., beside the law's where it demands forces
    QUIESCE_TABLE_OWNERS
} quiesce_owner_t;

/// Words of a table at the most.
#define QUIESCE_TABLE_WORDS 2048

/// The name of a kind of table ("rules", "pulses", ..) by the first word of its tables, and what it
/// is of (may be NULL). Returns NULL iff no law and no tracker works with that kind.
const char *quiesce_table_kind(uint32_t magic, quiesce_owner_t *owner);

/// Whether words are a good table of their kind; FIT, to a board and a tick rate, is not looked at.
/// Bounded by their number, some 60 instructions a word.
quiesce_table_verdict_t quiesce_table_check(const uint32_t *words, uint32_t count);

/// Law or tracker uses another table from the next tick on: words from `quiesce rules compile`,
/// `quiesce tune`, `quiesce law make`, `quiesce identify inverse`, .., count of them. What was
/// learnt about another table is forgotten. The words stay the caller's and must not change while
/// they are in use. A table that is refused changes nothing. Call between steps, also while
/// running: the swap is one pointer. quiesce_init goes back to those that ship.
quiesce_table_verdict_t quiesce_table_use(quiesce_t *self, const uint32_t *words, uint32_t count);

/// Back to the table that ships, or to none where none ships: such a law requests nothing until it
/// has one, to a tracker that is a signal which it lacks. Returns false iff there is no such table.
bool quiesce_table_drop(quiesce_t *self, quiesce_owner_t owner);

/// The table in use. NULL: none.
const uint32_t *quiesce_table_in_use(const quiesce_t *self, quiesce_owner_t owner);

/// Whose table is missing, so that nothing is requested but the fallback: the law's or the
/// tracker's name. Returns NULL iff none is.
const char *quiesce_lacks_table(const quiesce_t *self);

/// CRC-32 that the table in use carries: the law's, else its tracker's; 0 where there is none.
uint32_t quiesce_table_hash(const quiesce_t *self);

/// Room for tables that arrive in parts, beside those in use. Where a tracker of the build has
/// tables: the law's and the tracker's, each with the one before it, and the one that arrives.
/// Where none has: the law's, and one more, which what arrives takes from the table before it. A
/// table is put to use whole and checked, or not at all. Contents are private.
#define QUIESCE_TRACKERS_HAVE_TABLES                                                               \
    (QUIESCE_WITH_TRACKER_INVERSE || QUIESCE_WITH_TRACKER_NETWORK || QUIESCE_WITH_TRACKER_BANK)
#define QUIESCE_TABLE_ROOMS (QUIESCE_TRACKERS_HAVE_TABLES ? 5u : 2u)
typedef struct {
    uint32_t words[QUIESCE_TABLE_ROOMS][QUIESCE_TABLE_WORDS];
    uint32_t filled;  ///< words that have arrived
    uint32_t summed;  ///< of them, those that crc covers
    uint32_t crc;     ///< from the third word on
    uint32_t arrival; ///< the room that is filled
    uint32_t held;    ///< the room that somebody reads; QUIESCE_TABLE_ROOMS: none
    struct {
        uint32_t now, before;    ///< rooms; QUIESCE_TABLE_ROOMS: what ships
        const uint32_t *shipped; ///< NULL: what the law ships with
    } of[QUIESCE_TABLE_OWNERS];
} quiesce_tables_t;

/// Empty, with the tables that ship in use.
void quiesce_tables_init(quiesce_tables_t *tables);

/// Words that take the place of those that the law ships with, such as ones that are linked into a
/// program; a good table, which stays the caller's. Then quiesce_tables_resume.
void quiesce_tables_ship(quiesce_tables_t *tables, const uint32_t *words);

/// Somebody reads a table in use, such as a store of the target: until the next call nothing that
/// arrives takes its room, also once another table is in use. NULL: nobody does.
void quiesce_tables_hold(quiesce_tables_t *tables, const uint32_t *words);

/// Whether a table can arrive: false where the one room that it could take is held.
bool quiesce_tables_have_room(const quiesce_tables_t *tables);

/// The room of what arrives next, QUIESCE_TABLE_WORDS words: who fills it writes it from there with
/// offset 0. Only where there is one; forgets what has arrived.
uint32_t *quiesce_tables_room(quiesce_tables_t *tables);

/// Appends words of a table that arrives; offset 0 starts anew. Returns false, and changes nothing,
/// iff offset is neither 0 nor where the last part ended, or the part does not fit, or at offset 0
/// there is no room.
bool quiesce_tables_write(quiesce_tables_t *tables, uint32_t offset, const uint32_t *words,
                          uint32_t count);

/// Sums up to so many words of what has arrived, some 60 instructions a word, ahead of what check
/// and commit would do at once. Returns true iff nothing is left to sum.
bool quiesce_tables_sum(quiesce_tables_t *tables, uint32_t words);

/// What has arrived so far.
const uint32_t *quiesce_tables_arrival(const quiesce_tables_t *tables, uint32_t *count);

/// What commit would say. Changes nothing.
quiesce_table_verdict_t quiesce_tables_check(quiesce_tables_t *tables, const quiesce_t *self);

/// Checks what has arrived and uses it from the next tick on. A table that is refused leaves the
/// one in use where it is. Call it, like the next two, between steps.
quiesce_table_verdict_t quiesce_tables_commit(quiesce_tables_t *tables, quiesce_t *self);

/// What has arrived stays for later, where it is a good table that law and tracker do not take now,
/// such as an earlier run's with another law: quiesce_tables_resume uses it once they do. Returns
/// false, and keeps nothing, iff it is no good one, or another one of its owner is there.
bool quiesce_tables_keep(quiesce_tables_t *tables);

/// Goes back to the table in use before the last commit or unload. Returns false, and changes
/// nothing, iff that has been done already, there was none, another one has begun to arrive in its
/// room, or it is refused by now.
bool quiesce_tables_revert(quiesce_tables_t *tables, quiesce_t *self, quiesce_owner_t owner);

/// Goes back to the table that ships, which the next revert undoes. Returns false iff law and
/// tracker have no such table.
bool quiesce_tables_unload(quiesce_tables_t *tables, quiesce_t *self, quiesce_owner_t owner);

/// After quiesce_init or quiesce_restart: those in use before are again, where law and tracker take
/// them; the others stay where they are.
void quiesce_tables_resume(const quiesce_tables_t *tables, quiesce_t *self);

/// Whether the one in use has been loaded, and does not ship.
bool quiesce_tables_is_loaded(const quiesce_tables_t *tables, const quiesce_t *self,
                              quiesce_owner_t owner);

/// Whether one is there that law and tracker do not take now: the next resume tries it again.
bool quiesce_tables_is_waiting(const quiesce_tables_t *tables, const quiesce_t *self,
                               quiesce_owner_t owner);

/// What the law that runs has learnt about the structure, as words to keep over a restart.
#define QUIESCE_LEARNT_MAX_WORDS 255
typedef struct {
    uint32_t count; ///< of words; the others are 0
    uint32_t words[QUIESCE_LEARNT_MAX_WORDS];
} quiesce_learnt_t;

/// Takes it out. Returns false, with a count of 0, iff this law learns nothing. Bounded, some 5,000
/// instructions: call it now and then.
bool quiesce_learnt_save(const quiesce_t *self, quiesce_learnt_t *out);

/// Puts it back, after quiesce_init or quiesce_table_use; NULL: forgets what was learnt. Returns
/// false, and changes nothing, iff it is damaged, of another version, law, table or setting, or
/// beyond the limits in the parameters.
bool quiesce_learnt_load(quiesce_t *self, const quiesce_learnt_t *in);

/// Stops learning until it is told otherwise; what has been learnt stays in use.
void quiesce_learnt_freeze(quiesce_t *self, bool is_frozen);

/// What the law that runs has to tell of itself beyond telemetry.
#define QUIESCE_REPORT_WORDS 8
typedef struct {
    const char *name; ///< NULL: the word is not used
    const char *unit;
} quiesce_word_t;

/// The QUIESCE_REPORT_WORDS words of a law's report, by the value of parameter law. Returns NULL
/// iff there is no such law.
const quiesce_word_t *quiesce_report_words(int32_t law);

/// Writes all words, those that are not used as 0. Made when it is asked for, of what the last step
/// left: up to 1,000 instructions, which no tick pays.
void quiesce_report(const quiesce_t *self, int32_t word[QUIESCE_REPORT_WORDS]);

#ifdef __cplusplus
}
#endif

#endif
