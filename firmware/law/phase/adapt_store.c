#include "adapt_store.h"

#include "crc32.h"

enum { CRC_WORD = 1, OWNER_WORD = 2, TRIM_WORD = 4 };

static uint32_t crc_of(const uint32_t *words) {
    return crc32_words(&words[OWNER_WORD], ADAPT_STORE_WORDS - OWNER_WORD);
}

void adapt_store(const adapt_t *self, adapt_owner_t owner, uint32_t *words) {
    words[0] = ADAPT_STORE_MAGIC;
    words[OWNER_WORD] = owner.table_crc;
    words[OWNER_WORD + 1] = owner.setting;
    for (uint32_t i = 0; i < ADAPT_POINTS; i++) {
        const int16_t *value = self->trim[i].value;
        words[TRIM_WORD + 2u * i] = (uint32_t)(uint16_t)value[ADAPT_ON_EDGE] |
                                    (uint32_t)(uint16_t)value[ADAPT_OFF_EDGE] << 16;
        words[TRIM_WORD + 2u * i + 1u] =
            (uint32_t)(uint16_t)value[ADAPT_LEVEL] | (uint32_t)(uint16_t)value[ADAPT_WHOLE] << 16;
    }
    words[CRC_WORD] = crc_of(words);
}

static adapt_trim_t trim_of(const uint32_t *words, uint32_t point) {
    const uint32_t edges = words[TRIM_WORD + 2u * point];
    adapt_trim_t trim;
    trim.value[ADAPT_ON_EDGE] = (int16_t)(uint16_t)edges;
    trim.value[ADAPT_OFF_EDGE] = (int16_t)(uint16_t)(edges >> 16);
    const uint32_t rest = words[TRIM_WORD + 2u * point + 1u];
    trim.value[ADAPT_LEVEL] = (int16_t)(uint16_t)rest;
    trim.value[ADAPT_WHOLE] = (int16_t)(uint16_t)(rest >> 16);
    return trim;
}

bool adapt_restore(adapt_t *self, adapt_owner_t owner, const uint32_t *words) {
    if (words[0] != ADAPT_STORE_MAGIC || words[CRC_WORD] != crc_of(words) ||
        words[OWNER_WORD] != owner.table_crc || words[OWNER_WORD + 1] != owner.setting) {
        return false;
    }
    for (uint32_t i = 0; i < ADAPT_POINTS; i++) {
        const adapt_trim_t trim = trim_of(words, i);
        if (!adapt_is_allowed(&self->cfg, &trim)) {
            return false;
        }
    }
    adapt_clear(self); // a search, and where its last move came from, belong to what was there
    for (uint32_t i = 0; i < ADAPT_POINTS; i++) {
        self->trim[i] = trim_of(words, i);
    }
    return true;
}
