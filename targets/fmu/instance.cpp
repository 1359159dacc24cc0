#include "instance.h"

#include <cmath>
#include <utility>

#include "resources.h"

namespace quiesce {

FmuInstance::FmuInstance(const std::string &token, const std::string &resources, Log log)
    : log_(std::move(log)) {
    const FmuResources read = read_resources(resources);
    if (read.token != token) {
        throw InputError("the description and the library are of different FMUs: " + token +
                         " and " + read.token);
    }
    model_ = make_model(read);
}

FmuInstance *FmuInstance::make(const char *token, const char *resources, const Log &log) noexcept {
    try {
        if (token == nullptr || resources == nullptr) {
            throw InputError("it needs its token and its resources");
        }
        return new FmuInstance(token, resources, log);
    } catch (const std::exception &error) {
        log(error.what());
    } catch (...) {
        log("unknown failure");
    }
    return nullptr;
}

void FmuInstance::begin_if_new() {
    if (!model_->is_running()) {
        model_->begin();
    }
}

bool FmuInstance::step(double from_s, double length_s) {
    return guarded([&] {
        if (!std::isfinite(from_s) || !std::isfinite(length_s) || length_s < 0.0) {
            throw InputError("a step goes from a time on for a length that is not below 0");
        }
        model_->run_until(from_s + length_s);
    });
}

bool FmuInstance::save(SavedState **state) {
    return guarded([&] { keep({model_->save()}, state); });
}

void FmuInstance::keep(SavedState saved, SavedState **state) {
    if (*state == nullptr) {
        *state = new SavedState(std::move(saved));
    } else {
        **state = std::move(saved);
    }
}

bool FmuInstance::load(const SavedState *state) {
    return guarded([&] {
        if (state == nullptr) {
            throw InputError("there is no state");
        }
        model_->load(state->bytes);
    });
}

void FmuInstance::log(const std::string &message) noexcept {
    try {
        log_(message);
    } catch (...) { // NOLINT(bugprone-empty-catch) nothing is left to tell
    }
}

} // namespace quiesce
