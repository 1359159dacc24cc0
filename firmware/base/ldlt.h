/// Small symmetric positive definite systems, factored as L D L^T, a column a call.
///
/// Formats: matrix Q30, |entry| <= 1; L in Q24; right side and solution in any one unit, |value|
/// < 2^30. A column whose pivot falls below 2^-12 is linearly dependent on those before it: its
/// unknown is set to zero, and the rest is the solution without it. Accuracy about 10^-7 over the
/// smallest pivot. Bounded; a column of n costs about 25 n^2 / 3 instructions at most.
#ifndef LDLT_H
#define LDLT_H

#include "fixq.h"

#define LDLT_MAX 9

typedef struct {
    int32_t matrix[LDLT_MAX * (LDLT_MAX + 1) / 2]; ///< lower triangle by rows; becomes L
    int32_t right[LDLT_MAX];                       ///< right side; becomes the solution
    int32_t pivot_q30[LDLT_MAX];                   ///< D; 0 where the column was dropped
    uint32_t size;
    uint32_t next;  ///< column that is factored next
    int64_t energy; ///< solution times right side, in the square of their unit
} ldlt_t;

/// Index of row, column (row >= column) in matrix.
static inline uint32_t ldlt_index(uint32_t row, uint32_t column) {
    return row * (row + 1u) / 2u + column;
}

/// Starts over with a system of `size` unknowns; the caller then writes matrix and right.
void ldlt_start(ldlt_t *self, uint32_t size);

/// Factors one more column; after the last one the solution stands in `right`.
/// Returns true iff it does.
bool ldlt_step(ldlt_t *self);

#endif
