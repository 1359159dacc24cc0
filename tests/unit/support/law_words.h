// Good tables to begin with, one a kind that does not ship one, and a damper's map. Their heads are
// made by law_trial_seal.
#ifndef LAW_WORDS_H
#define LAW_WORDS_H

#include <stddef.h>
#include <stdint.h>

typedef struct {
    const uint32_t *words;
    uint32_t count;
} law_words_t;

#define LAW_WORDS(name)                                                                            \
    { name, sizeof name / sizeof name[0] }

// One state, two inputs, two rows of different dampers.
static const uint32_t linear_words[] = {
    0x314E4C51,
    0,
    0,
    1000,
    1,
    2,
    2, // rate, states, inputs, rows
    0x001,
    1000000,
    9,
    0x104,
    2000000,
    8, // velocity of a body, of a stroke
    10,
    (uint32_t)-5,
    700,
    (uint32_t)-90, // shift, and its change
    0,
    12,
    500000,
    4000,
    (uint32_t)-3000,
    2000, // damper, shift, limit, coefficients
    3,
    11,
    900000,
    (uint32_t)-8000,
    16000000,
    50,
};
// Two sections; the second has one sign.
static const uint32_t
    signs_words[] =
        {
            0x31475351, 0,   0,     2,       2,       2, 100,   0x001,
            1000000,    9,   0x004, 1000000, 9, // inputs, signs, idle; the inputs
            512000,     0,   1000,  0,       512000,  3, 0,     1000, // band, shift, coefficients
            2000,       100, 200,   1900,    1,       1, 0,     0x105,
            5000000,    5,   70,    2,       8000000, 0, 20000,
};
static const uint32_t friction_words[] = {
    0x31524651, 0,      0,          2, 50000,
    1000,       800000, 200,        3, // gain, least peak, limit, band, ways
    1000000,    0,      1000000000, 0, 1,
};
// I of a stroke and its velocity.
static const uint32_t polynomial_words[] = {
    0x314C5051, 0,          0,       1,          2,
    3,          0x003,      1000000, 9,          1,
    0x004,      1000000,    9,       0, // inputs, terms; the inputs
    256000,     0x00000001, 512000,  0x00000102, (uint32_t)-128000,
    0x00000300,
};
// Two rules of a stroke's velocity, a straight line each (sealed, too, within).
static const uint32_t fuzzy_signals_words[] = {
    0x31534651, 0,          0,          1,          1,          1,          0x5C,       4,
    0xF4240,    0xA,        0,          0,          0x21,       0x31545A46, 0x895D3772, 0x5C,
    0x1C0201,   0xC040010,  0,          0,          0,          0x20040,    0x4A,       0x54,
    0,          0,          0x10000000, 0x1F400,    0,          0xF9E57FFF, 0x80000000, 0,
    1,          0x80000000, 0x10000000, 0,          0,          0,          0,          0,
    0,          0xFFFFFFFF, 0xF9E58000, 4,          2,          0x8573FFFE, 0x10000000, 0xEB074A77,
    0,          0x7A8C0001, 0,          0x14F8B589, 1,          0x61A7FFF,  0,          4,
    2,          0x8573FFFE, 0x8000000,  0xEB074A77, 0,          0x7A8C0001, 0x8000000,  0x14F8B589,
    1,          0x7FFFFFFF, 0x61A8000,  0,          1,          0x80000000, 0x10000000, 0,
    1,          0,          0,          0,          0,          0x1080000,  0,          0,
    0xFFFF0000, 0x1080000,  1,          0,          0xFFFF0101, 0,          0x3E800,    0x200,
    0,          0x1F400,    0,          0x48,       0,          0,          0,          1,
    0x83126F,   0x200,      0,          0xFFDF3B64, 0,          0x52,       0,          1,
    0,
};
// Of one section, over stroke velocity.
static const uint32_t map_words[] = {
    0x32464D51,
    0,
    0,
    1,
    4,
    4,
    3, // sections, axis, places, currents
    (uint32_t)-200000,
    (uint32_t)-1000,
    1000,
    200000, // um/s
    0,
    700,
    1500, // mA
    (uint32_t)-90000,
    (uint32_t)-400000,
    (uint32_t)-700000,
    (uint32_t)-20000,
    (uint32_t)-300000,
    (uint32_t)-500000,
    20000,
    300000,
    500000,
    90000,
    400000,
    700000,
};

// A stop, a saturation that leads, a dashpot; a spring.
static const uint32_t bank_words[] = {
    0x314B4251, 0,
    0,          1,
    3,          3,
    1000,       4,    // sections, elements, currents, rate, shift
    500000,     3000, // the lead
    0,          0,
    10000,      1,
    1073741824, 50000,
    0,          100000000,
    1073741823, // leads, leak, limit
    0,          (uint32_t)-900,
    1,          16,
    8,          0, // current, offset, spring, weights
    700,        200,
    2,          80,
    8,          4,
    1500,       0,
    0,          160,
    8,          8,
};

static const law_words_t law_words[] = {
    LAW_WORDS(linear_words),     LAW_WORDS(signs_words),         LAW_WORDS(friction_words),
    LAW_WORDS(polynomial_words), LAW_WORDS(fuzzy_signals_words),
};
static const law_words_t map_of_damper = LAW_WORDS(map_words);
static const law_words_t bank_of_damper = LAW_WORDS(bank_words);

// Of a kind, by its magic. words is NULL where there are none.
static inline law_words_t law_words_of(uint32_t magic) {
    for (size_t i = 0; i < sizeof law_words / sizeof law_words[0]; i++) {
        if (law_words[i].words[0] == magic) {
            return law_words[i];
        }
    }
    return (law_words_t){NULL, 0};
}

#endif
