// Python module quiesce_dampers: damper models over recorded motions. All calls that compute let
// other Python threads run. Python's side is quiesce.damper.library; this is the whole contract.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "damper_over_motion.h"
#include "damper_section.h"
#include "equations.h"
#include "evaluator.h"
#include "field_law.h"
#include "input_error.h"
#include "kernel_models.h"

namespace nb = nanobind;

namespace quiesce {

namespace {

using Row = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Out1 = nb::ndarray<nb::numpy, double, nb::ndim<1>>;
using Out2 = nb::ndarray<nb::numpy, double, nb::ndim<2>>;

[[noreturn]] void refuse(const std::string &message) {
    throw nb::value_error(message.c_str());
}

/// A motion whose grids for different steps are made once.
class RecordedMotion {
  public:
    RecordedMotion(double rate_Hz, const Row &disp_m, const Row &velocity_m_s,
                   const Row &accel_m_s2, const Row &command)
        : count_(disp_m.shape(0)), step_s_(1.0 / rate_Hz), disp_m_(copy(disp_m)),
          velocity_m_s_(copy(velocity_m_s)), accel_m_s2_(copy(accel_m_s2)),
          command_(copy(command)) {
        if (count_ < 2 || velocity_m_s_.size() != count_ || accel_m_s2_.size() != count_ ||
            command_.size() != count_ || !(rate_Hz > 0.0)) {
            refuse("a motion needs a rate > 0 and four arrays of one length, 2 samples or more");
        }
    }

    std::size_t count() const { return count_; }

    /// Made at the first call for this many steps; coarse ones are kept.
    std::shared_ptr<const MotionGrid> grid(int substeps) const {
        if (substeps < 1 || substeps > 10000) {
            refuse("substeps must be 1 .. 10000");
        }
        const std::scoped_lock held(lock_);
        const auto known = grids_.find(substeps);
        if (known != grids_.end()) {
            return known->second;
        }
        const MotionSamples samples{
            count_,         step_s_, disp_m_.data(), velocity_m_s_.data(), accel_m_s2_.data(),
            command_.data()};
        auto made = std::make_shared<const MotionGrid>(samples, substeps);
        if (substeps <= kMostKept) {
            grids_[substeps] = made;
        }
        return made;
    }

  private:
    static constexpr int kMostKept = 16;

    static std::vector<double> copy(const Row &values) {
        return {values.data(), values.data() + values.shape(0)};
    }

