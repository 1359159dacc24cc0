/// Every damper model that is a kernel: its include and its line here add one.
#ifndef QUIESCE_KERNELS_H
#define QUIESCE_KERNELS_H

#include "kernels/bouc_wen.h"
#include "kernels/choi_polynomial.h"
#include "kernels/kwok_bouc_wen.h"
#include "kernels/kwok_tanh.h"
#include "kernels/modified_bouc_wen.h"
#include "kernels/modified_dahl.h"
#include "kernels/normalised_bouc_wen.h"
#include "kernels/second_order_polynomial.h"
#include "kernels/viscous_dahl.h"

#define QUIESCE_KERNELS(MODEL)                                                                     \
    MODEL(BoucWen)                                                                                 \
    MODEL(ChoiPolynomial)                                                                          \
    MODEL(KwokBoucWen)                                                                             \
    MODEL(KwokTanh)                                                                                \
    MODEL(ModifiedBoucWen)                                                                         \
    MODEL(ModifiedDahl)                                                                            \
    MODEL(NormalisedBoucWen)                                                                       \
    MODEL(SecondOrderPolynomial)                                                                   \
    MODEL(ViscousDahl)

#endif
