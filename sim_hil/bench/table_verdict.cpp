#include "table_verdict.h"

#include "crc32.h"

namespace quiesce {

namespace {

// First words of kinds that have reasons of their own; those of the others are alike.
enum Kind : std::uint32_t {
    kRules = 0x31545A46,
    kPulses = 0x31485051,
    kMap = 0x32464D51,
    kBank = 0x314B4251,
    kLearnt = 0x31544C51,
};

enum Head : std::size_t { kMagicAt, kCrcAt, kCountAt };

std::uint32_t count_of(const TableWords &words) {
    return static_cast<std::uint32_t>(words.size());
}

quiesce_params_t with(std::int32_t law, std::int32_t tracker) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.law = law;
    params.tracker = tracker;
    return params;
}

struct Label {
    std::int32_t number;
    const char *name;
};

#define LAW(number, name) {QUIESCE_LAW_##number, #name},
constexpr Label kLaws[] = {QUIESCE_EACH_LAW(LAW)};
#undef LAW
#define TRACKER(number, name) {QUIESCE_TRACKER_##number, #name},
constexpr Label kTrackers[] = {QUIESCE_EACH_TRACKER(TRACKER)};
#undef TRACKER

// Any law that demands forces has a tracker.
constexpr std::int32_t kOfForces = QUIESCE_LAW_FRICTION;

/// Whether the kind of this first word is one of its own. Only of such a table it looks further.
bool takes(quiesce_t &controller, std::uint32_t magic) {
    constexpr std::uint32_t kCount = 64; // no kind's head is longer
    TableWords words(kCount);
    words[kMagicAt] = magic;
    words[kCountAt] = kCount;
    return use_table(controller, words) != QUIESCE_TABLE_MAGIC;
}

bool law_takes(std::int32_t law, std::uint32_t magic) {
    return takes(*controller_with(nullptr, with(law, QUIESCE_TRACKER_COMPARE)), magic);
}

bool tracker_takes(std::int32_t tracker, std::uint32_t magic) {
    return !law_takes(kOfForces, magic) &&
           takes(*controller_with(nullptr, with(kOfForces, tracker)), magic);
}

/// No law takes it as a table: its head is all that can be checked beside the table it belongs to.
quiesce_table_verdict_t of_learnt(const TableWords &words) {
    if (words[kCountAt] != count_of(words)) {
        return QUIESCE_TABLE_SIZE;
    }
    return crc32_of(&words[kCountAt], words.size() - kCountAt) == words[kCrcAt] ? QUIESCE_TABLE_OK
                                                                                : QUIESCE_TABLE_CRC;
}

bool is_of(const TableWords &words, Kind kind) {
    return words[kMagicAt] == kind;
}

/// A system, signs, friction, a polynomial, rules on signals, a network.
bool is_form(const TableWords &words) {
    return !is_of(words, kRules) && !is_of(words, kPulses) && !is_of(words, kMap) &&
           !is_of(words, kLearnt);
}

const char *reason_of_fit(const TableWords &words) {
    if (is_of(words, kRules)) {
        return "the controller's rules have two inputs, frequency in uHz and RMS acceleration in "
               "um/s2, and one output, current in mA; compile them with --controller";
    }
    if (is_of(words, kMap) || is_of(words, kBank)) {
        return "it is of more dampers than this board has, or over a stroke that no sensor tells "
               "(quiesce board show), or a bank for another tick_rate_Hz";
    }
    return "it needs a signal or a damper that this board does not have, or is made for another "
           "tick_rate_Hz (quiesce table show says what it needs, quiesce board show what there is)";
}

const char *reason_of_shape(const TableWords &words) {
    return is_form(words)
               ? "its numbers of states, inputs, rows, sections, signs, terms, layers or units are "
                 "out of range, or it takes too long for a tick"
               : "its numbers of inputs, outputs, rules or points are out of range";
}

const char *reason_of_point(const TableWords &words) {
    return is_form(words)
               ? "a coefficient, limit, band, power or current is out of range"
               : "its frequencies do not rise, or a floor is above its level; a force map's axes "
                 "do not rise from below 0 to above it (currents: from 0 to 20 A at most), or its "
                 "force does not grow with the current";
}

} // namespace

std::unique_ptr<quiesce_t> controller_with(const quiesce_board_t *board,
                                           const quiesce_params_t &params) {
    auto controller = std::make_unique<quiesce_t>();
    if (board != nullptr) {
        quiesce_init_board(controller.get(), board, &params);
    } else {
        quiesce_init(controller.get(), &params);
    }
    return controller;
}

quiesce_table_verdict_t use_table(quiesce_t &controller, const TableWords &words) {
    return quiesce_table_use(&controller, words.data(), count_of(words));
}

quiesce_table_verdict_t verdict_of(const TableWords &words) {
    if (is_of(words, kLearnt)) {
        return of_learnt(words);
    }
    return quiesce_table_check(words.data(), count_of(words));
}

quiesce_table_verdict_t verdict_on(const quiesce_board_t &board, const TableWords &words) {
    quiesce_table_verdict_t verdict = verdict_of(words);
    if (verdict != QUIESCE_TABLE_OK || is_of(words, kLearnt)) {
        return verdict;
    }
    for (const std::int32_t rate_Hz : {500, 1000, 2000, 4000}) {
        for (const Label &tracker : kTrackers) {
            for (const Label &law : kLaws) {
                quiesce_params_t params = with(law.number, tracker.number);
                params.tick_rate_Hz = rate_Hz;
                const auto controller = controller_with(&board, params);
                if (use_table(*controller, words) == QUIESCE_TABLE_OK) {
                    return QUIESCE_TABLE_OK;
                }
            }
        }
    }
    return QUIESCE_TABLE_FIT;
}

Takers takers_of(const TableWords &words) {
    Takers out;
    for (const Label &law : kLaws) {
        if (law_takes(law.number, words[kMagicAt])) {
            out.laws.emplace_back(law.name);
        }
    }
    for (const Label &tracker : kTrackers) {
        if (tracker_takes(tracker.number, words[kMagicAt])) {
            out.trackers.emplace_back(tracker.name);
        }
    }
    return out;
}

const char *reason_of(quiesce_table_verdict_t verdict, const TableWords &words) {
    switch (verdict) {
    case QUIESCE_TABLE_OK:
        return "accepted";
    case QUIESCE_TABLE_SIZE:
        return "it is shorter than it says, or too long";
    case QUIESCE_TABLE_MAGIC:
        return "it is not a table for this law or tracker, or one of another version";
    case QUIESCE_TABLE_CRC:
        return "its checksum is wrong: it is damaged";
    case QUIESCE_TABLE_SHAPE:
        return reason_of_shape(words);
    case QUIESCE_TABLE_CELL:
        return "a membership is out of range";
    case QUIESCE_TABLE_RULE:
        return "a rule names what is not there";
    case QUIESCE_TABLE_OUTPUT:
        return "a term is out of range";
    case QUIESCE_TABLE_FIT:
        return reason_of_fit(words);
    case QUIESCE_TABLE_POINT:
        return reason_of_point(words);
    default: // of a later controller
        return "unknown reason";
    }
}

} // namespace quiesce