    std::size_t count_;
    double step_s_;
    std::vector<double> disp_m_;
    std::vector<double> velocity_m_s_;
    std::vector<double> accel_m_s2_;
    std::vector<double> command_;
    mutable std::mutex lock_;
    mutable std::map<int, std::shared_ptr<const MotionGrid>> grids_;
};

std::size_t model_index(const std::string &name) {
    const std::vector<KernelModel> &models = kernel_models();
    for (std::size_t k = 0; k < models.size(); ++k) {
        if (name == models[k].name) {
            return k;
        }
    }
    refuse("no damper model '" + name + "'");
}

CandidateRows candidates_of(const std::string &model, const std::vector<int> &orders,
                            const Rows &rows) {
    const std::size_t index = model_index(model);
    if (orders.size() != kernel_models()[index].parameter_count) {
        refuse("orders: one entry a parameter of the model");
    }
    for (const int order : orders) {
        if (order < 1 || order > kMaxCoefficients) {
            refuse("orders: 1, 2 or 3 coefficients");
        }
    }
    if (rows.shape(1) != row_length(index, orders.data())) {
        refuse("rows: " + std::to_string(row_length(index, orders.data())) +
               " columns expected, found " + std::to_string(rows.shape(1)));
    }
    return {index, orders.data(), rows.data(), rows.shape(0)};
}

std::string set_or_best(const std::string &set, const CandidateRows &candidates) {
    return set.empty() ? set_for(candidates.count) : set;
}

/// Fresh memory that Python owns.
template <class Out>
Out owned(std::unique_ptr<double[]> data, std::initializer_list<std::size_t> shape) {
    double *raw = data.release();
    const nb::capsule owner(raw,
                            [](void *memory) noexcept { delete[] static_cast<double *>(memory); });
    return Out(raw, shape, owner);
}

Out2 simulate_rows(const std::string &model, const std::vector<int> &orders, const Rows &rows,
                   const RecordedMotion &motion, int substeps, const std::string &set) {
    const CandidateRows candidates = candidates_of(model, orders, rows);
    auto out = std::make_unique<double[]>(candidates.count * motion.count());
    {
        const nb::gil_scoped_release released;
        simulate(candidates, *motion.grid(substeps), set_or_best(set, candidates), out.get());
    }
    return owned<Out2>(std::move(out), {candidates.count, motion.count()});
}

// What Python passes by name.
// NOLINTNEXTLINE(readability-function-size)
Out1 error_of_rows(const std::string &model, const std::vector<int> &orders, const Rows &rows,
                   const RecordedMotion &motion, int substeps, const Row &force_N,
                   const Row &weight, std::size_t average_samples, const std::string &set) {
    const CandidateRows candidates = candidates_of(model, orders, rows);
    if (force_N.shape(0) != motion.count() || weight.shape(0) != motion.count()) {
        refuse("force and weight: as many as the motion has samples");
    }
    auto out = std::make_unique<double[]>(candidates.count);
    {
        const nb::gil_scoped_release released;
        squared_error(candidates, *motion.grid(substeps),
                      {force_N.data(), weight.data(), average_samples},
                      set_or_best(set, candidates), out.get());
    }
    return owned<Out1>(std::move(out), {candidates.count});
}

nb::dict describe(const ParameterInfo &info, bool is_told) {
    nb::dict out;
    out["name"] = info.name;
    out["unit"] = info.unit;
    out["min"] = info.min;
    out["max"] = info.max;
    out["search_low"] = info.search_low;
    out["search_high"] = info.search_high;
    out["scale"] = nb::make_tuple(info.scale.force, info.scale.disp, info.scale.speed);
    out["is_linear"] = info.is_linear;
    out["follows_current"] = info.follows_current;
    out["text"] = info.text;
    out["is_told"] = is_told;
    return out;
}

nb::list describe_models() {
    nb::list out;
    for (const KernelModel &model : kernel_models()) {
        nb::dict one;
        one["name"] = model.name;
        one["title"] = model.title;
        one["source"] = model.source;
        one["states"] = model.state_count;
        one["uses_accel"] = model.uses_accel;
        nb::list parameters;
        for (std::size_t k = 0; k < model.parameter_count; ++k) {
            parameters.append(describe(model.parameters[k], k < model.told_count));
        }
        one["parameters"] = parameters;
        out.append(one);
    }
    return out;
}

const KernelModel &model_with(const std::string &name, const Row &p) {
    const KernelModel &model = kernel_models()[model_index(name)];
    if (p.shape(0) != model.parameter_count) {
        refuse("one value a parameter of the model");
    }
    return model;
}

/// A graph of traced numbers as a list, each after those that it is made of.
class TraceList {
  public:
    int add(const TraceRef &node) {
        const auto known = places_.find(node.get());
        if (known != places_.end()) {
            return known->second;
        }
        nb::list from;
        for (const TraceRef &one : node->from) {
            from.append(add(one));
        }
        const auto place = static_cast<int>(nodes_.size());
        nodes_.append(nb::make_tuple(node->what, from, value_of(*node)));
        places_[node.get()] = place;
        return place;
    }
    const nb::list &nodes() const { return nodes_; }

  private:
    static nb::object value_of(const TraceNode &node) {
        if (node.what == "number") {
            return nb::cast(node.number);
        }
        return node.what == "name" ? nb::cast(node.name) : nb::cast(node.integer);
    }

