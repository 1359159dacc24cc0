// Tables of a law and of its tracker in one set of rooms: what one does leaves the other's, over
// restarts and other laws, and in any order (against a model that keeps copies).
#include <stddef.h>
#include <string.h>

#include "quiesce.h"
#include "table_samples.h"
#include "unity.h"

enum { STEPS = 20000, SHIPS = 0, KINDS = 3, A_KIND = 3, SAMPLES = 1 + KINDS * A_KIND };
enum { SAMPLE_WORDS = 400, OF_RULES = 0, OF_FRICTION, OF_MAP, OF_BANK, OF_NONE };

static quiesce_t controller;
static quiesce_params_t params;
static quiesce_tables_t tables;
static uint32_t sample[SAMPLES][SAMPLE_WORDS]; // by kind; none of number SHIPS
static uint32_t seed;

static uint32_t random_below(uint32_t limit) {
    seed = seed * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)(seed ^ seed >> 15) * limit >> 32);
}

static uint32_t number_of(uint32_t kind, uint32_t which) {
    return 1u + kind * A_KIND + which;
}

static uint32_t kind_of(uint32_t number) {
    return (number - 1u) / A_KIND;
}

static quiesce_owner_t owner_of(uint32_t number) {
    return kind_of(number) == OF_MAP ? QUIESCE_OF_TRACKER : QUIESCE_OF_LAW;
}

void setUp(void) {
    seed = 1;
    for (uint32_t i = 0; i < A_KIND; i++) {
        (void)sample_rules(sample[number_of(OF_RULES, i)], 500 + (int32_t)i);
        (void)sample_friction(sample[number_of(OF_FRICTION, i)], 50000 + i);
        (void)sample_map(sample[number_of(OF_MAP, i)], 700000 + i);
    }
    quiesce_params_default(&params);
    params.law = QUIESCE_LAW_FRICTION;
    params.tracker = QUIESCE_TRACKER_INVERSE;
    TEST_ASSERT_TRUE(quiesce_init(&controller, &params));
    quiesce_tables_init(&tables);
}
void tearDown(void) {}

static const uint32_t *in_use(quiesce_owner_t owner) {
    return quiesce_table_in_use(&controller, owner);
}

static quiesce_table_verdict_t commit(void) {
    return quiesce_tables_commit(&tables, &controller);
}

static bool revert(quiesce_owner_t owner) {
    return quiesce_tables_revert(&tables, &controller, owner);
}

static void write_all(const uint32_t *words, uint32_t count) {
    TEST_ASSERT_TRUE(quiesce_tables_write(&tables, 0, words, count));
}

static void receive(uint32_t number) {
    write_all(sample[number], sample[number][TABLE_WORDS]);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit());
}

// Restarts, and puts back what was in use.
static void go_on_with(int32_t law, int32_t tracker) {
    params.law = law;
    params.tracker = tracker;
    TEST_ASSERT_TRUE(quiesce_restart(&controller, NULL, &params));
    quiesce_tables_resume(&tables, &controller);
}

static void expect_loaded(quiesce_owner_t owner, uint32_t number) {
    TEST_ASSERT_EQUAL_INT(number != SHIPS, quiesce_tables_is_loaded(&tables, &controller, owner));
    if (number != SHIPS) {
        TEST_ASSERT_EQUAL_MEMORY(sample[number], in_use(owner),
                                 sample[number][TABLE_WORDS] * sizeof(uint32_t));
    }
}

static void expect(uint32_t of_law, uint32_t of_tracker) {
    expect_loaded(QUIESCE_OF_LAW, of_law);
    expect_loaded(QUIESCE_OF_TRACKER, of_tracker);
}

// ---- law and tracker ----------------------------------------------------------------------------

