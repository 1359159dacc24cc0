// Defaults, checks and access by index of the parameters.
#include "quiesce.h"

#include <stddef.h>

#include "param_limits.h"

_Static_assert(sizeof(quiesce_params_t) == QUIESCE_PARAM_COUNT * sizeof(int32_t),
               "one int32_t a parameter, no padding");

#define INDEX_OF(name) ((uint32_t)(offsetof(quiesce_params_t, name) / sizeof(int32_t)))

// What the build holds of each choice, by value. Law off is in every one.
#define HOLDS_LAW(number, name) [QUIESCE_LAW_##number] = QUIESCE_WITH_LAW_##number,
#define HOLDS_TRACKER(number, name) [QUIESCE_TRACKER_##number] = QUIESCE_WITH_TRACKER_##number,
static const bool holds_law[] = {QUIESCE_EACH_LAW(HOLDS_LAW)};
static const bool holds_tracker[] = {QUIESCE_EACH_TRACKER(HOLDS_TRACKER)};
static const bool holds_estimator[] = {
    [QUIESCE_ESTIMATOR_FFT] = QUIESCE_WITH_FFT,
    [QUIESCE_ESTIMATOR_FIT] = QUIESCE_WITH_FIT,
};

// NOLINTNEXTLINE(bugprone-macro-parentheses): a term of a sum
#define ONE_TRACKER(number, name) +QUIESCE_WITH_TRACKER_##number
_Static_assert(QUIESCE_WITH_LAW_OFF, "law off is what a controller falls back to");
_Static_assert(0 QUIESCE_EACH_TRACKER(ONE_TRACKER) > 0, "the build holds no tracker");

// value, or where the build does not hold it the first one that it does.
static int32_t held(const bool *holds, int32_t count, int32_t value) {
    for (int32_t i = 0; i < count && !holds[value]; i++) {
        if (holds[i]) {
            return i;
        }
    }
    return value;
}

// The struct is an array of int32_t by construction (generated, asserted above).
static int32_t *slot(quiesce_params_t *params, uint32_t index) {
    return (int32_t *)(void *)params + index;
}

static int32_t value_of(const quiesce_params_t *params, uint32_t index) {
    return ((const int32_t *)(const void *)params)[index];
}

void quiesce_params_default(quiesce_params_t *params) {
    for (uint32_t i = 0; i < QUIESCE_PARAM_COUNT; i++) {
        *slot(params, i) = param_limits[i].default_value;
    }
    params->law = held(holds_law, QUIESCE_LAW_COUNT, params->law);
    params->tracker = held(holds_tracker, QUIESCE_TRACKER_COUNT, params->tracker);
    params->estimator = held(holds_estimator, 2, params->estimator);
}

bool quiesce_param_set(quiesce_params_t *params, uint32_t index, int32_t value) {
    if (index >= QUIESCE_PARAM_COUNT) {
        return false;
    }
    *slot(params, index) = value;
    return true;
}

bool quiesce_param_get(const quiesce_params_t *params, uint32_t index, int32_t *value) {
    if (index >= QUIESCE_PARAM_COUNT) {
        return false;
    }
    *value = value_of(params, index);
    return true;
}

static bool is_choice(uint32_t index, int32_t value) {
    bool is_free = true;
    for (uint32_t i = 0; i < param_choice_count; i++) {
        if (param_choices[i].index == index) {
            if (param_choices[i].value == value) {
                return true;
            }
            is_free = false;
        }
    }
    return is_free;
}

static bool is_in_range(uint32_t index, int32_t value) {
    return value >= param_limits[index].min && value <= param_limits[index].max;
}

bool quiesce_param_allows(uint32_t index, int32_t value) {
    return index < QUIESCE_PARAM_COUNT && is_in_range(index, value) && is_choice(index, value);
}

static bool refuse(quiesce_param_error_t *error, uint32_t index, const char *reason) {
    if (error != NULL) {
        *error = (quiesce_param_error_t){index, reason};
    }
    return false;
}

