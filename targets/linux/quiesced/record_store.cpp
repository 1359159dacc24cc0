#include "record_store.h"

namespace quiesced {

KeptRecord RecordStore::load(std::string &note) const {
    KeptRecord record{};
    std::string why;
    note.clear();
    const nvm_verdict_t verdict = file_.read(&record, why);
    if (verdict == NVM_OK) {
        return record;
    }
    if (verdict != NVM_MISSING) {
        note = "the fault record is not used: " + why;
    }
    return {};
}

} // namespace quiesced
