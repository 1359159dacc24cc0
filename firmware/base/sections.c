#include "sections.h"

#include <stddef.h>

#include "view_signal.h"

quiesce_table_verdict_t sections_check(const sections_kind_t *kind, const uint32_t *words) {
    const uint32_t count = words[TABLE_WORDS];
    if (sections_count(words) == 0 || sections_count(words) > QUIESCE_MAX_DAMPERS) {
        return QUIESCE_TABLE_SHAPE;
    }
    uint32_t at = SECTIONS_FIRST;
    for (uint32_t i = 0; i < sections_count(words); i++) {
        const uint32_t size = kind->size(&words[at], count - at);
        if (size == 0) {
            return QUIESCE_TABLE_SHAPE;
        }
        if (!kind->is_good(&words[at])) {
            return QUIESCE_TABLE_POINT;
        }
        at += size;
    }
    return at == count ? QUIESCE_TABLE_OK : QUIESCE_TABLE_SHAPE;
}

uint64_t sections_need(const sections_kind_t *kind, const uint32_t *words) {
    uint32_t at = SECTIONS_FIRST;
    uint64_t bits = 0;
    for (uint32_t i = 0; i < sections_count(words); i++) {
        bits |= view_needs_damper(i) | kind->needs(&words[at], i);
        at += kind->size(&words[at], words[TABLE_WORDS] - at);
    }
    return bits;
}

const uint32_t *sections_shared(const sections_kind_t *kind, const uint32_t *words,
                                uint32_t damper) {
    const uint32_t count = sections_count(words);
    if (count > 1u && damper >= count) {
        return NULL;
    }
    uint32_t at = SECTIONS_FIRST;
    for (uint32_t i = 0; count > 1u && i < damper; i++) {
        at += kind->size(&words[at], words[TABLE_WORDS] - at);
    }
    return &words[at];
}

uint64_t sections_shared_need(const sections_kind_t *kind, const uint32_t *words) {
    return sections_count(words) > 1u ? sections_need(kind, words)
                                      : VIEW_EACH(kind->needs(sections_first(words), 0));
}
