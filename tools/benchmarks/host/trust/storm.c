#include "storm.h"

enum {
    FULL_SCALE = 8388607,
    SENSE_EVERY = 3000, // ticks of calm between spells, in the worst storm a tenth
    COIL_EVERY = 4000,
    ESTOP_EVERY = 6000,
    FAILED_EVERY = 9000,
    ENABLE_EVERY = 2000,
    RESET_EVERY = 400,
    GAP_EVERY = 5000,
    RETUNE_EVERY = 4000,
};

void storm_start(storm_t *self, const rig_t *rig, dice_t *dice) {
    static const uint32_t calms[] = {1, 4, 16, 100};
    *self = (storm_t){.rig = rig, .dice = dice, .calm = calms[dice_below(dice, 4)]};
    self->enable.kind = dice_below(dice, 2);
    self->reset.kind = dice_below(dice, 2);
}

static bool begins(storm_t *self, uint32_t every_ticks) {
    return dice_below(self->dice, every_ticks * self->calm) < 10u;
}

// Something that lasts a while and then is over (kind 0).
static void weather(storm_t *self, spell_t *spell, uint32_t every_ticks, uint32_t kinds,
                    uint32_t longest_ticks) {
    if (spell->left_ticks > 0) {
        spell->left_ticks--;
        spell->kind = spell->left_ticks > 0 ? spell->kind : 0u;
    } else if (begins(self, every_ticks)) {
        spell->kind = 1u + dice_below(self->dice, kinds - 1u);
        spell->left_ticks = 1u + dice_below(self->dice, longest_ticks);
    }
}

// A switch: most times on (kind 1) for enable, off for the acknowledgement; now and then it
// chatters.
static void chatter(storm_t *self, spell_t *spell, uint32_t every_ticks, uint32_t rest) {
    if (spell->left_ticks > 0) {
        spell->left_ticks--;
    } else if (spell->kind != rest) {
        spell->kind = rest;
    } else if (begins(self, every_ticks)) {
        spell->kind = 1u - rest;
        spell->left_ticks = dice_below(self->dice, dice_one_in(self->dice, 3) ? 3u : 400u);
    }
}

// A parabola a half wave.
static int32_t wave(int32_t amplitude, uint32_t phase_turn) {
    const int64_t x = (int32_t)phase_turn / 65536; // half turns Q15
    return (int32_t)(amplitude * (x * (32768 - (x < 0 ? -x : x)) / 8192) / 32768);
}

static int32_t good_counts(storm_t *self) {
    if (dice_one_in(self->dice, RETUNE_EVERY)) {
        self->amplitude = (FULL_SCALE / 2) >> dice_below(self->dice, 16);
        const uint32_t rate_Hz = (uint32_t)self->rig->params.tick_rate_Hz;
        self->step_turn = (UINT32_MAX / rate_Hz) / 1000u * (500u + dice_below(self->dice, 30000));
    }
    self->phase_turn += self->step_turn;
    return wave(self->amplitude, self->phase_turn) + dice_between(self->dice, -30, 30);
}

static void sense(storm_t *self, const spell_t *spell, int32_t counts, quiesce_sample_t *sample) {
    dice_t *const dice = self->dice;
    sample->is_fresh = true;
    switch ((sense_t)spell->kind) {
    case SENSE_LOST:
        sample->is_fresh = false;
        break;
    case SENSE_FULL:
        sample->counts = (dice_one_in(dice, 2) ? FULL_SCALE : -FULL_SCALE) - 1;
        break;
    case SENSE_WILD:
        sample->counts = (int32_t)dice_word(dice);
        break;
    case SENSE_STUCK:
        break;
    case SENSE_PATCHY:
        sample->is_fresh = !dice_one_in(dice, 3);
        sample->counts = counts;
        break;
    case SENSE_GOOD:
    default:
        sample->counts = counts;
        break;
    }
}

// The coil follows what was commanded a tick ago.
static void measure(storm_t *self, uint32_t i, const quiesce_command_t *command,
                    quiesce_driver_t *driver) {
    const int32_t lag_ms = self->rig->has_board ? self->rig->board.damper[i].coil_lag_us / 1000
                                                : self->rig->params.current_lag_ms;
    const int32_t lag_ticks = lag_ms * self->rig->params.tick_rate_Hz / 1000;
    const int32_t command_mA = command->driver_enable ? command->current_cmd_mA : 0;
    self->coil_mA_q8[i] += (command_mA * 256 - self->coil_mA_q8[i]) / (1 + lag_ticks);
    driver->is_measured = self->coil[i].kind != COIL_UNKNOWN;
    switch ((coil_t)self->coil[i].kind) {
    case COIL_OPEN:
        driver->current_mA = dice_between(self->dice, -20, 20);
        break;
    case COIL_OFF_BY:
        driver->current_mA = self->coil_mA_q8[i] / 256 + self->off_by_mA;
        break;
    case COIL_WILD:
        driver->current_mA = (int32_t)dice_word(self->dice);
        break;
    case COIL_FOLLOWS:
    case COIL_UNKNOWN:
    default:
        driver->current_mA = self->coil_mA_q8[i] / 256;
        break;
    }
}

static void operate(storm_t *self, quiesce_in_t *in) {
    weather(self, &self->estop, ESTOP_EVERY, 2, 40);
    weather(self, &self->failed, FAILED_EVERY, 2, 40);
    chatter(self, &self->enable, ENABLE_EVERY, 1);
    chatter(self, &self->reset, RESET_EVERY, 0);
    if (self->failed.left_ticks == 0) {
        self->failed_damper = dice_below(self->dice, QUIESCE_DAMPERS);
    }
    in->estop = self->estop.kind != 0;
    in->enable = self->enable.kind != 0;
    in->fault_reset = self->reset.kind != 0;
}

void storm_tick(storm_t *self, const quiesce_out_t *out, quiesce_in_t *in) {
    const uint32_t sensors = self->rig->has_board ? (uint32_t)self->rig->board.sensors : 1u;
    const int32_t counts = good_counts(self);
    in->tick += dice_one_in(self->dice, GAP_EVERY) ? dice_below(self->dice, 10) : 1u;
    for (uint32_t i = 0; i < sensors; i++) {
        weather(self, &self->sense[i], SENSE_EVERY, SENSE_PATCHY + 1, 60);
        sense(self, &self->sense[i], counts >> i, &in->sensor[i]);
    }
    operate(self, in);
    for (uint32_t i = 0; i < rig_dampers(self->rig); i++) {
        weather(self, &self->coil[i], COIL_EVERY, COIL_UNKNOWN + 1, 80);
        if (self->coil[i].left_ticks == 0) {
            self->off_by_mA = dice_between(self->dice, -6000, 6000);
        }
        measure(self, i, &out->damper[i], &in->driver[i]);
        in->driver[i].has_failed = self->failed.kind != 0 && self->failed_damper == i;
    }
}
