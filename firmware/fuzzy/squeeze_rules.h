/// Rule base of the squeeze-mode paper (Lin, Yau, Lee, Tung; Tables VII and VIII are lost from the
/// text and were found again on the plant of docs/plant.md: the current of least RMS acceleration
/// is 0 A at 5 Hz and 5 A at 10, 15 and 20 Hz, at every drive voltage). Rows: frequency in uHz,
/// sets S M H VH; columns: RMS acceleration in um/s2, the same names.
#ifndef SQUEEZE_RULES_H
#define SQUEEZE_RULES_H

#include "fuzzy.h"

extern const fuzzy_table_t squeeze_rules;

#endif
