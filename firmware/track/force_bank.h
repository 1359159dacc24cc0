/// A bank of models of a damper at constant currents, with memory: its forces at all of them along
/// one motion, and the way back, from a force to the current between two of them.
///
/// All models share elements, states that follow the stroke's velocity v, tick by tick:
///
///     z <- clip(z + v - leak z, -limit, limit)          force_k = offset_k + spring_k x + sum w_k
///     z
///
/// A spring with a dashpot in series (leak) and a slider (limit): with leak 0 a stop, whose force
/// is that of dry friction behind a spring; with leak 1 a saturation of the velocity; with a limit
/// that is never reached a Maxwell element. None of them gives more energy than it was given, and
/// weights are not negative: at a constant current a model is passive, but for its spring and
/// offset. An element that leads follows v + clip(g x, -lead, lead) in place of v: a loop's branch
/// changes before the motion turns.
///
/// Words: after the head of all tables a number of sections, 1 .. QUIESCE_MAX_DAMPERS; a section
/// for each damper from the first on, or one that is of all dampers there are. A section: elements
/// n, currents k, ticks a second that it is made for, shift of the weights, g in um/s for a nm,
/// Q20, lead in um/s; n elements {1 where it leads, leak Q30, limit in um/s}; k models {current in
/// mA, offset in mN, spring in mN for a nm, n weights in mN for a um/s}, spring and weights in
/// units of 2^-shift; currents rise from 0. `quiesce identify inverse --method bank` writes them.
///
/// A stroke is needed where a spring or a lead is, its velocity always.
#ifndef FORCE_BANK_H
#define FORCE_BANK_H

#include "quiesce.h"
#include "view.h"

#define FORCE_BANK_MAGIC UINT32_C(0x314B4251)
#define FORCE_BANK_MAX_ELEMENTS 8u
#define FORCE_BANK_MIN_CURRENTS 2u
#define FORCE_BANK_MAX_CURRENTS 8u
#define FORCE_BANK_MAX_SHIFT 40u

/// Of one damper; zeros: at rest.
typedef struct {
    int32_t z[FORCE_BANK_MAX_ELEMENTS]; ///< um/s, below its element's limit
} force_bank_t;

/// Of words with a good head. SHAPE: numbers of sections, elements or currents; POINT: a leak above
/// 1, a limit, force or current that is out of its range, a negative weight, currents that do not
/// rise, or weights with which a sum could reach 2^62.
quiesce_table_verdict_t force_bank_check(const uint32_t *words);

/// VIEW_ bits that checked words need.
uint64_t force_bank_needs(const uint32_t *words);

/// Ticks a second that checked words are made for; 0 where their sections differ.
uint32_t force_bank_rate_Hz(const uint32_t *words);

/// The section of this damper in checked words. NULL: it has none.
const uint32_t *force_bank_section(const uint32_t *words, uint32_t damper);

/// One tick on. Leaks are rounded to the nearest um/s, half up; nothing overflows. About 20
/// instructions an element.
void force_bank_move(force_bank_t *self, const uint32_t *section, const view_damper_t *damper);

/// Models of a section of checked words.
uint32_t force_bank_currents(const uint32_t *section);

/// Force of model k, rounded to the nearest mN, half up, and limited to VIEW_LIMIT.
int32_t force_bank_force_mN(const force_bank_t *self, const uint32_t *section, uint32_t k,
                            const view_damper_t *damper);

/// The least current, mA, whose force, between those of two models, is the demand; 0 where the
/// force without current is enough; else that of the model with the largest force in the demand's
/// direction, the first of them, 0 where no model has a force in that direction. To the nearest
/// mA. A model costs some 6 instructions an element, at worst all of them are asked; one 64-bit
/// division.
int32_t force_bank_current_mA(const force_bank_t *self, const uint32_t *section,
                              const view_damper_t *damper, int32_t demand_mN);

#endif
