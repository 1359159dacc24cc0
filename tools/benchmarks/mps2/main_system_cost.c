// The engine for any fuzzy system, each evaluation bracketed for the instruction counter: of a
// table that is given, at random inputs over its universes.
#include "counted_call.h"
#include "fuzzy_system.h"
#include "mailbox.h"
#include "print.h"

/// What the run is to be; the emulator puts it where the mailbox is otherwise.
typedef struct {
    uint32_t evaluations;
    uint32_t words; ///< of the table that follows
    uint32_t table[];
} order_t;

static int32_t drawn(const fuzzy_system_input_t *one, uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    const uint64_t steps = (uint64_t)((int64_t)one->most - one->least) + 1u;
    return (int32_t)(one->least + (int64_t)(((*seed >> 8) * steps) >> 24));
}

static void walk(const order_t *order, const fuzzy_system_t *table) {
    const fuzzy_system_input_t *inputs =
        (const fuzzy_system_input_t *)(const void *)(order->table + table->inputs_offset);
    uint32_t seed = 1;
    for (uint32_t i = 0; i < order->evaluations; i++) {
        int32_t input[FUZZY_SYSTEM_MAX_INPUTS] = {0}, output[FUZZY_MAX_OUTPUTS] = {0};
        for (uint32_t k = 0; k < table->inputs; k++) {
            input[k] = drawn(&inputs[k], &seed);
        }
        counted_call((counted_function_t)fuzzy_system_evaluate, (uintptr_t)table, (uintptr_t)input,
                     (uintptr_t)output);
    }
}

int main(void) {
    const order_t *order = (const order_t *)MAILBOX_BASE;
    const fuzzy_system_t *table = (const fuzzy_system_t *)(const void *)order->table;

    counted_call_init();
    if (order->evaluations == 0 || fuzzy_system_check(table, order->words) != FUZZY_TABLE_OK) {
        print("refused", 1);
        return 1;
    }
    walk(order, table);
    print("stack_bytes", counted_call_stack_bytes());
    return counted_call_stack_bytes() < counted_call_stack_size_bytes() ? 0 : 1;
}
