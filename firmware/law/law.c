#include "law.h"

#include <stddef.h>

#define DECLARE(number, name) extern const law_t law_##name;
#define ENTRY(number, name) [QUIESCE_LAW_##number] = &law_##name,

QUIESCE_EACH_LAW(DECLARE)

static const law_t *const laws[] = {QUIESCE_EACH_LAW(ENTRY)};

const law_t *law_find(int32_t index) {
    const int32_t count = (int32_t)(sizeof laws / sizeof laws[0]);
    return index >= 0 && index < count ? laws[index] : NULL;
}
