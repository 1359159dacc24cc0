/// A part of the loop as co-simulations see it: named values, a clock of ticks, a state that can be
/// saved. fmi2.cpp and fmi3.cpp put it behind the functions of the standard.
#ifndef QUIESCE_FMU_MODEL_H
#define QUIESCE_FMU_MODEL_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "state_archive.h"

namespace quiesce {

enum class VariableType { real, integer, boolean };
enum class Causality { parameter, input, output };
/// fixed: set before the start only. tunable: parameters also while it runs.
enum class Variability { fixed, tunable, discrete, continuous };

/// Its value reference is its index.
struct Variable {
    std::string name;
    VariableType type;
    Causality causality;
    Variability variability;
    std::string unit; ///< as the standard writes it: "m/s2"; "": none
    std::string description;
    double start = 0.0; ///< not of outputs
    std::optional<double> min{};
    std::optional<double> max{};
};

/// Values of all types are doubles here: 32-bit integers fit.
class FmuModel {
  public:
    virtual ~FmuModel() = default;

    const std::vector<Variable> &variables() const { return variables_; }
    int tick_rate_Hz() const { return tick_rate_Hz_; }

    /// The reference after the last variable is the time of FMI 3, a real that can be read only.
    /// Throws InputError where there is no such variable of that type.
    double get(std::size_t index, VariableType type);

    /// Throws InputError likewise, where it is an output or a fixed parameter of a model that runs,
    /// and where the value is outside of its limits.
    void set(std::size_t index, VariableType type, double value);

    /// The values are those to start with, at time_s(). Throws InputError where they do not fit.
    void begin();
    bool is_running() const { return is_running_; }

    /// Where the last step that succeeded ended; before any, where it starts.
    double time_s() const { return time_s_; }
    /// The time to start at, of a model that does not run.
    void set_start_s(double start_s) { time_s_ = start_s; }

    /// Runs the ticks that are due until then. Throws InputError where the simulation fails.
    void run_until(double time_s);

    /// As made.
    void reset();

    /// For the same model in any process on such a machine. load throws InputError, and changes
    /// nothing, where the bytes are damaged or of another one.
    std::vector<std::uint8_t> save();
    void load(const std::vector<std::uint8_t> &bytes);

  protected:
    explicit FmuModel(int tick_rate_Hz) : tick_rate_Hz_(tick_rate_Hz) {}

    /// Returns its index.
    std::size_t declare(const Variable &variable);
    double value(std::size_t index) const { return values_[index]; }
    bool is_set(std::size_t index) const { return values_[index] != 0.0; }
    void put(std::size_t index, double value) { values_[index] = value; }

    std::int64_t next_tick() const { return next_tick_; }
    double tick_s() const { return 1.0 / tick_rate_Hz_; }

  private:
    /// From rest, with the parameters as they are; writes the outputs of that instant.
    virtual void start() = 0;
    /// One tick, which begins at next_tick(): reads inputs, writes outputs.
    virtual void tick() = 0;
    /// A tick is due when it begins; else once it is over.
    virtual bool is_due_at_its_start() const { return false; }
    /// Outputs that follow from inputs without a tick.
    virtual void evaluate() {}
    /// A tunable parameter has another value. Throws InputError where it does not fit.
    virtual void tuned(std::size_t /*index*/) {}
    /// Beside the values.
    virtual void visit_state(StateArchive &archive) = 0;

    Variable &variable_of(std::size_t index, VariableType type);
    void visit_all(StateArchive &archive);

    int tick_rate_Hz_;
    std::vector<Variable> variables_;
    std::vector<double> values_;
    bool is_running_ = false;
    bool is_stale_ = true; ///< outputs may be of other inputs or parameters
    double start_s_ = 0.0;
    double time_s_ = 0.0;
    std::int64_t next_tick_ = 0;
};

} // namespace quiesce

#endif
