#include "current_loop.h"

#include "fixq.h"

#define MOST_ERROR_mA 16383
#define MOST_GAIN 65535
#define MOST_INTEGRAL_mV 32767
#define LEAST_SUPPLY_mV 1000
#define MOST_SUPPLY_mV 60000
#define US_A_STEP (1000000 / (int32_t)CURRENT_LOOP_HZ)
/// Next to no current, in parts of the full scale: a resistance is not known from less.
#define LITTLE 32
/// Copper's resistance grows by 1 / 254.5 a degree.
#define COPPER_DEGC 254
#define MOST_RISE_MOHM 8000000 // its product keeps within 2^31

static bool is_within(int32_t value, int32_t low, int32_t high) {
    return value >= low && value <= high;
}

static bool is_valid(const current_loop_cfg_t *cfg) {
    return is_within(cfg->resistance_mohm, 100, 100000) &&
           is_within(cfg->gain_mV_a_mA_q8, 1, MOST_GAIN) &&
           is_within(cfg->integral_time_us, 1000, 1000000) &&
           is_within(cfg->integral_mV, 0, MOST_INTEGRAL_mV) &&
           (cfg->least_duty == 0 || cfg->least_duty == -CURRENT_LOOP_FULL) &&
           is_within(cfg->full_scale_mA, 100, MOST_ERROR_mA);
}

bool current_loop_init(current_loop_t *self, const current_loop_cfg_t *cfg) {
    *self = (current_loop_t){0};
    if (!is_valid(cfg)) {
        return false;
    }
    self->cfg = *cfg;
    // Q8 to Q12, times the period; 6553 at the most.
    const int64_t gain_q12 = (int64_t)cfg->gain_mV_a_mA_q8 * 16 * US_A_STEP;
    self->integral_gain_q12 = (int32_t)clamp_i64(gain_q12 / cfg->integral_time_us, 0, MOST_GAIN);
    return true;
}

void current_loop_command(current_loop_t *self, int32_t command_mA) {
    const int32_t most = self->cfg.full_scale_mA;
    const int32_t command = clamp_i32(command_mA, self->cfg.least_duty < 0 ? -most : 0, most);
    self->command_mA = command;
    self->command_mV = (int32_t)clamp_i64((int64_t)command * self->cfg.resistance_mohm / 1000,
                                          -MOST_SUPPLY_mV, MOST_SUPPLY_mV);
}

static void watch(current_loop_t *self, int32_t current_mA, int32_t voltage_mV) {
    current_loop_window_t *const window = &self->window;
    if (window->count == 0u) {
        window->first_mA = current_mA;
    }
    window->sum_mV += voltage_mV; // 4096 x 60 V keep within 2^28
    window->sum_mA += current_mA;
    window->count++;
    if (window->count < CURRENT_LOOP_WINDOW) {
        return;
    }
    const bool is_same = abs_i32(current_mA - window->first_mA) <= CURRENT_LOOP_SAME_mA;
    if (is_same) {
        self->last = *window;
    }
    if (is_same || window->count >= CURRENT_LOOP_WINDOW_MOST) {
        *window = (current_loop_window_t){0};
    }
}

int32_t current_loop_step(current_loop_t *self, int32_t current_mA, int32_t supply_mV) {
    const int32_t supply = clamp_i32(supply_mV, LEAST_SUPPLY_mV, MOST_SUPPLY_mV);
    const int32_t current = clamp_i32(current_mA, -MOST_ERROR_mA, MOST_ERROR_mA);
    const int32_t error = clamp_i32(self->command_mA - current, -MOST_ERROR_mA, MOST_ERROR_mA);
    const int32_t least = self->cfg.least_duty < 0 ? -supply : 0;
    const int32_t wanted =
        self->command_mV + (self->cfg.gain_mV_a_mA_q8 * error >> 8) + (self->integral_mV_q12 >> 12);
    const int32_t voltage = clamp_i32(wanted, least, supply);
    // Beyond a limit only what leads back counts.
    if (voltage == wanted || (wanted > voltage) == (error < 0)) {
        const int32_t limit = self->cfg.integral_mV << 12;
        self->integral_mV_q12 =
            clamp_i32(self->integral_mV_q12 + self->integral_gain_q12 * error, -limit, limit);
    }
    watch(self, current, voltage);
    return voltage * CURRENT_LOOP_FULL / supply;
}

void current_loop_rest(current_loop_t *self) {
    self->integral_mV_q12 = 0;
    self->window = (current_loop_window_t){0};
}

// Sums become small enough for a product with 1000 in 32 bits, the same way.
static int32_t ratio_mohm(int32_t sum_mV, int32_t sum_mA) {
    while (abs_i32(sum_mV) >= INT32_MAX / 1000) {
        sum_mV /= 2;
        sum_mA /= 2;
    }
    return sum_mA != 0 ? sum_mV * 1000 / sum_mA : 0;
}

bool current_loop_report(current_loop_t *self, int32_t supply_mV, current_loop_report_t *report) {
    const current_loop_window_t window = self->last;
    if (window.count == 0u) {
        return false;
    }
    self->last.count = 0;
    const int32_t count = (int32_t)window.count;
    const int32_t nominal = self->cfg.resistance_mohm;
    *report = (current_loop_report_t){.coil = CURRENT_LOOP_UNKNOWN};
    if (abs_i32(window.sum_mA / count) < self->cfg.full_scale_mA / LITTLE) {
        const bool is_pushed = abs_i32(window.sum_mV / count) >= supply_mV / 4;
        report->coil = is_pushed ? CURRENT_LOOP_OPEN : CURRENT_LOOP_UNKNOWN;
        return true;
    }
    report->resistance_mohm = ratio_mohm(window.sum_mV, window.sum_mA);
    const int32_t more_mohm =
        clamp_i32(report->resistance_mohm - nominal, -MOST_RISE_MOHM, MOST_RISE_MOHM);
    report->rise_degC = more_mohm * COPPER_DEGC / nominal;
    report->coil =
        report->resistance_mohm < nominal / 4 ? CURRENT_LOOP_SHORT : CURRENT_LOOP_FOLLOWS;
    return true;
}
