#include "law.h"

#include <stddef.h>

static const law_t *const laws[] = {
    [QUIESCE_LAW_OFF] = &law_off,     [QUIESCE_LAW_CONSTANT] = &law_constant,
    [QUIESCE_LAW_FUZZY] = &law_fuzzy, [QUIESCE_LAW_FUZZY_SELFTUNE] = &law_fuzzy_selftune,
    [QUIESCE_LAW_PHASE] = &law_phase,
};

const law_t *law_find(int32_t index) {
    const int32_t count = (int32_t)(sizeof laws / sizeof laws[0]);
    return index >= 0 && index < count ? laws[index] : NULL;
}
