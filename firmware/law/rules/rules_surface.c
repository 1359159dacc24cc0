#include "quiesce_rules.h"

#include <stddef.h>

#include "rule_base.h"

int32_t quiesce_rules_current_mA(const uint32_t *table, int32_t freq_uHz, int32_t rms_um_s2,
                                 uint32_t *rules_fired) {
    const law_setup_t setup = {.table = table != NULL ? table : rule_base_kind.shipped};
    const view_tone_t tone = {.freq_uHz = freq_uHz, .rms_um_s2 = rms_um_s2};
    rule_base_t rules = {0};
    const int32_t current_mA = rule_base_step(&rules, setup.table, &tone);
    if (rules_fired != NULL) {
        int32_t word[QUIESCE_REPORT_WORDS];
        rule_base_report(&rules, &setup, word);
        *rules_fired = (uint32_t)word[1];
    }
    return current_mA;
}
