#include "law_state.h"

#include <stddef.h>

void law_state_init(law_state_t *state, const quiesce_params_t *params, const uint32_t *table) {
    *state = (law_state_t){0};
    for (int32_t i = 0; law_find(i) != NULL; i++) {
        const law_t *law = law_find(i);
        if (law->init != NULL) {
            law->init(state, params, table);
        }
    }
}
