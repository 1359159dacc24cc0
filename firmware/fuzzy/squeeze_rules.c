#include "squeeze_rules.h"

// Output singletons by their index: 0, 1.25, 2.5, 3.75, 5 A.
enum { ZERO, SMALL, MIDDLE, LARGE, FULL };

const fuzzy_table_t squeeze_rules = {
    .row =
        {
            FUZZY_LEFT_SHOULDER(5000000, 10000000),
            FUZZY_TRIANGLE(5000000, 10000000, 15000000),
            FUZZY_TRIANGLE(10000000, 15000000, 20000000),
            FUZZY_RIGHT_SHOULDER(15000000, 20000000),
        },
    .column =
        {
            FUZZY_LEFT_SHOULDER(50000, 150000),
            FUZZY_TRIANGLE(50000, 150000, 300000),
            FUZZY_TRIANGLE(150000, 300000, 450000),
            FUZZY_RIGHT_SHOULDER(300000, 450000),
        },
    .rule =
        {
            {ZERO, ZERO, ZERO, ZERO},
            {FULL, FULL, FULL, FULL},
            {FULL, FULL, FULL, FULL},
            {FULL, FULL, FULL, FULL},
        },
    .singleton_mA = {[ZERO] = 0, [SMALL] = 1250, [MIDDLE] = 2500, [LARGE] = 3750, [FULL] = 5000},
    .default_mA = 0,
};