int32_t quiesce_params_safe_current_mA(const quiesce_params_t *params) {
    const bool is_usable = is_in_range(INDEX_OF(safe_current_mA), params->safe_current_mA) &&
                           is_in_range(INDEX_OF(max_current_mA), params->max_current_mA) &&
                           params->safe_current_mA <= params->max_current_mA;
    return is_usable ? params->safe_current_mA : 0;
}

static bool check_each(const quiesce_params_t *params, quiesce_param_error_t *error) {
    for (uint32_t i = 0; i < QUIESCE_PARAM_COUNT; i++) {
        if (!is_in_range(i, value_of(params, i))) {
            return refuse(error, i, "out of range");
        }
    }
    for (uint32_t i = 0; i < param_choice_count; i++) {
        const uint32_t index = param_choices[i].index;
        if (!is_choice(index, value_of(params, index))) {
            return refuse(error, index, "not one of the allowed values");
        }
    }
    return true;
}

// Conditioned accelerations saturate there (sense/condition.h).
#define MOST_ACCEL_um_s2 INT64_C(500000000)

static bool check_sensor(const quiesce_params_t *params, quiesce_param_error_t *error) {
    const int64_t full_scale_nm_s2 =
        (int64_t)params->accel_scale_nm_s2 * params->accel_full_scale_counts;
    if (full_scale_nm_s2 > 1000 * MOST_ACCEL_um_s2) {
        return refuse(error, INDEX_OF(accel_scale_nm_s2),
                      "full scale is beyond 500 m/s2, where accelerations saturate");
    }
    if (params->sensor_stuck_ticks == 1) {
        return refuse(error, INDEX_OF(sensor_stuck_ticks),
                      "every sample would be a fault; 0 or from 2 on");
    }
    return true;
}

static bool check_build(const quiesce_params_t *params, quiesce_param_error_t *error) {
    static const char *const reason = "not in this build";
    if (!holds_law[params->law]) {
        return refuse(error, INDEX_OF(law), reason);
    }
    if (!holds_tracker[params->tracker]) {
        return refuse(error, INDEX_OF(tracker), reason);
    }
    if (!holds_estimator[params->estimator]) {
        return refuse(error, INDEX_OF(estimator), reason);
    }
    return true;
}

static bool check_together(const quiesce_params_t *params, quiesce_param_error_t *error) {
    if (params->band_low_mHz >= params->band_high_mHz) {
        return refuse(error, INDEX_OF(band_high_mHz), "must be above band_low_mHz");
    }
    if (params->narrow_high_mHz != 0 && params->narrow_low_mHz >= params->narrow_high_mHz) {
        return refuse(error, INDEX_OF(narrow_high_mHz), "must be above narrow_low_mHz, or 0");
    }
    if (params->constant_current_mA > params->max_current_mA) {
        return refuse(error, INDEX_OF(constant_current_mA), "above max_current_mA");
    }
    if (params->safe_current_mA > params->max_current_mA) {
        return refuse(error, INDEX_OF(safe_current_mA), "above max_current_mA");
    }
    if (params->unlock_current_mA > params->max_current_mA) {
        return refuse(error, INDEX_OF(unlock_current_mA), "above max_current_mA");
    }
    if (params->current_check == QUIESCE_CURRENT_CHECK_ON &&
        params->current_error_mA > params->max_current_mA / 2) {
        return refuse(error, INDEX_OF(current_error_mA),
                      "above half of max_current_mA, an open coil would go unseen");
    }
    return true;
}

bool quiesce_params_differ_live(const quiesce_params_t *a, const quiesce_params_t *b,
                                uint32_t *index) {
    for (uint32_t i = 0; i < QUIESCE_PARAM_COUNT; i++) {
        int32_t value_a = 0;
        int32_t value_b = 0;
        (void)quiesce_param_get(a, i, &value_a);
        (void)quiesce_param_get(b, i, &value_b);
        if (value_a != value_b && (param_live[i / 32u] >> (i % 32u) & 1u) == 0) {
            if (index != NULL) {
                *index = i;
            }
            return false;
        }
    }
    return true;
}

bool quiesce_params_check(const quiesce_params_t *params, quiesce_param_error_t *error) {
    return check_each(params, error) && check_build(params, error) && check_sensor(params, error) &&
           check_together(params, error);
}