static void test_each_has_its_own_table_and_the_one_before(void) {
    const uint32_t law = number_of(OF_FRICTION, 0);
    const uint32_t map = number_of(OF_MAP, 0);
    TEST_ASSERT_EQUAL_STRING("friction", quiesce_lacks_table(&controller));
    receive(law);
    TEST_ASSERT_EQUAL_STRING("inverse", quiesce_lacks_table(&controller));
    receive(map);
    TEST_ASSERT_NULL(quiesce_lacks_table(&controller));
    receive(map + 1u);
    receive(law + 1u);
    receive(map + 2u);
    expect(law + 1u, map + 2u);
    TEST_ASSERT_TRUE(revert(QUIESCE_OF_LAW));
    expect(law, map + 2u);
    TEST_ASSERT_TRUE(revert(QUIESCE_OF_TRACKER));
    expect(law, map + 1u);
    TEST_ASSERT_TRUE(quiesce_tables_unload(&tables, &controller, QUIESCE_OF_LAW));
    expect(SHIPS, map + 1u);
    TEST_ASSERT_EQUAL_STRING("friction", quiesce_lacks_table(&controller));
    TEST_ASSERT_FALSE(revert(QUIESCE_OF_TRACKER));
    expect(SHIPS, map + 1u);
    TEST_ASSERT_TRUE(revert(QUIESCE_OF_LAW));
    expect(law, map + 1u);
    TEST_ASSERT_TRUE(quiesce_tables_unload(&tables, &controller, QUIESCE_OF_TRACKER));
    expect(law, SHIPS);
    TEST_ASSERT_NULL(in_use(QUIESCE_OF_TRACKER));
}

static void test_a_map_of_the_program_ships(void) {
    const uint32_t map = number_of(OF_MAP, 0);
    quiesce_tables_ship(&tables, sample[map]);
    quiesce_tables_resume(&tables, &controller);
    TEST_ASSERT_EQUAL_PTR(sample[map], in_use(QUIESCE_OF_TRACKER));
    TEST_ASSERT_NULL(in_use(QUIESCE_OF_LAW));
    receive(map + 1u);
    TEST_ASSERT_TRUE(quiesce_tables_unload(&tables, &controller, QUIESCE_OF_TRACKER));
    TEST_ASSERT_EQUAL_PTR(sample[map], in_use(QUIESCE_OF_TRACKER));
    // Another law keeps what it ships with.
    go_on_with(QUIESCE_LAW_FUZZY, QUIESCE_TRACKER_INVERSE);
    const uint32_t *shipped = in_use(QUIESCE_OF_LAW);
    quiesce_tables_ship(&tables, sample[number_of(OF_FRICTION, 0)]);
    quiesce_tables_resume(&tables, &controller);
    TEST_ASSERT_EQUAL_PTR(shipped, in_use(QUIESCE_OF_LAW));
    go_on_with(QUIESCE_LAW_FRICTION, QUIESCE_TRACKER_INVERSE);
    TEST_ASSERT_NULL(quiesce_lacks_table(&controller));
}

// Also where one is loaded that another law takes.
static void test_what_the_program_ships_is_used_where_what_is_loaded_is_not(void) {
    const uint32_t *linked = sample[number_of(OF_RULES, 0)];
    quiesce_tables_ship(&tables, linked);
    receive(number_of(OF_FRICTION, 0));
    go_on_with(QUIESCE_LAW_FUZZY, QUIESCE_TRACKER_INVERSE);
    TEST_ASSERT_EQUAL_PTR(linked, in_use(QUIESCE_OF_LAW));
    go_on_with(QUIESCE_LAW_FRICTION, QUIESCE_TRACKER_INVERSE);
    expect(number_of(OF_FRICTION, 0), SHIPS);
}

// ---- restarts -----------------------------------------------------------------------------------

static void test_a_restart_goes_on_with_what_was_loaded(void) {
    const uint32_t law = number_of(OF_FRICTION, 0);
    const uint32_t map = number_of(OF_MAP, 0);
    receive(law);
    receive(law + 1u);
    receive(map);
    TEST_ASSERT_TRUE(quiesce_restart(&controller, NULL, &params));
    expect(SHIPS, SHIPS);
    quiesce_tables_resume(&tables, &controller);
    expect(law + 1u, map);
    TEST_ASSERT_TRUE(revert(QUIESCE_OF_LAW));
    expect(law, map);
}

