#include "law.h"

#include <stddef.h>

#define DECLARE(number, name) extern const law_t law_##name;
#define ENTRY(number, name) [QUIESCE_LAW_##number] = QUIESCE_WITH_LAW_##number ? &law_##name : NULL,

QUIESCE_EACH_LAW(DECLARE)

static const law_t *const laws[QUIESCE_LAW_COUNT] = {QUIESCE_EACH_LAW(ENTRY)};

const law_t *law_find(int32_t index) {
    return index >= 0 && index < QUIESCE_LAW_COUNT ? laws[index] : NULL;
}
