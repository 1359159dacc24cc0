/// One period of the cosine: cosine_q25[i] = cos(2 pi i / 256) x (2^25 - 1), rounded to nearest.
/// sin(2 pi i / 256) = cosine_q25[(i - 64) & 255]. Halves and quarters mirror exactly, so that sums
/// over whole periods are exactly zero.
#ifndef COSINE_TABLE_H
#define COSINE_TABLE_H

#include <stdint.h>

#define COSINE_POINTS 256

extern const int32_t cosine_q25[COSINE_POINTS];

/// The first quarter of the same with 2^30 for one, its end included.
extern const int32_t cosine_quarter_q30[COSINE_POINTS / 4 + 1];

#endif
