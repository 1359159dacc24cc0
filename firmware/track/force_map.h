/// A damper's map: its resisting force over stroke velocity and current, and the way back, from a
/// velocity and a force to the current.
///
/// Words: magic, CRC-32 of what follows it, words in all; velocities n, currents m; n velocities in
/// um/s, rising, from below 0 to above it; m currents in mA, rising from 0; n x m forces in mN,
/// velocity by velocity. `quiesce identify inverse` writes them.
///
/// At a velocity above 0 no force is below that at a smaller current, at one below 0 none above it,
/// at 0 they are all the same. Forces between two velocities of one direction are interpolated;
/// beyond the first and the last velocity, and between 0 and the slowest one, those of that one
/// stand: the force of a damper that changes its direction jumps.
#ifndef FORCE_MAP_H
#define FORCE_MAP_H

#include "quiesce.h"

#define FORCE_MAP_MAGIC UINT32_C(0x31464D51)
#define FORCE_MAP_MIN_POINTS 2u ///< of either axis
#define FORCE_MAP_MAX_VELOCITIES 32u
#define FORCE_MAP_MAX_CURRENTS 16u

/// quiesce_force_map_check says SIZE, MAGIC, CRC; SHAPE: a number of points that is out of its
/// range or not that of the words; POINT: an axis that does not rise, or has too little or too much
/// on it, a force of 2^30 mN or more, or one that goes the wrong way with the current.

/// The least current, mA, whose force is the demand; 0 where the force is as large without any, the
/// largest of the map where that does not suffice. The demand (any but 0) has the velocity's sign,
/// or the velocity is 0 and the direction is the demand's.
///
/// The part of the way between two velocities is Q30, rounded down; forces are rounded to the
/// nearest mN, currents to the nearest mA; products are below 2^61. Bounded: some 420 instructions,
/// two 64-bit divisions among them.
int32_t force_map_current_mA(const uint32_t *words, int32_t velocity_um_s, int32_t demand_mN);

#endif
