// Straight-line C of fuzzy systems, each evaluation bracketed for the instruction counter: every
// pair of inputs from two lists, which hold even steps over the universe, both sides of every
// stretch's border, and values beyond the universe.
#include "counted_call.h"
#include "input_list.h"
#include "mailbox.h"
#include "print.h"
#include "straight_systems.h"

/// What the run is to be; the emulator puts it where the mailbox is otherwise.
typedef struct {
    uint32_t function;    ///< in the order of STRAIGHT_SYSTEMS
    uint32_t steps;       ///< even steps over each universe
    uint32_t universe[2]; ///< inputs go from 0 to this
    uint32_t borders[2];  ///< of each input; they follow
    int32_t border[];
} order_t;

typedef uint32_t (*function_t)(const int32_t *input, int32_t *output);

#define FUNCTION(name) name,
static const function_t functions[] = {STRAIGHT_SYSTEMS(FUNCTION)};
#define FUNCTIONS (sizeof functions / sizeof functions[0])

/// False iff there are too many.
static bool fill(list_t *list, const order_t *order, uint32_t input) {
    const int32_t *border = &order->border[input == 0 ? 0 : order->borders[0]];
    list_add_even(list, order->steps, order->universe[input]);
    for (uint32_t i = 0; i < order->borders[input]; i++) {
        list_add_around(list, border[i]);
    }
    list_add_beyond(list, order->universe[input]);
    return list->count < LIST_MAX;
}

/// Prints a sum of the answers, each times an odd number of its own: those of another machine have
/// the same.
static void walk(function_t function, const list_t *lists) {
    uint32_t sum = 0, evaluations = 0;
    for (uint32_t i = 0; i < lists[0].count; i++) {
        for (uint32_t j = 0; j < lists[1].count; j++) {
            const int32_t input[2] = {lists[0].value[i], lists[1].value[j]};
            int32_t output = 0;
            counted_call((counted_function_t)function, (uintptr_t)input, (uintptr_t)&output, 0);
            sum += (uint32_t)output * (2u * evaluations++ + 1u);
        }
    }
    print("evaluations", evaluations);
    print("sum", sum);
}

int main(void) {
    static list_t lists[2];
    const order_t *order = (const order_t *)MAILBOX_BASE;

    counted_call_init();
    if (order->function >= FUNCTIONS || order->steps == 0 || !fill(&lists[0], order, 0) ||
        !fill(&lists[1], order, 1)) {
        print("refused", 1);
        return 1;
    }
    walk(functions[order->function], lists);
    print("stack_bytes", counted_call_stack_bytes());
    return counted_call_stack_bytes() < counted_call_stack_size_bytes() ? 0 : 1;
}
