#include "clear_fault.h"

#include <cstdio>
#include <optional>

#include "fault_store.h"
#include "input_error.h"
#include "instance_lock.h"
#include "read_config.h"

namespace quiesced {

int clear_fault(const std::string &config_file) {
    const Config config = require_config(config_file, Needs::peripherals);
    const std::string &folder = config.state.folder;
    if (const long pid = InstanceLock::holder(folder); pid != 0) {
        throw quiesce::InputError("process " + std::to_string(pid) +
                                  " controls; acknowledge over CAN, or stop it first");
    }
    std::string note;
    FaultStore store(folder);
    (void)store.load(note);
    if (note.empty()) {
        (void)std::puts("no fault is kept");
        return 0;
    }
    const InstanceLock lock(folder); // none starts meanwhile
    if (const std::string error = store.keep(QUIESCE_FAULT_NONE); !error.empty()) {
        throw quiesce::InputError("the fault cannot be forgotten: " + error);
    }
    (void)std::printf("forgotten: %s\n", note.c_str());
    return 0;
}

} // namespace quiesced
