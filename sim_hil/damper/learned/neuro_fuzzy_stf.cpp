#include "neuro_fuzzy_stf.h"

namespace quiesce {

namespace {

InputBox box_of(const StfParams &p) {
    return InputBox({{InputKind::current, 0.0, p.current_scale_A},
                     {InputKind::displacement, -p.disp_scale_m, p.disp_scale_m},
                     {InputKind::velocity, -p.velocity_scale_m_s, p.velocity_scale_m_s}});
}

} // namespace

NeuroFuzzyStf::NeuroFuzzyStf(const StfParams &params, double stroke_m)
    : StaticDamper(box_of(params), stroke_m), params_(params) {}

double NeuroFuzzyStf::force_N(const DamperInput &input, const double * /*state*/,
                              double * /*rates*/) const {
    return quiesce_stf_N(&params_, input.current_A, input.position_m, input.velocity_m_s);
}

} // namespace quiesce
