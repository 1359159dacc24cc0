/// FMI 3.0, co-simulation.
#define FMI3_FUNCTION_PREFIX
#include "fmi3Functions.h"

#include "instance.h"

using quiesce::FmuInstance;
using quiesce::SavedState;
using quiesce::VariableType;

namespace {

FmuInstance &of(fmi3Instance instance) {
    return *static_cast<FmuInstance *>(instance);
}

fmi3Status status_of(bool is_ok) {
    return is_ok ? fmi3OK : fmi3Error;
}

} // namespace

extern "C" {

const char *fmi3GetVersion() {
    return fmi3Version;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String /*name*/, fmi3String token,
                                         fmi3String resources, fmi3Boolean /*visible*/,
                                         fmi3Boolean /*logging*/, fmi3Boolean /*events*/,
                                         fmi3Boolean /*early*/,
                                         const fmi3ValueReference /*intermediate*/[],
                                         size_t /*count*/, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback logger,
                                         fmi3IntermediateUpdateCallback /*update*/) {
    const auto log = [logger, environment](const std::string &message) {
        if (logger != nullptr) {
            logger(environment, fmi3Error, "logStatusError", message.c_str());
        }
    };
    return FmuInstance::make(token, resources, log);
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String /*name*/, fmi3String /*token*/,
                                          fmi3String /*resources*/, fmi3Boolean /*visible*/,
                                          fmi3Boolean /*logging*/,
                                          fmi3InstanceEnvironment /*environment*/,
                                          fmi3LogMessageCallback /*logger*/) {
    return nullptr; // the description offers co-simulation only
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String /*name*/, fmi3String /*token*/, fmi3String /*resources*/, fmi3Boolean /*visible*/,
    fmi3Boolean /*logging*/, fmi3InstanceEnvironment /*environment*/,
    fmi3LogMessageCallback /*logger*/, fmi3ClockUpdateCallback /*update*/,
    fmi3LockPreemptionCallback /*lock*/, fmi3UnlockPreemptionCallback /*unlock*/) {
    return nullptr;
}

void fmi3FreeInstance(fmi3Instance instance) {
    delete static_cast<FmuInstance *>(instance);
}

fmi3Status fmi3SetDebugLogging(fmi3Instance /*instance*/, fmi3Boolean /*on*/, size_t /*count*/,
                               const fmi3String /*categories*/[]) {
    return fmi3OK; // errors are all that there is
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean /*has_tolerance*/,
                                       fmi3Float64 /*tolerance*/, fmi3Float64 start_s,
                                       fmi3Boolean /*has_stop*/, fmi3Float64 /*stop_s*/) {
    of(instance).model().set_start_s(start_s);
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
    return status_of(of(instance).guarded([&] { of(instance).begin_if_new(); }));
}

fmi3Status fmi3Terminate(fmi3Instance /*instance*/) {
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance) {
    return status_of(of(instance).guarded([&] { of(instance).model().reset(); }));
}

fmi3Status fmi3EnterStepMode(fmi3Instance /*instance*/) {
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 from_s, fmi3Float64 length_s,
                      fmi3Boolean /*no_way_back*/, fmi3Boolean *event, fmi3Boolean *end,
                      fmi3Boolean *early, fmi3Float64 *reached_s) {
    const bool is_ok = of(instance).step(from_s, length_s);
    *event = fmi3False;
    *end = fmi3False;
    *early = fmi3False;
    *reached_s = of(instance).model().time_s();
    return status_of(is_ok);
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, fmi3Float64 values[], size_t values_count) {
    return status_of(count == values_count &&
                     of(instance).get(references, count, VariableType::real, values));
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, const fmi3Float64 values[], size_t values_count) {
    return status_of(count == values_count &&
                     of(instance).set(references, count, VariableType::real, values));
}

fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                        fmi3Int32 values[], size_t values_count) {
    return status_of(count == values_count &&
                     of(instance).get(references, count, VariableType::integer, values));
}

