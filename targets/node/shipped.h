/// Tables that are linked into an image (QUIESCE_TABLES): they take the place of those that ship.
#ifndef SHIPPED_H
#define SHIPPED_H

#include <stdint.h>

/// Whole files (table_file.h); NULL after the last. table_words.cmake makes them.
extern const uint32_t *const shipped_tables[];

#endif
