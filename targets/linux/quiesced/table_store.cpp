#include "table_store.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "names.h"

namespace quiesced {

namespace {

constexpr std::uint32_t kVersion = 2; // 1: what was learnt, without a head

/// On the disk, up to the most words that such a record may have.
struct Record {
    StoredOver over;
    std::uint32_t writes;
    std::uint32_t count; ///< 0: forgotten
    std::array<std::uint32_t, QUIESCE_TABLE_WORDS> words;
};

const char *kind_of(keeper_record_t record) {
    return record == KEEPER_LAW_TABLE ? "law" : record == KEEPER_LEARNT ? "learnt" : "tracker";
}

std::uint32_t most_words(keeper_record_t record) {
    return record == KEEPER_LEARNT ? LEARNT_MOST_WORDS : QUIESCE_TABLE_WORDS;
}

std::size_t bytes_of(keeper_record_t record) {
    return offsetof(Record, words) + most_words(record) * sizeof(std::uint32_t);
}

/// What was learnt knows its law, table and setting.
const char *change_since(keeper_record_t record, const StoredOver &then, const StoredOver &now) {
    if (record == KEEPER_LEARNT) {
        return nullptr;
    }
    if (then.board != now.board) {
        return "the board has changed since";
    }
    return then.configured != now.configured ? "[tables] has changed since" : nullptr;
}

} // namespace

std::string TableStore::file(keeper_record_t record) const {
    return folder_ + "/" + kind_of(record) + (record == KEEPER_LEARNT ? ".bin" : "_table.bin");
}

StoredTable TableStore::load(keeper_record_t record, const StoredOver &over,
                             std::string &note) const {
    Record kept{};
    linux_error_t error{};
    note.clear();
    const nvm_verdict_t verdict = nvm_file_read(file(record).c_str(), kind_of(record), kVersion,
                                                &kept, bytes_of(record), &error);
    if (verdict == NVM_MISSING) {
        return {};
    }
    const char *why = verdict == NVM_OK ? change_since(record, kept.over, over) : error.text;
    const std::uint32_t count = std::min(kept.count, most_words(record));
    if (why != nullptr && (verdict != NVM_OK || count > 0)) {
        note = road_name(road_of(record)) +
               std::string(record == KEEPER_LEARNT ? "" : " as stored") + " is not used: " + why;
    }
    const auto begin = kept.words.begin();
    return {why == nullptr ? TableWords(begin, begin + count) : TableWords(), kept.writes,
            verdict == NVM_OK ? KEEPER_WHOLE : KEEPER_LOST};
}

std::string TableStore::save(keeper_record_t record, const StoredOver &over,
                             const std::uint32_t *words, std::uint32_t count) {
    Record kept{};
    linux_error_t error{};
    const std::string path = file(record);
    if (count > most_words(record)) {
        return path + ": too many words";
    }
    if (nvm_file_read(path.c_str(), kind_of(record), kVersion, &kept, bytes_of(record), &error) !=
        NVM_OK) {
        kept = {};
    }
    kept.over = over;
    kept.writes += kept.writes < UINT32_MAX ? 1 : 0;
    kept.count = count;
    std::fill(std::copy_n(words, count, kept.words.begin()), kept.words.end(), 0);
    return nvm_file_write(path.c_str(), kind_of(record), kVersion, &kept, bytes_of(record), &error)
               ? ""
               : error.text;
}

} // namespace quiesced
