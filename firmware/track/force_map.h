/// Dampers' maps: the resisting force over motion and current, and the way back, from a motion and
/// a force to the current.
///
/// Words: magic, CRC-32 of what follows it, words in all, sections; then a section for each damper,
/// from the first on, or one that stands for every damper (sections.h). A section: axis, places n,
/// currents m; n places of the axis, rising, from below 0 to above it; m currents in mA, rising
/// from 0; n x m forces in mN, place by place. `quiesce identify inverse` writes them.
///
/// The axis is what the force has the sign of: QUIESCE_SENSE_STROKE_VELOCITY, um/s, of what damps;
/// QUIESCE_SENSE_STROKE, nm, of a spring that the current stiffens.
///
/// At a place above 0 no force is below that at a smaller current, at one below 0 none above it, at
/// 0 they are all the same. Forces between two places of one side are interpolated; beyond the
/// first and the last place, and between 0 and the smallest one, those of that one stand: the force
/// of a damper that changes its direction jumps.
#ifndef FORCE_MAP_H
#define FORCE_MAP_H

#include "quiesce.h"
#include "view.h"

#define FORCE_MAP_MAGIC UINT32_C(0x32464D51)
#define FORCE_MAP_MIN_POINTS 2u ///< of either axis
#define FORCE_MAP_MAX_PLACES 32u
#define FORCE_MAP_MAX_CURRENTS 16u

/// Of words with a good head. SHAPE: no section or one too many, a number of points that is out of
/// its range or not that of the words; POINT: an axis that there is not, does not rise, or has too
/// little or too much on it, a force of 2^30 mN or more, or one that goes the wrong way with the
/// current.
quiesce_table_verdict_t force_map_check(const uint32_t *words);

/// Of good words: the section of this damper. NULL iff they have several and none for it.
const uint32_t *force_map_section(const uint32_t *words, uint32_t damper);

/// VIEW_ bits that good words need: their axes, and each damper of several sections.
uint64_t force_map_needs(const uint32_t *words);

/// Where the damper is on the section's axis.
int32_t force_map_place(const uint32_t *section, const view_damper_t *damper);

/// The least current, mA, whose force is the demand; 0 where the force is as large without any, the
/// largest of the section where that does not suffice. The demand (any but 0) has the place's sign,
/// or the place is 0 and the direction is the demand's.
///
/// The part of the way between two places is Q30, rounded down; forces are rounded to the nearest
/// mN, currents to the nearest mA; products are below 2^61. Bounded: some 420 instructions, two
/// 64-bit divisions among them.
int32_t force_map_current_mA(const uint32_t *section, int32_t place, int32_t demand_mN);

#endif
