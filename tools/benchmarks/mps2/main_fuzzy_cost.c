// The fuzzy engines, each evaluation bracketed for the instruction counter. Inputs come from a list
// for each: even steps over the universe, both sides of every cell's border, and values beyond the
// universe. On the reference controller every pair is taken, and the other engine's answer
// compared, outside the bracket; any other base comes as a table, with random choices from the
// lists.
#include "counted_call.h"
#include "fuzzy_reference.h"
#include "input_list.h"
#include "mailbox.h"
#include "print.h"

/// Even steps over the universe of an input of a table that is given.
#define GIVEN_STEPS 128u

/// What the run is to be; the emulator puts it where the mailbox is otherwise.
typedef struct {
    uint32_t variant;     ///< in the order of FUZZY_REFERENCES; VARIANTS: the table that follows
    uint32_t is_straight; ///< 0: the table engine is counted
    uint32_t steps;       ///< even steps over each universe; evaluations of a table that is given
    uint32_t universe[2]; ///< inputs go from 0 to this; [0] for all of a table that is given
    uint32_t words;       ///< of the table that follows
    uint32_t table[];
} order_t;

typedef struct {
    fuzzy_function_t straight;
    const uint32_t *table;
} variant_t;

#define VARIANT(name) {name, name##_table},
static const variant_t variants[] = {FUZZY_REFERENCES(VARIANT)};
#define VARIANTS (sizeof variants / sizeof variants[0])

/// The ends of every cell, and one beside.
static void add_borders(list_t *list, const fuzzy_table_t *table, uint32_t input) {
    const fuzzy_axis_t axis = table->axis[input];
    for (uint32_t i = 0; i < axis.cells; i++) {
        const fuzzy_cell_t *cell = fuzzy_at(table, axis.offset + i * axis.stride);
        list_add_around(list, cell->first);
        list_add_around(list, cell->last);
    }
}

typedef struct {
    uint32_t evaluations;
    uint32_t differing; ///< table and straight-line C did not give the same
    uint32_t defaults;
} tally_t;

static void evaluate_both(const order_t *order, const int32_t *input, tally_t *tally) {
    const variant_t *variant = &variants[order->variant];
    const fuzzy_table_t *table = (const fuzzy_table_t *)(const void *)variant->table;
    int32_t counted = 0, other = 0;
    uint32_t flags;
    if (order->is_straight != 0) {
        counted_call((counted_function_t)variant->straight, (uintptr_t)input, (uintptr_t)&counted,
                     0);
        flags = fuzzy_evaluate(table, input, &other);
    } else {
        counted_call((counted_function_t)fuzzy_evaluate, (uintptr_t)table, (uintptr_t)input,
                     (uintptr_t)&counted);
        flags = variant->straight(input, &other);
    }
    tally->evaluations++;
    tally->differing += counted != other ? 1u : 0u;
    tally->defaults += flags != 0 ? 1u : 0u;
}

static void walk(const order_t *order, const list_t *lists, tally_t *tally) {
    for (uint32_t i = 0; i < lists[0].count; i++) {
        for (uint32_t j = 0; j < lists[1].count; j++) {
            const int32_t input[2] = {lists[0].value[i], lists[1].value[j]};
            evaluate_both(order, input, tally);
        }
    }
}

static void add_all(list_t *list, const fuzzy_table_t *table, uint32_t input, uint32_t steps,
                    uint32_t universe) {
    list_add_even(list, steps, universe);
    add_borders(list, table, input);
    list_add_beyond(list, universe);
}

static void walk_given(const order_t *order, const fuzzy_table_t *table, const list_t *lists,
                       tally_t *tally) {
    uint32_t seed = 1;
    for (uint32_t i = 0; i < order->steps; i++) {
        int32_t input[FUZZY_MAX_INPUTS] = {0}, output[FUZZY_MAX_OUTPUTS] = {0};
        for (uint32_t k = 0; k < table->inputs; k++) {
            seed = seed * 1664525u + 1013904223u;
            input[k] = lists[k].value[(seed >> 12) % lists[k].count];
        }
        counted_call((counted_function_t)fuzzy_evaluate, (uintptr_t)table, (uintptr_t)input,
                     (uintptr_t)output);
        tally->evaluations++;
    }
}

/// False iff an order is no good.
static bool run(const order_t *order, list_t *lists, tally_t *tally) {
    const bool is_given = order->variant == VARIANTS;
    if (order->variant > VARIANTS || order->steps == 0) {
        return false;
    }
    const uint32_t *words = is_given ? order->table : variants[order->variant].table;
    const fuzzy_table_t *table = (const fuzzy_table_t *)(const void *)words;
    if (is_given && fuzzy_table_check(table, order->words) != FUZZY_TABLE_OK) {
        return false;
    }
    for (uint32_t input = 0; input < table->inputs; input++) {
        add_all(&lists[input], table, input, is_given ? GIVEN_STEPS : order->steps,
                order->universe[is_given ? 0 : input]);
        if (lists[input].count == LIST_MAX) {
            return false;
        }
    }
    if (is_given) {
        walk_given(order, table, lists, tally);
    } else {
        walk(order, lists, tally);
    }
    print("table_bytes", table->size_words * (uint32_t)sizeof(uint32_t));
    return true;
}

int main(void) {
    static list_t lists[FUZZY_MAX_INPUTS];
    tally_t tally = {0};

    counted_call_init();
    if (!run((const order_t *)MAILBOX_BASE, lists, &tally)) {
        print("refused", 1);
        return 1;
    }
    print("evaluations", tally.evaluations);
    print("differing", tally.differing);
    print("defaults", tally.defaults);
    print("stack_bytes", counted_call_stack_bytes());
    return counted_call_stack_bytes() < counted_call_stack_size_bytes() ? 0 : 1;
}