static void test_a_change_of_law_and_back_finds_the_tables_again(void) {
    const uint32_t law = number_of(OF_FRICTION, 0);
    const uint32_t map = number_of(OF_MAP, 0);
    receive(law);
    receive(map);
    go_on_with(QUIESCE_LAW_FUZZY, QUIESCE_TRACKER_INVERSE);
    expect(SHIPS, SHIPS);
    TEST_ASSERT_NOT_NULL(in_use(QUIESCE_OF_LAW)); // what it ships with
    go_on_with(QUIESCE_LAW_OFF, QUIESCE_TRACKER_INVERSE);
    TEST_ASSERT_NULL(in_use(QUIESCE_OF_LAW));
    TEST_ASSERT_FALSE(quiesce_tables_unload(&tables, &controller, QUIESCE_OF_LAW));
    TEST_ASSERT_FALSE(revert(QUIESCE_OF_LAW));
    go_on_with(QUIESCE_LAW_FRICTION, QUIESCE_TRACKER_BANK);
    expect(law, SHIPS);
    go_on_with(QUIESCE_LAW_FRICTION, QUIESCE_TRACKER_INVERSE);
    expect(law, map);
}

// What was in use before the commit is what the law ships with: the other law's table was not.
static void test_another_laws_table_is_none_to_go_back_to(void) {
    receive(number_of(OF_FRICTION, 0));
    go_on_with(QUIESCE_LAW_FUZZY, QUIESCE_TRACKER_INVERSE);
    const uint32_t *shipped = in_use(QUIESCE_OF_LAW);
    receive(number_of(OF_RULES, 0));
    TEST_ASSERT_TRUE(revert(QUIESCE_OF_LAW));
    TEST_ASSERT_EQUAL_PTR(shipped, in_use(QUIESCE_OF_LAW));
    TEST_ASSERT_FALSE(revert(QUIESCE_OF_LAW));
}

// ---- sums in slices -----------------------------------------------------------------------------

static void write_in_slices(const uint32_t *words, uint32_t count) {
    for (uint32_t at = 0, part = 0; at < count; at += part) {
        part = 1u + random_below(40);
        part = part < count - at ? part : count - at;
        TEST_ASSERT_TRUE(quiesce_tables_write(&tables, at, words + at, part));
        const uint32_t slice = random_below(60);
        const uint32_t summed = tables.summed;
        const bool are_all = quiesce_tables_sum(&tables, slice);
        TEST_ASSERT_EQUAL_INT(are_all,
                              at + part <= TABLE_SUMMED_FROM || tables.summed == at + part);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(slice + TABLE_SUMMED_FROM, tables.summed - summed);
    }
}

static void expect_same_verdict(const uint32_t *words, uint32_t count) {
    static quiesce_t other;
    other = controller;
    const quiesce_table_verdict_t verdict = quiesce_table_use(&other, words, count);
    write_in_slices(words, count);
    TEST_ASSERT_EQUAL_INT(verdict, quiesce_tables_check(&tables, &controller));
    TEST_ASSERT_EQUAL_INT(verdict, commit());
}

// Damage at each word, with the old CRC and with one that is right again.
static void expect_same_verdicts(const uint32_t *good) {
    static uint32_t words[SAMPLE_WORDS];
    const uint32_t count = good[TABLE_WORDS];
    memcpy(words, good, count * sizeof words[0]);
    expect_same_verdict(words, count);
    for (uint32_t at = 0; at < count; at++) {
        words[at] ^= 1u << random_below(32);
        expect_same_verdict(words, count);
        words[TABLE_WORDS] = count;
        sample_seal(words);
        expect_same_verdict(words, count);
        memcpy(words, good, count * sizeof words[0]);
    }
    expect_same_verdict(words, count - 1u);
}

static void test_sums_in_slices_say_what_one_sum_says(void) {
    expect_same_verdicts(sample[number_of(OF_FRICTION, 0)]);
    expect_same_verdicts(sample[number_of(OF_MAP, 0)]);
    go_on_with(QUIESCE_LAW_FUZZY, QUIESCE_TRACKER_INVERSE);
    expect_same_verdicts(sample[number_of(OF_RULES, 0)]);
}