fmi3Status fmi3SetInt32(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                        const fmi3Int32 values[], size_t values_count) {
    return status_of(count == values_count &&
                     of(instance).set(references, count, VariableType::integer, values));
}

fmi3Status fmi3GetBoolean(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, fmi3Boolean values[], size_t values_count) {
    return status_of(count == values_count &&
                     of(instance).get(references, count, VariableType::boolean, values));
}

fmi3Status fmi3SetBoolean(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, const fmi3Boolean values[], size_t values_count) {
    return status_of(count == values_count &&
                     of(instance).set(references, count, VariableType::boolean, values));
}

// Types that no variable has.
#define NO_VARIABLES(name)                                                                         \
    fmi3Status fmi3Get##name(fmi3Instance, const fmi3ValueReference[], size_t count, fmi3##name[], \
                             size_t) {                                                             \
        return status_of(count == 0);                                                              \
    }                                                                                              \
    fmi3Status fmi3Set##name(fmi3Instance, const fmi3ValueReference[], size_t count,               \
                             const fmi3##name[], size_t) {                                         \
        return status_of(count == 0);                                                              \
    }
NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(UInt32)
NO_VARIABLES(Int64)
NO_VARIABLES(UInt64)
NO_VARIABLES(String)
#undef NO_VARIABLES

fmi3Status fmi3GetBinary(fmi3Instance /*instance*/, const fmi3ValueReference /*references*/[],
                         size_t count, size_t /*sizes*/[], fmi3Binary /*values*/[],
                         size_t /*values_count*/) {
    return status_of(count == 0);
}

fmi3Status fmi3SetBinary(fmi3Instance /*instance*/, const fmi3ValueReference /*references*/[],
                         size_t count, const size_t /*sizes*/[], const fmi3Binary /*values*/[],
                         size_t /*values_count*/) {
    return status_of(count == 0);
}

fmi3Status fmi3GetClock(fmi3Instance /*instance*/, const fmi3ValueReference /*references*/[],
                        size_t count, fmi3Clock /*values*/[]) {
    return status_of(count == 0);
}

fmi3Status fmi3SetClock(fmi3Instance /*instance*/, const fmi3ValueReference /*references*/[],
                        size_t count, const fmi3Clock /*values*/[]) {
    return status_of(count == 0);
}

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state) {
    return status_of(of(instance).save(reinterpret_cast<SavedState **>(state)));
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
    return status_of(of(instance).load(static_cast<const SavedState *>(state)));
}

fmi3Status fmi3FreeFMUState(fmi3Instance /*instance*/, fmi3FMUState *state) {
    delete static_cast<SavedState *>(*state);
    *state = nullptr;
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance /*instance*/, fmi3FMUState state, size_t *size) {
    *size = static_cast<const SavedState *>(state)->bytes.size();
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[],
                                 size_t size) {
    return status_of(of(instance).copy_out(*static_cast<const SavedState *>(state), bytes, size));
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
                                   fmi3FMUState *state) {
    return status_of(of(instance).copy_in(bytes, size, reinterpret_cast<SavedState **>(state)));
}

