/// One rig after the other, and what was broken first.
#ifndef LIVES_H
#define LIVES_H

#include "rules.h"
#include "storm.h"

#ifndef ABUSE_NODE
#define ABUSE_NODE 0 ///< 1: some lives are those of a whole node
#endif

typedef struct {
    rig_t rig;
    rules_t rules;
    uint64_t number;
    char first[160]; ///< what was broken first, in words
} life_t;

/// A tick of it.
void life_judge(life_t *self, const quiesce_in_t *in, const quiesce_out_t *out);

/// A life of a whole node, with messages between the ticks: good ones, damaged ones, requests for
/// other parameters.
void node_live(life_t *self, dice_t *dice);

#endif