// Nothing to sum is summed.
static void test_the_first_words_need_no_sum(void) {
    TEST_ASSERT_TRUE(quiesce_tables_sum(&tables, 0));
    for (uint32_t count = 1; count <= TABLE_SUMMED_FROM; count++) {
        write_all(sample[number_of(OF_MAP, 0)], count);
        TEST_ASSERT_TRUE(quiesce_tables_sum(&tables, 0));
    }
    write_all(sample[number_of(OF_MAP, 0)], TABLE_SUMMED_FROM + 1u);
    TEST_ASSERT_FALSE(quiesce_tables_sum(&tables, 0));
    TEST_ASSERT_TRUE(quiesce_tables_sum(&tables, 1));
}

// A commit between two ticks does not sum what has been summed: another word is not noticed.
static void test_what_is_summed_is_not_summed_again(void) {
    const uint32_t *words = sample[number_of(OF_FRICTION, 0)];
    write_all(words, words[TABLE_WORDS] - 1u);
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_SIZE, commit());
    write_all(words, words[TABLE_WORDS]);
    TEST_ASSERT_TRUE(quiesce_tables_sum(&tables, words[TABLE_WORDS]));
    tables.words[tables.arrival][4]++;
    TEST_ASSERT_EQUAL_INT(QUIESCE_TABLE_OK, commit());
    TEST_ASSERT_EQUAL_UINT32(words[4] + 1u, in_use(QUIESCE_OF_LAW)[4]);
}

// ---- any order ----------------------------------------------------------------------------------

// What ought to be where, as numbers of samples.
static struct {
    struct {
        uint32_t now, before;
        bool is_new; // and not gone back from
        const uint32_t *shipped;
    } of[QUIESCE_TABLE_OWNERS];
    uint32_t arriving, arrived; // which, and its words so far
    bool is_spoilt;
} model;

static uint32_t kind_taken(quiesce_owner_t owner) {
    const bool is_friction = params.law == QUIESCE_LAW_FRICTION;
    if (owner == QUIESCE_OF_TRACKER && is_friction) {
        return params.tracker == QUIESCE_TRACKER_INVERSE ? OF_MAP : OF_BANK;
    }
    if (owner == QUIESCE_OF_TRACKER) {
        return OF_NONE;
    }
    return is_friction ? OF_FRICTION : params.law == QUIESCE_LAW_OFF ? OF_NONE : OF_RULES;
}

static bool is_taken(quiesce_owner_t owner, uint32_t number) {
    const uint32_t kind = kind_taken(owner);
    return number == SHIPS ? kind != OF_NONE : kind == kind_of(number);
}

static uint32_t now_of(quiesce_owner_t owner) {
    const uint32_t now = model.of[owner].now;
    return is_taken(owner, now) ? now : SHIPS;
}

static void restart(void) {
    static const int32_t laws[] = {QUIESCE_LAW_FRICTION, QUIESCE_LAW_FRICTION, QUIESCE_LAW_FUZZY,
                                   QUIESCE_LAW_FUZZY_SELFTUNE, QUIESCE_LAW_OFF};
    params.law = laws[random_below(5)];
    params.tracker = random_below(4) == 0 ? QUIESCE_TRACKER_BANK : QUIESCE_TRACKER_INVERSE;
    TEST_ASSERT_TRUE(quiesce_restart(&controller, NULL, &params));
    for (uint32_t i = 0; i < QUIESCE_TABLE_OWNERS; i++) {
        model.of[i].shipped = in_use((quiesce_owner_t)i);
    }
    quiesce_tables_resume(&tables, &controller);
}

// A part that follows the last one, or the first of another table; now and then in a wrong place.
static void write_some(void) {
    static uint32_t words[SAMPLE_WORDS];
    TEST_ASSERT_FALSE(
        quiesce_tables_write(&tables, model.arrived + 1u + random_below(9), words, 1));
    if (model.arriving == SHIPS || random_below(12) == 0) {
        model.arriving = 1u + random_below(SAMPLES - 1u);
        model.arrived = 0;
        model.is_spoilt = random_below(5) == 0;
        memcpy(words, sample[model.arriving], sizeof words);
        words[random_below(words[TABLE_WORDS])] ^= model.is_spoilt ? 1u << random_below(32) : 0u;
    }
    const uint32_t left = sample[model.arriving][TABLE_WORDS] - model.arrived;
    const uint32_t part = random_below(2) == 0 ? left : random_below(left + 1u);
    TEST_ASSERT_TRUE(quiesce_tables_write(&tables, model.arrived, words + model.arrived, part));
    model.arrived += part;
}