    nb::list nodes_;
    std::map<const TraceNode *, int> places_;
};

nb::dict described(const ModelEquations &model) {
    TraceList list;
    nb::list rates;
    for (const Traced &rate : model.rates) {
        rates.append(list.add(rate.node));
    }
    nb::dict out;
    out["force_N"] = list.add(model.force_N.node);
    out["rates"] = rates;
    out["fastest_rate_1_s"] = list.add(model.fastest_rate_1_s.node);
    out["nodes"] = list.nodes();
    return out;
}

nb::dict described(const TracedFunction &function) {
    TraceList list;
    nb::dict out;
    out["name"] = function.name;
    out["arguments"] = nb::cast(function.arguments);
    out["result"] = list.add(function.result.node);
    out["nodes"] = list.nodes();
    return out;
}

nb::dict describe_equations() {
    nb::dict out;
    for (const auto &models : {kernel_equations(), plain_equations()}) {
        for (const ModelEquations &model : models) {
            out[model.name.c_str()] = described(model);
        }
    }
    return out;
}

nb::list describe_functions() {
    nb::list out;
    for (const TracedFunction &function : elementary_equations()) {
        out.append(described(function));
    }
    out.append(described(field_law_equations()));
    return out;
}

/// A damper file, of any model.
class DamperFile {
  public:
    explicit DamperFile(const std::string &file) : damper_(load_damper(file).damper) {}

    Out1 simulate_motion(const RecordedMotion &motion, int substeps) const {
        auto out = std::make_unique<double[]>(motion.count());
        {
            const nb::gil_scoped_release released;
            damper_over_motion(*damper_, *motion.grid(substeps), out.get());
        }
        return owned<Out1>(std::move(out), {motion.count()});
    }
    double fastest_rate_1_s(double current_A) const { return damper_->fastest_rate_1_s(current_A); }

  private:
    std::shared_ptr<const Damper> damper_;
};

} // namespace

} // namespace quiesce

NB_MODULE(quiesce_dampers, module) {
    using namespace quiesce;
    nb::set_leak_warnings(false);
    module.def("models", describe_models);
    module.def("equations", describe_equations);
    module.def("functions", describe_functions);
    module.def("instruction_sets", instruction_sets);
    module.def("fastest_rate_1_s", [](const std::string &model, const Row &p, double speed_m_s) {
        return model_with(model, p).fastest_rate_1_s(p.data(), speed_m_s);
    });
    module.def("effective_A",
               [](double current_A, double exponent, double saturation, double reference_A) {
                   return FieldLaw<double>{exponent, saturation, reference_A}.effective(current_A);
               });
    module.def("is_passive", [](const std::string &model, const Row &p) {
        return model_with(model, p).is_passive(p.data());
    });
    nb::class_<RecordedMotion>(module, "Motion")
        .def(nb::init<double, const Row &, const Row &, const Row &, const Row &>())
        .def_prop_ro("count", &RecordedMotion::count);
    module.def("simulate", simulate_rows, nb::arg("model"), nb::arg("orders"), nb::arg("rows"),
               nb::arg("motion"), nb::arg("substeps"), nb::arg("set") = "");
    module.def("squared_error", error_of_rows, nb::arg("model"), nb::arg("orders"), nb::arg("rows"),
               nb::arg("motion"), nb::arg("substeps"), nb::arg("force_N"), nb::arg("weight"),
               nb::arg("average_samples"), nb::arg("set") = "");
    nb::class_<DamperFile>(module, "DamperFile")
        .def(nb::init<const std::string &>())
        .def("simulate", &DamperFile::simulate_motion)
        .def("fastest_rate_1_s", &DamperFile::fastest_rate_1_s);
    nb::register_exception_translator([](const std::exception_ptr &caught, void *) {
        try {
            std::rethrow_exception(caught);
        } catch (const InputError &error) {
            PyErr_SetString(PyExc_ValueError, error.what());
        }
    });
}
