// law_runs ORDER: the order is a file of little-endian words.
#include <stdio.h>
#include <stdlib.h>

#include "law_order.h"

static void say(const char *name, uint32_t value) {
    printf("%s 0x%08X\n", name, (unsigned)value);
}

static void call(void (*function)(void *context), void *context) {
    function(context);
}

// All of it in memory; NULL where it cannot be read or is too short.
static law_order_t *read_order(const char *path) {
    FILE *file = fopen(path, "rb");
    if (file == NULL || fseek(file, 0, SEEK_END) != 0) {
        return NULL;
    }
    const long bytes = ftell(file);
    law_order_t *order = bytes >= (long)sizeof *order ? malloc((size_t)bytes) : NULL;
    rewind(file);
    if (order != NULL && fread(order, 1, (size_t)bytes, file) != (size_t)bytes) {
        free(order);
        order = NULL;
    }
    (void)fclose(file);
    return order;
}

int main(int argc, char **argv) {
    static const law_door_t door = {say, call};
    law_order_t *order = argc == 2 ? read_order(argv[1]) : NULL;
    if (order == NULL) {
        fprintf(stderr, "law_runs: expected a file with an order\n");
        return 2;
    }
    const bool is_done = law_runs(order, &door);
    free(order);
    if (!is_done) {
        fprintf(stderr, "law_runs: the order is refused\n");
    }
    return is_done ? 0 : 1;
}