static bool is_acceptable(void) {
    return model.arriving != SHIPS && !model.is_spoilt &&
           model.arrived == sample[model.arriving][TABLE_WORDS] &&
           is_taken(owner_of(model.arriving), model.arriving);
}

static uint32_t commit_it(void) {
    const bool is_good = is_acceptable();
    const quiesce_owner_t owner = is_good ? owner_of(model.arriving) : QUIESCE_OF_LAW;
    TEST_ASSERT_EQUAL_INT(is_good, quiesce_tables_check(&tables, &controller) == QUIESCE_TABLE_OK);
    TEST_ASSERT_EQUAL_INT(is_good, commit() == QUIESCE_TABLE_OK);
    if (is_good) {
        model.of[owner].before = now_of(owner);
        model.of[owner].now = model.arriving;
        model.of[owner].is_new = true;
    }
    model.arriving = SHIPS;
    model.arrived = 0;
    return is_good ? 1u : 0u;
}

static uint32_t revert_it(quiesce_owner_t owner) {
    const uint32_t before = model.of[owner].before;
    const bool is_done = model.of[owner].is_new && is_taken(owner, before);
    TEST_ASSERT_EQUAL_INT(is_done, revert(owner));
    if (is_done) {
        model.of[owner].now = before;
        model.of[owner].is_new = false;
    }
    return is_done ? 1u : 0u;
}

static void unload_it(quiesce_owner_t owner) {
    const bool is_done = is_taken(owner, SHIPS);
    TEST_ASSERT_EQUAL_INT(is_done, quiesce_tables_unload(&tables, &controller, owner));
    if (is_done && model.of[owner].now != SHIPS) {
        model.of[owner].before = model.of[owner].now;
        model.of[owner].now = SHIPS;
        model.of[owner].is_new = true;
    }
}

static void expect_model(void) {
    for (uint32_t i = 0; i < QUIESCE_TABLE_OWNERS; i++) {
        const quiesce_owner_t owner = (quiesce_owner_t)i;
        expect_loaded(owner, now_of(owner));
        if (now_of(owner) == SHIPS) {
            TEST_ASSERT_EQUAL_PTR(model.of[i].shipped, in_use(owner));
        }
    }
}

// However tables come and go, no room is written that is in use or gone back to.
static void test_tables_come_and_go_in_any_order(void) {
    uint32_t committed = 0;
    uint32_t reverted = 0;
    memset(&model, 0, sizeof model);
    restart();
    for (uint32_t step = 0; step < STEPS; step++) {
        const quiesce_owner_t owner = random_below(2) == 0 ? QUIESCE_OF_LAW : QUIESCE_OF_TRACKER;
        switch (random_below(16)) {
        case 0:
            restart();
            break;
        case 1:
            unload_it(owner);
            break;
        case 2:
        case 3:
            reverted += revert_it(owner);
            break;
        case 4:
        case 5:
            committed += commit_it();
            break;
        case 6:
            (void)quiesce_tables_sum(&tables, random_below(200));
            break;
        default:
            write_some();
            break;
        }
        expect_model();
    }
    TEST_ASSERT_GREATER_THAN_UINT32(STEPS / 50, committed);
    TEST_ASSERT_GREATER_THAN_UINT32(STEPS / 100, reverted);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_each_has_its_own_table_and_the_one_before);
    RUN_TEST(test_a_map_of_the_program_ships);
    RUN_TEST(test_what_the_program_ships_is_used_where_what_is_loaded_is_not);
    RUN_TEST(test_a_restart_goes_on_with_what_was_loaded);
    RUN_TEST(test_a_change_of_law_and_back_finds_the_tables_again);
    RUN_TEST(test_another_laws_table_is_none_to_go_back_to);
    RUN_TEST(test_sums_in_slices_say_what_one_sum_says);
    RUN_TEST(test_the_first_words_need_no_sum);
    RUN_TEST(test_what_is_summed_is_not_summed_again);
    RUN_TEST(test_tables_come_and_go_in_any_order);
    return UNITY_END();
}
