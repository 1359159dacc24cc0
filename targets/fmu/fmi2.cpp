/// FMI 2.0, co-simulation.
#define FMI2_FUNCTION_PREFIX
#include "fmi2Functions.h"

#include "instance.h"

using quiesce::FmuInstance;
using quiesce::SavedState;
using quiesce::VariableType;

namespace {

FmuInstance &of(fmi2Component component) {
    return *static_cast<FmuInstance *>(component);
}

/// Importers that cannot take arguments of any number show the format as it is: it is the message.
std::string format_of(const std::string &message) {
    std::string out;
    for (const char letter : message) {
        out += letter == '%' ? "%%" : std::string(1, letter);
    }
    return out;
}

fmi2Status status_of(bool is_ok) {
    return is_ok ? fmi2OK : fmi2Error;
}

} // namespace

extern "C" {

const char *fmi2GetTypesPlatform() {
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion() {
    return fmi2Version;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token,
                              fmi2String resources, const fmi2CallbackFunctions *functions,
                              fmi2Boolean /*visible*/, fmi2Boolean /*logging*/) {
    const std::string own = name == nullptr ? "" : name;
    const auto logger = functions == nullptr ? nullptr : functions->logger;
    const auto environment = functions == nullptr ? nullptr : functions->componentEnvironment;
    const auto log = [own, logger, environment](const std::string &message) {
        if (logger != nullptr) {
            logger(environment, own.c_str(), fmi2Error, "logStatusError",
                   format_of(message).c_str());
        }
    };
    if (type != fmi2CoSimulation) {
        log("it is for co-simulation only");
        return nullptr;
    }
    return FmuInstance::make(token, resources, log);
}

void fmi2FreeInstance(fmi2Component component) {
    delete static_cast<FmuInstance *>(component);
}

fmi2Status fmi2SetDebugLogging(fmi2Component /*component*/, fmi2Boolean /*on*/, size_t /*count*/,
                               const fmi2String /*categories*/[]) {
    return fmi2OK; // errors are all that there is
}

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean /*has_tolerance*/,
                               fmi2Real /*tolerance*/, fmi2Real start_s, fmi2Boolean /*has_stop*/,
                               fmi2Real /*stop_s*/) {
    of(component).model().set_start_s(start_s);
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component /*component*/) {
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
    return status_of(of(component).guarded([&] { of(component).begin_if_new(); }));
}

fmi2Status fmi2Terminate(fmi2Component /*component*/) {
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component component) {
    return status_of(of(component).guarded([&] { of(component).model().reset(); }));
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                       fmi2Real values[]) {
    return status_of(of(component).get(references, count, VariableType::real, values));
}

fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference references[],
                          size_t count, fmi2Integer values[]) {
    return status_of(of(component).get(references, count, VariableType::integer, values));
}

fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference references[],
                          size_t count, fmi2Boolean values[]) {
    return status_of(of(component).get(references, count, VariableType::boolean, values));
}

fmi2Status fmi2GetString(fmi2Component /*component*/, const fmi2ValueReference /*references*/[],
                         size_t count, fmi2String /*values*/[]) {
    return status_of(count == 0);
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                       const fmi2Real values[]) {
    return status_of(of(component).set(references, count, VariableType::real, values));
}

fmi2Status fmi2SetInteger(fmi2Component component, const fmi2ValueReference references[],
                          size_t count, const fmi2Integer values[]) {
    return status_of(of(component).set(references, count, VariableType::integer, values));
}

fmi2Status fmi2SetBoolean(fmi2Component component, const fmi2ValueReference references[],
                          size_t count, const fmi2Boolean values[]) {
    return status_of(of(component).set(references, count, VariableType::boolean, values));
}

fmi2Status fmi2SetString(fmi2Component /*component*/, const fmi2ValueReference /*references*/[],
                         size_t count, const fmi2String /*values*/[]) {
    return status_of(count == 0);
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state) {
    return status_of(of(component).save(reinterpret_cast<SavedState **>(state)));
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
    return status_of(of(component).load(static_cast<const SavedState *>(state)));
}

fmi2Status fmi2FreeFMUstate(fmi2Component /*component*/, fmi2FMUstate *state) {
    delete static_cast<SavedState *>(*state);
    *state = nullptr;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component /*component*/, fmi2FMUstate state,
                                      size_t *size) {
    *size = static_cast<const SavedState *>(state)->bytes.size();
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[],
                                 size_t size) {
    return status_of(of(component).copy_out(*static_cast<const SavedState *>(state), bytes, size));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state) {
    return status_of(of(component).copy_in(bytes, size, reinterpret_cast<SavedState **>(state)));
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component /*component*/,
                                        const fmi2ValueReference /*unknown*/[], size_t /*unknowns*/,
                                        const fmi2ValueReference /*known*/[], size_t /*knowns*/,
                                        const fmi2Real /*in*/[], fmi2Real /*out*/[]) {
    return fmi2Error; // the description says that there are none
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component /*component*/,
                                       const fmi2ValueReference /*references*/[], size_t count,
                                       const fmi2Integer /*orders*/[],
                                       const fmi2Real /*values*/[]) {
    return status_of(count == 0); // inputs are held
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component /*component*/,
                                        const fmi2ValueReference /*references*/[], size_t count,
                                        const fmi2Integer /*orders*/[], fmi2Real /*values*/[]) {
    return status_of(count == 0);
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real from_s, fmi2Real length_s,
                      fmi2Boolean /*no_way_back*/) {
    return status_of(of(component).step(from_s, length_s));
}

fmi2Status fmi2CancelStep(fmi2Component /*component*/) {
    return fmi2Error; // no step takes longer than its call
}

fmi2Status fmi2GetStatus(fmi2Component /*component*/, fmi2StatusKind /*kind*/,
                         fmi2Status * /*value*/) {
    return fmi2Discard; // likewise
}

fmi2Status fmi2GetRealStatus(fmi2Component component, fmi2StatusKind kind, fmi2Real *value) {
    if (kind != fmi2LastSuccessfulTime) {
        return fmi2Discard;
    }
    *value = of(component).model().time_s();
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component /*component*/, fmi2StatusKind /*kind*/,
                                fmi2Integer * /*value*/) {
    return fmi2Discard;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component /*component*/, fmi2StatusKind kind,
                                fmi2Boolean *value) {
    if (kind != fmi2Terminated) {
        return fmi2Discard;
    }
    *value = fmi2False; // what ends it is an error
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component /*component*/, fmi2StatusKind /*kind*/,
                               fmi2String * /*value*/) {
    return fmi2Discard;
}

} // extern "C"