// What the description does not offer.
fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance, fmi3ValueReference, size_t *) {
    return fmi3Error;
}
fmi3Status fmi3GetVariableDependencies(fmi3Instance, fmi3ValueReference, size_t[],
                                       fmi3ValueReference[], size_t[], fmi3DependencyKind[],
                                       size_t) {
    return fmi3Error;
}
fmi3Status fmi3GetDirectionalDerivative(fmi3Instance, const fmi3ValueReference[], size_t,
                                        const fmi3ValueReference[], size_t, const fmi3Float64[],
                                        size_t, fmi3Float64[], size_t) {
    return fmi3Error;
}
fmi3Status fmi3GetAdjointDerivative(fmi3Instance, const fmi3ValueReference[], size_t,
                                    const fmi3ValueReference[], size_t, const fmi3Float64[], size_t,
                                    fmi3Float64[], size_t) {
    return fmi3Error;
}
fmi3Status fmi3EnterConfigurationMode(fmi3Instance) {
    return fmi3Error;
}
fmi3Status fmi3ExitConfigurationMode(fmi3Instance) {
    return fmi3Error;
}
fmi3Status fmi3GetIntervalDecimal(fmi3Instance, const fmi3ValueReference[], size_t, fmi3Float64[],
                                  fmi3IntervalQualifier[]) {
    return fmi3Error;
}
fmi3Status fmi3GetIntervalFraction(fmi3Instance, const fmi3ValueReference[], size_t, fmi3UInt64[],
                                   fmi3UInt64[], fmi3IntervalQualifier[]) {
    return fmi3Error;
}
fmi3Status fmi3GetShiftDecimal(fmi3Instance, const fmi3ValueReference[], size_t, fmi3Float64[]) {
    return fmi3Error;
}
fmi3Status fmi3GetShiftFraction(fmi3Instance, const fmi3ValueReference[], size_t, fmi3UInt64[],
                                fmi3UInt64[]) {
    return fmi3Error;
}
fmi3Status fmi3SetIntervalDecimal(fmi3Instance, const fmi3ValueReference[], size_t,
                                  const fmi3Float64[]) {
    return fmi3Error;
}
fmi3Status fmi3SetIntervalFraction(fmi3Instance, const fmi3ValueReference[], size_t,
                                   const fmi3UInt64[], const fmi3UInt64[]) {
    return fmi3Error;
}
fmi3Status fmi3SetShiftDecimal(fmi3Instance, const fmi3ValueReference[], size_t,
                               const fmi3Float64[]) {
    return fmi3Error;
}
fmi3Status fmi3SetShiftFraction(fmi3Instance, const fmi3ValueReference[], size_t,
                                const fmi3UInt64[], const fmi3UInt64[]) {
    return fmi3Error;
}
fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance) {
    return fmi3Error;
}
fmi3Status fmi3UpdateDiscreteStates(fmi3Instance, fmi3Boolean *, fmi3Boolean *, fmi3Boolean *,
                                    fmi3Boolean *, fmi3Boolean *, fmi3Float64 *) {
    return fmi3Error;
}
fmi3Status fmi3EnterEventMode(fmi3Instance) {
    return fmi3Error;
}
fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance) {
    return fmi3Error;
}
fmi3Status fmi3CompletedIntegratorStep(fmi3Instance, fmi3Boolean, fmi3Boolean *, fmi3Boolean *) {
    return fmi3Error;
}
fmi3Status fmi3SetTime(fmi3Instance, fmi3Float64) {
    return fmi3Error;
}
fmi3Status fmi3SetContinuousStates(fmi3Instance, const fmi3Float64[], size_t) {
    return fmi3Error;
}
fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance, fmi3Float64[], size_t) {
    return fmi3Error;
}
fmi3Status fmi3GetEventIndicators(fmi3Instance, fmi3Float64[], size_t) {
    return fmi3Error;
}
fmi3Status fmi3GetContinuousStates(fmi3Instance, fmi3Float64[], size_t) {
    return fmi3Error;
}
fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance, fmi3Float64[], size_t) {
    return fmi3Error;
}
fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance, size_t *) {
    return fmi3Error;
}
fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance, size_t *) {
    return fmi3Error;
}
fmi3Status fmi3GetOutputDerivatives(fmi3Instance, const fmi3ValueReference[], size_t,
                                    const fmi3Int32[], fmi3Float64[], size_t) {
    return fmi3Error;
}
fmi3Status fmi3ActivateModelPartition(fmi3Instance, fmi3ValueReference, fmi3Float64) {
    return fmi3Error;
}

} // extern "C"
