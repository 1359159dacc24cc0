/// The cases of the guarding blocks, a group each.
#ifndef PART_CASES_H
#define PART_CASES_H

void part_current_cases(void); ///< guard, current monitor, coil, energy, heat, drive
void part_stop_cases(void);    ///< supervisor, twin
void part_frame_cases(void);   ///< e2e, freshness, what is received

#endif
