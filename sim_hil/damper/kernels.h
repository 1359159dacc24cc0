/// Every damper model that is a kernel: its include and its line here add one.
#ifndef QUIESCE_KERNELS_H
#define QUIESCE_KERNELS_H

#include "kernels/arctangent.h"
#include "kernels/bingham.h"
#include "kernels/bouc_wen.h"
#include "kernels/choi_polynomial.h"
#include "kernels/extended_tanh_bingham.h"
#include "kernels/fractional_bingham.h"
#include "kernels/gamota_filisko.h"
#include "kernels/hysteretic_biviscous.h"
#include "kernels/kwok_bouc_wen.h"
#include "kernels/kwok_tanh.h"
#include "kernels/magic_formula.h"
#include "kernels/modified_bouc_wen.h"
#include "kernels/modified_dahl.h"
#include "kernels/nonlinear_bingham_hysteretic.h"
#include "kernels/nonlinear_biviscous.h"
#include "kernels/normalised_bouc_wen.h"
#include "kernels/second_order_polynomial.h"
#include "kernels/squeeze_film.h"
#include "kernels/viscoplastic_network.h"
#include "kernels/viscous_dahl.h"
#include "kernels/zhang_tanh.h"

#define QUIESCE_KERNELS(MODEL)                                                                     \
    MODEL(Arctangent)                                                                              \
    MODEL(Bingham)                                                                                 \
    MODEL(BoucWen)                                                                                 \
    MODEL(ChoiPolynomial)                                                                          \
    MODEL(ExtendedTanhBingham)                                                                     \
    MODEL(FractionalBingham)                                                                       \
    MODEL(GamotaFilisko)                                                                           \
    MODEL(HystereticBiviscous)                                                                     \
    MODEL(KwokBoucWen)                                                                             \
    MODEL(KwokTanh)                                                                                \
    MODEL(MagicFormula)                                                                            \
    MODEL(ModifiedBoucWen)                                                                         \
    MODEL(ModifiedDahl)                                                                            \
    MODEL(NonlinearBinghamHysteretic)                                                              \
    MODEL(NonlinearBiviscous)                                                                      \
    MODEL(NormalisedBoucWen)                                                                       \
    MODEL(SecondOrderPolynomial)                                                                   \
    MODEL(SqueezeFilm)                                                                             \
    MODEL(ViscoplasticNetwork1)                                                                    \
    MODEL(ViscoplasticNetwork2)                                                                    \
    MODEL(ViscoplasticNetwork3)                                                                    \
    MODEL(ViscoplasticNetwork4)                                                                    \
    MODEL(ViscousDahl)                                                                             \
    MODEL(ZhangTanh)

#endif
