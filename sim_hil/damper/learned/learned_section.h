/// Learned models in files: what the keys of [parameters] mean (docs/damper_learned.md). Each
/// throws InputError naming the key that is wrong.
#ifndef QUIESCE_LEARNED_SECTION_H
#define QUIESCE_LEARNED_SECTION_H

#include <memory>

#include "damper.h"
#include "toml_table.h"

namespace quiesce {

std::shared_ptr<const Damper> read_anfis(TomlTable &keys);
std::shared_ptr<const Damper> read_feed_forward_network(TomlTable &keys);
std::shared_ptr<const Damper> read_hysteresis_network(TomlTable &keys);
std::shared_ptr<const Damper> read_neuro_fuzzy_stf(TomlTable &keys);
std::shared_ptr<const Damper> read_recurrent_network(TomlTable &keys);
std::shared_ptr<const Damper> read_support_vector(TomlTable &keys);
std::shared_ptr<const Damper> read_ts_fuzzy(TomlTable &keys);

} // namespace quiesce

#endif
