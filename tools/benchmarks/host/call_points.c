/// Our engine as the instruction counter on the host sees it: a function of a shared library,
/// called with given points.
///
///   call_points LIBRARY FUNCTION POINTS EVALUATIONS
///
/// FUNCTION: uint32_t f(const int32_t *input, int32_t *output). POINTS: int32 as the machine has
/// them, rows of two inputs. EVALUATIONS: only so many of them; the rest of the work stays the
/// same.
#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define INPUTS 2u
#define OUTPUTS_MAX 4u
#define POINTS_MAX 65536u

typedef uint32_t (*engine_t)(const int32_t *input, int32_t *output);

static int32_t points[POINTS_MAX][INPUTS];

static engine_t find(const char *library, const char *function) {
    void *handle = dlopen(library, RTLD_NOW);
    void *symbol = handle != NULL ? dlsym(handle, function) : NULL;
    engine_t engine = NULL;
    if (symbol == NULL) {
        (void)fprintf(stderr, "call_points: %s\n", dlerror());
        return NULL;
    }
    memcpy(&engine, &symbol, sizeof engine); // ISO C has no cast from object to function
    return engine;
}

static size_t read_points(const char *path) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        (void)fprintf(stderr, "call_points: %s: cannot be read\n", path);
        return 0;
    }
    const size_t count = fread(points, sizeof points[0], POINTS_MAX, file);
    (void)fclose(file);
    return count;
}

int main(int argc, char **argv) {
    if (argc != 5) {
        (void)fprintf(stderr, "usage: call_points LIBRARY FUNCTION POINTS EVALUATIONS\n");
        return 2;
    }
    const engine_t engine = find(argv[1], argv[2]);
    const size_t count = read_points(argv[3]);
    const size_t wanted = strtoul(argv[4], NULL, 10);
    if (engine == NULL || count == 0 || wanted > count) {
        return 2;
    }
    uint32_t sum = 0;
    for (size_t i = 0; i < wanted; i++) {
        int32_t output[OUTPUTS_MAX] = {0};
        sum += engine(points[i], output) + (uint32_t)output[0];
    }
    (void)printf("%u\n", (unsigned)sum);
    return 0;
}
