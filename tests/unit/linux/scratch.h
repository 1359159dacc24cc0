/// A folder for the files of one test, removed with all that is in it.
#ifndef SCRATCH_H
#define SCRATCH_H

#include <stdbool.h>
#include <stddef.h>

#define SCRATCH_BYTES 256

/// Makes it; for setUp. Fails the test where that cannot be.
void scratch_make(void);
/// Removes it; for tearDown.
void scratch_remove(void);

/// Path in it, in one of a few buffers that take turns.
const char *scratch_path(const char *name);

/// Makes a folder in it, and those above.
void scratch_folder(const char *name);

/// Makes a file with a text, or replaces it.
void scratch_write(const char *name, const char *text);
void scratch_write_bytes(const char *name, const void *bytes, size_t count);

/// First line of a file, in one of a few buffers that take turns.
const char *scratch_read(const char *name);

bool scratch_has(const char *name);

#endif
