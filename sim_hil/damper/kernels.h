/// Every damper model that is a kernel: its include and its line here add one.
#ifndef QUIESCE_KERNELS_H
#define QUIESCE_KERNELS_H

#include "kernels/kwok_tanh.h"
#include "kernels/normalised_bouc_wen.h"

#define QUIESCE_KERNELS(MODEL)                                                                     \
    MODEL(KwokTanh)                                                                                \
    MODEL(NormalisedBoucWen)

#endif
