/// What both versions of the standard have in common: an instance, errors as messages, values by
/// reference.
#ifndef QUIESCE_FMU_INSTANCE_H
#define QUIESCE_FMU_INSTANCE_H

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "model.h"

namespace quiesce {

/// A state that an importer holds.
struct SavedState {
    std::vector<std::uint8_t> bytes;
};

class FmuInstance {
  public:
    using Log = std::function<void(const std::string &message)>;

    /// nullptr, with the reason logged, where there can be none.
    static FmuInstance *make(const char *token, const char *resources, const Log &log) noexcept;

    /// token: what the XML says. Throws InputError.
    FmuInstance(const std::string &token, const std::string &resources, Log log);

    FmuModel &model() { return *model_; }

    /// Leaves the initialisation, once; later calls change nothing.
    void begin_if_new();

    /// Runs work; what it throws is logged. Returns false iff it threw.
    template <typename Work>
    bool guarded(Work &&work) noexcept {
        try {
            work();
            return true;
        } catch (const std::exception &error) {
            log(error.what());
        } catch (...) {
            log("unknown failure");
        }
        return false;
    }

    template <typename Value>
    bool get(const unsigned *references, std::size_t count, VariableType type, Value *out) {
        return guarded([&] {
            for (std::size_t i = 0; i < count; ++i) {
                out[i] = static_cast<Value>(model_->get(references[i], type));
            }
        });
    }

    template <typename Value>
    bool set(const unsigned *references, std::size_t count, VariableType type, const Value *in) {
        return guarded([&] {
            for (std::size_t i = 0; i < count; ++i) {
                model_->set(references[i], type, static_cast<double>(in[i]));
            }
        });
    }

    /// Runs it from one communication point on.
    bool step(double from_s, double length_s);

    /// Overwrites *state where it is not null; so does copy_in.
    bool save(SavedState **state);
    bool load(const SavedState *state);
    template <typename Byte>
    bool copy_out(const SavedState &state, Byte *bytes, std::size_t size) {
        return guarded([&] {
            if (size < state.bytes.size()) {
                throw InputError("the state is longer than the room for it");
            }
            std::copy(state.bytes.begin(), state.bytes.end(), bytes);
        });
    }
    template <typename Byte>
    bool copy_in(const Byte *bytes, std::size_t size, SavedState **state) {
        return guarded([&] { keep({{bytes, bytes + size}}, state); });
    }

  private:
    static void keep(SavedState saved, SavedState **state);
    void log(const std::string &message) noexcept;

    Log log_;
    std::unique_ptr<FmuModel> model_;
};

} // namespace quiesce

#endif
