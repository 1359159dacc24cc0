#include "reload.h"

#include <algorithm>

#include "board_fit.h"
#include "clock.h"
#include "input_error.h"
#include "names.h"
#include "read_config.h"

namespace quiesced {

void Reload::begin() {
    exchange_.manager.send("RELOADING=1\nMONOTONIC_USEC=" + std::to_string(monotonic_ns() / 1000));
    is_under_way_ = true;
    try {
        read();
    } catch (const quiesce::InputError &error) {
        sink_.write(LogLevel::error, std::string("parameters and tables stay: ") + error.what());
    }
}

void Reload::finish() {
    if (is_under_way_ && is_taken()) {
        is_under_way_ = false;
        exchange_.manager.send("READY=1");
    }
}

void Reload::read() {
    const Config fresh = require_config(config_.file, Needs::peripherals);
    std::string note;
    const quiesce_params_t params = store_.effective(fresh.params, note);
    if (!note.empty()) {
        sink_.write(LogLevel::info, note);
    }
    // The board is still that of the start.
    if (const std::optional<Misfit> misfit = find_misfit(config_, params)) {
        throw quiesce::InputError(misfit->reason.data());
    }
    const ConfiguredTables tables = load_tables(fresh, config_.wiring());
    require_fit(changed_of(tables), fresh, config_.wiring(), params);
    if (!is_taken()) {
        throw quiesce::InputError("the last reload is not through yet");
    }
    hand_over(params, tables);
    params_ = fresh.params;
}

/// Those that are others than before.
ConfiguredTables Reload::changed_of(ConfiguredTables tables) const {
    for (const quiesce_owner_t owner : kOwners) {
        if (tables[owner] == tables_[owner]) {
            tables[owner].clear();
        }
    }
    return tables;
}

/// Parameters first: a table may be of their law.
void Reload::hand_over(const quiesce_params_t &params, const ConfiguredTables &tables) {
    (void)exchange_.new_params.put(params);
    for (const quiesce_owner_t owner : kOwners) {
        if (tables[owner] != tables_[owner]) {
            Words words{static_cast<std::uint32_t>(tables[owner].size()), {}};
            std::copy(tables[owner].begin(), tables[owner].end(), words.words.begin());
            (void)exchange_.new_tables[owner].put(words);
        }
    }
    tables_ = tables;
}

/// Whether the loop has taken all of the last one.
bool Reload::is_taken() const {
    return !exchange_.new_params.is_full() &&
           std::none_of(exchange_.new_tables.begin(), exchange_.new_tables.end(),
                        [](const auto &table) { return table.is_full(); });
}

} // namespace quiesced
