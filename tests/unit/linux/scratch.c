#include "scratch.h"

#include "unity.h"

#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define BUFFERS 8u

static char root[SCRATCH_BYTES];

static char *next_buffer(void) {
    static char buffers[BUFFERS][SCRATCH_BYTES];
    static unsigned int next;
    next = (next + 1u) % BUFFERS;
    return buffers[next];
}

void scratch_make(void) {
    const char *const folder = getenv("TMPDIR");
    (void)snprintf(root, sizeof root, "%s/quiesce-XXXXXX", folder != NULL ? folder : P_tmpdir);
    TEST_ASSERT_NOT_NULL(mkdtemp(root));
}

static int remove_entry(const char *path, const struct stat *status, int kind, struct FTW *place) {
    (void)status;
    (void)kind;
    (void)place;
    return remove(path);
}

void scratch_remove(void) {
    TEST_ASSERT_EQUAL_INT(0, nftw(root, remove_entry, 8, FTW_DEPTH | FTW_PHYS));
}

const char *scratch_path(const char *name) {
    char *const path = next_buffer();
    const int bytes = snprintf(path, SCRATCH_BYTES, "%s/%s", root, name);
    TEST_ASSERT_TRUE(bytes > 0 && bytes < SCRATCH_BYTES);
    return path;
}

void scratch_folder(const char *name) {
    char path[SCRATCH_BYTES];
    (void)snprintf(path, sizeof path, "%s", scratch_path(name));
    for (char *slash = strchr(path + 1, '/'); slash != NULL; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        TEST_ASSERT_TRUE(mkdir(path, 0755) == 0 || errno == EEXIST);
        *slash = '/';
    }
    TEST_ASSERT_TRUE(mkdir(path, 0755) == 0 || errno == EEXIST);
}

void scratch_write_bytes(const char *name, const void *bytes, size_t count) {
    FILE *const file = fopen(scratch_path(name), "we");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, name);
    TEST_ASSERT_EQUAL_size_t(count, fwrite(bytes, 1, count, file));
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
}

void scratch_write(const char *name, const char *text) {
    scratch_write_bytes(name, text, strlen(text));
}

const char *scratch_read(const char *name) {
    char *const text = next_buffer();
    FILE *const file = fopen(scratch_path(name), "re");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, name);
    const size_t bytes = fread(text, 1, SCRATCH_BYTES - 1, file);
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
    text[bytes] = '\0';
    text[strcspn(text, "\n")] = '\0';
    return text;
}

bool scratch_has(const char *name) {
    return access(scratch_path(name), F_OK) == 0;
}
