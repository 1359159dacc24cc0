// Tables that a running node is sent, frame by frame, and what it says of them. The sender is the
// test's own: first and consecutive frames as the standard has them.
#include "can_make.h"
#include "node.h"
#include "plant_pulses.h"
#include "plant_rules.h"
#include "unity.h"
#include "word_crc.h"

#include <stddef.h>
#include <string.h>

#define OP(name) QUIESCE_CAN_SERVICE_REQUEST_OPERATION_##name##_CHOICE
#define NEVER UINT32_MAX
#define MOST_WORDS (TABLE_FILE_HEAD_WORDS + QUIESCE_TABLE_WORDS + 8u)

static node_t node;
static quiesce_params_t params;
static quiesce_board_t board;
static uint32_t file[MOST_WORDS];
static can_frame_t frames[NODE_MAX_FRAMES];
static uint32_t frame_count;
static uint32_t seed;
static uint8_t alive;
static struct {
    uint32_t words[KEEPER_RECORDS][QUIESCE_TABLE_WORDS];
    uint32_t count[KEEPER_RECORDS];
    uint32_t calls;
    keeper_answer_t answer;
} memory;

static uint32_t crc_of(const uint32_t *words, uint32_t count) {
    uint32_t crc = WORD_CRC_START;
    for (uint32_t i = 0; i < count; i++) {
        crc = word_crc_append(crc, words[i]);
    }
    return ~crc;
}

static keeper_answer_t store(void *context, keeper_record_t record, const uint32_t *words,
                             uint32_t count) {
    (void)context;
    memory.calls++;
    if (memory.answer == KEEPER_DONE || memory.answer == KEEPER_BEGUN) {
        memory.count[record] = count;
        for (uint32_t i = 0; i < count; i++) {
            memory.words[record][i] = words[i];
        }
    }
    return memory.answer;
}

static void start(int32_t law) {
    quiesce_params_default(&params);
    params.law = law;
    memset(&node, 0xA5, sizeof node);
    TEST_ASSERT_TRUE(
        node_init(&node, NULL, &params, (node_sources_t){.enable = NODE_ENABLE_BOARD}));
    node_use_store(&node, store, NULL);
}

void setUp(void) {
    memset(&memory, 0, sizeof memory);
    memory.answer = KEEPER_DONE;
    seed = 1;
    alive = 0;
    quiesce_board_default(&board);
    start(QUIESCE_LAW_FUZZY);
}

void tearDown(void) {}

static void tick(void) {
    node_inputs_t inputs = {.enable = node.in.tick > 0, .ticks_elapsed = 1};
    seed = seed * 1664525u + 1013904223u;
    inputs.sensor[0].counts = (int32_t)(seed >> 16) - 32768;
    inputs.sensor[0].is_fresh = true;
    node_step(&node, &inputs);
    const quiesce_params_t *other = node_task(&node);
    if (other != NULL) {
        node_restart(&node, other);
    }
    frame_count = node_frames(&node, frames);
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(NODE_MAX_FRAMES, frame_count);
}

static const can_frame_t *sent(uint32_t id) {
    for (uint32_t i = 0; i < frame_count; i++) {
        if (frames[i].id == id) {
            return &frames[i];
        }
    }
    return NULL;
}

static void run(uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        tick();
    }
}

typedef struct quiesce_can_service_reply_t reply_t;

static reply_t ask(uint32_t operation, uint32_t index, uint32_t value) {
    reply_t reply = {0};
    alive = (uint8_t)((alive + 1u) & 15u);
    const can_frame_t request =
        make_request((uint8_t)operation, (uint8_t)index, (int32_t)value, alive);
    node_receive(&node, &request);
    for (uint32_t i = 0; i < CAN_SERVICE_SAVE_MS + 20u; i++) {
        tick();
        const can_frame_t *frame = sent(QUIESCE_CAN_SERVICE_REPLY_FRAME_ID);
        if (frame != NULL) {
            (void)quiesce_can_service_reply_unpack(&reply, frame->data, frame->length);
            TEST_ASSERT_EQUAL_UINT8(alive, reply.alive);
            return reply;
        }
    }
    TEST_FAIL_MESSAGE("no reply");
    return reply;
}

static uint32_t info(uint32_t road, uint32_t what) {
    const reply_t reply = ask(OP(TABLE_INFO), road, what);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, reply.result);
    return (uint32_t)reply.param_value;
}

// ---- the sender ---------------------------------------------------------------------------------

// The file of a table in file[]; returns its bytes.
static uint32_t pack(const uint32_t *words, uint32_t count, uint32_t for_board) {
    file[0] = 0x31465451u;
    file[1] = for_board;
    file[2] = count;
    file[3] = crc_of(file, 3);
    memcpy(&file[4], words, 4u * count);
    return 16u + 4u * count;
}

static uint8_t byte_at(uint32_t at) {
    return (uint8_t)(file[at / 4u] >> (8u * (at % 4u)));
}

static can_frame_t data_frame(void) {
    return (can_frame_t){.id = QUIESCE_CAN_TABLE_DATA_FRAME_ID, .length = 8};
}

static uint32_t fill(can_frame_t *frame, uint32_t from, uint32_t done, uint32_t bytes) {
    for (uint32_t i = from; i < 8u && done < bytes; i++) {
        frame->data[i] = byte_at(done++);
    }
    return done;
}

static can_frame_t first_frame(uint32_t bytes, uint32_t *done) {
    can_frame_t frame = data_frame();
    frame.data[0] = (uint8_t)(0x10u | (bytes <= 4095u ? bytes >> 8 : 0u));
    frame.data[1] = (uint8_t)(bytes <= 4095u ? bytes & 255u : 0u);
    for (uint32_t i = 0; bytes > 4095u && i < 4u; i++) {
        frame.data[2 + i] = (uint8_t)(bytes >> (24u - 8u * i));
    }
    *done = fill(&frame, bytes <= 4095u ? 2 : 6, 0, bytes);
    return frame;
}

// What happens on the way: the frame (0: the first) that is lost, comes twice, changes places with
// the next one, or has a bit flipped.
typedef struct {
    uint32_t lost, twice, swapped, flipped, cut;
} mishap_t;

static const mishap_t none = {NEVER, NEVER, NEVER, NEVER, NEVER};

static void receive(uint32_t number, can_frame_t frame, const mishap_t *mishap) {
    static can_frame_t held;
    if (number == mishap->flipped) {
        frame.data[4] ^= 0x10u;
    }
    if (number == mishap->swapped) {
        held = frame;
        return;
    }
    if (number != mishap->lost && number < mishap->cut) {
        node_receive(&node, &frame);
        if (number == mishap->twice) {
            node_receive(&node, &frame);
        }
    }
    if (mishap->swapped != NEVER && number == mishap->swapped + 1u) {
        node_receive(&node, &held);
    }
}

// Two ticks a frame, blocks as flow control says. Returns the frames.
static uint32_t transfer(uint32_t bytes, const mishap_t *mishap) {
    uint32_t done;
    uint32_t number = 0;
    uint32_t left = 0;
    receive(number++, first_frame(bytes, &done), mishap);
    while (done < bytes) {
        for (uint32_t ms = 0; left == 0u; ms++) {
            tick();
            const can_frame_t *flow = sent(QUIESCE_CAN_TABLE_FLOW_FRAME_ID);
            if (flow != NULL) {
                TEST_ASSERT_EQUAL_HEX8(0x30, flow->data[0]);
                left = flow->data[1];
            } else if (ms > 5u) { // nobody listens any more: the rest is not heard
                left = NEVER;
            }
        }
        can_frame_t frame = data_frame();
        frame.data[0] = (uint8_t)(0x20u | (number & 15u));
        done = fill(&frame, 1, done, bytes);
        receive(number++, frame, mishap);
        left--;
        run(2);
    }
    return number;
}

static reply_t load(const uint32_t *words, uint32_t count) {
    (void)transfer(pack(words, count, 0), &none);
    return ask(OP(TABLE_COMMIT), 0, words[1]);
}

// ---- tables -------------------------------------------------------------------------------------

static uint32_t rules[QUIESCE_TABLE_WORDS];
static uint32_t rules_count;

static void seal(uint32_t *words, uint32_t count) {
    words[2] = count;
    words[1] = crc_of(&words[2], count - 2u);
}

// The shipped ones, in memory of their own.
static void make_rules(void) {
    rules_count = plant_rules_table[2];
    memcpy(rules, plant_rules_table, 4u * rules_count);
}

// Pulses with another unlock current.
static uint32_t pulses[QUIESCE_TABLE_WORDS];
static uint32_t pulses_count;

static void make_pulses(uint32_t unlock_current_mA) {
    pulses_count = plant_pulses_table[2];
    memcpy(pulses, plant_pulses_table, 4u * pulses_count);
    pulses[4] = unlock_current_mA;
    seal(pulses, pulses_count);
}

static void test_a_table_is_loaded_told_saved_and_reverted(void) {
    start(QUIESCE_LAW_PHASE);
    make_pulses(777);
    TEST_ASSERT_EQUAL_HEX32(plant_pulses_table[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL_UINT32(TABLE_SHIPS, info(ROAD_LAW, TABLE_INFO_SOURCE));
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, load(pulses, pulses_count).result);
    TEST_ASSERT_EQUAL_HEX32(pulses[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL_HEX32(pulses[0], info(ROAD_LAW, TABLE_INFO_MAGIC));
    TEST_ASSERT_EQUAL_UINT32(TABLE_FROM_CAN, info(ROAD_LAW, TABLE_INFO_SOURCE));
    TEST_ASSERT_EQUAL_HEX32(0, info(ROAD_LAW, TABLE_INFO_STORED_CRC));
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_SAVE), ROAD_LAW, 0).result);
    TEST_ASSERT_EQUAL_HEX32(pulses[1], info(ROAD_LAW, TABLE_INFO_STORED_CRC));
    TEST_ASSERT_EQUAL_UINT32(1, info(ROAD_LAW, TABLE_INFO_WRITES));
    TEST_ASSERT_EQUAL_UINT32(pulses_count, memory.count[KEEPER_LAW_TABLE]);
    TEST_ASSERT_EQUAL_MEMORY(pulses, memory.words[KEEPER_LAW_TABLE], 4u * pulses_count);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_REVERT), ROAD_LAW, 0).result);
    TEST_ASSERT_EQUAL_HEX32(plant_pulses_table[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING_TO_SEND, ask(OP(TABLE_REVERT), ROAD_LAW, 0).result);
    TEST_ASSERT_EQUAL_HEX32(pulses[1], info(ROAD_LAW, TABLE_INFO_STORED_CRC)); // still kept
}

static void test_a_saved_table_is_used_after_a_start(void) {
    start(QUIESCE_LAW_PHASE);
    make_pulses(777);
    (void)load(pulses, pulses_count);
    (void)ask(OP(TABLE_SAVE), ROAD_LAW, 0);
    start(QUIESCE_LAW_PHASE);
    const table_found_t found = {KEEPER_LAW_TABLE, TABLE_FROM_STORE, memory.words[KEEPER_LAW_TABLE],
                                 memory.count[KEEPER_LAW_TABLE], 41};
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, node_found(&node, &found));
    TEST_ASSERT_EQUAL_HEX32(pulses[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL_UINT32(TABLE_FROM_STORE, info(ROAD_LAW, TABLE_INFO_SOURCE));
    TEST_ASSERT_EQUAL_UINT32(41, info(ROAD_LAW, TABLE_INFO_WRITES));
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_SHIP), ROAD_LAW, 0).result);
    TEST_ASSERT_EQUAL_UINT32(TABLE_SHIPS, info(ROAD_LAW, TABLE_INFO_SOURCE));
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_SAVE), ROAD_LAW, 0).result);
    TEST_ASSERT_EQUAL_UINT32(0, memory.count[KEEPER_LAW_TABLE]); // forgotten
    TEST_ASSERT_EQUAL_UINT32(42, info(ROAD_LAW, TABLE_INFO_WRITES));
    TEST_ASSERT_EQUAL_HEX32(0, info(ROAD_LAW, TABLE_INFO_STORED_CRC));
}

static void test_a_stored_table_that_is_damaged_is_told_and_not_used(void) {
    start(QUIESCE_LAW_PHASE);
    make_pulses(777);
    pulses[9] ^= 1u;
    const table_found_t found = {KEEPER_LAW_TABLE, TABLE_FROM_STORE, pulses, pulses_count, 7};
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_CRC, node_found(&node, &found));
    TEST_ASSERT_EQUAL_HEX32(plant_pulses_table[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_TABLE_CRC, info(ROAD_LAW, TABLE_INFO_REFUSAL));
}

static table_found_t stored_pulses(void) {
    return (table_found_t){KEEPER_LAW_TABLE, TABLE_FROM_STORE, pulses, pulses_count, 7};
}

static void restart_with(int32_t law) {
    params.law = law;
    node_restart(&node, &params);
}

static void test_a_stored_table_of_another_law_waits_for_it(void) {
    make_pulses(777);
    const table_found_t found = stored_pulses();
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_MAGIC, node_found(&node, &found));
    TEST_ASSERT_EQUAL_HEX32(plant_rules_table[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL_UINT32(TABLE_SHIPS, info(ROAD_LAW, TABLE_INFO_SOURCE));
    TEST_ASSERT_TRUE(
        quiesce_tables_is_waiting(&node.tables.tables, &node.controller, QUIESCE_OF_LAW));
    params.slew_mA_s = 4000; // takes it as little
    restart_with(QUIESCE_LAW_FUZZY);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_TABLE_MAGIC, info(ROAD_LAW, TABLE_INFO_REFUSAL));
    restart_with(QUIESCE_LAW_PHASE);
    TEST_ASSERT_EQUAL_HEX32(pulses[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL_UINT32(TABLE_FROM_STORE, info(ROAD_LAW, TABLE_INFO_SOURCE));
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_TABLE_OK, info(ROAD_LAW, TABLE_INFO_REFUSAL));
    TEST_ASSERT_FALSE(
        quiesce_tables_is_waiting(&node.tables.tables, &node.controller, QUIESCE_OF_LAW));
}

static void test_a_table_that_waits_makes_way_for_one_that_is_loaded(void) {
    make_pulses(777);
    const table_found_t found = stored_pulses();
    (void)node_found(&node, &found);
    make_rules();
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, load(rules, rules_count).result);
    restart_with(QUIESCE_LAW_PHASE);
    TEST_ASSERT_EQUAL_HEX32(plant_pulses_table[1], info(ROAD_LAW, TABLE_INFO_CRC));
    restart_with(QUIESCE_LAW_FUZZY);
    TEST_ASSERT_EQUAL_UINT32(TABLE_FROM_CAN, info(ROAD_LAW, TABLE_INFO_SOURCE));
}

static void test_only_the_first_good_table_waits(void) {
    make_pulses(777);
    table_found_t found = stored_pulses();
    pulses[9] ^= 1u; // damaged: it does not
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_MAGIC, node_found(&node, &found));
    pulses[9] ^= 1u;
    (void)node_found(&node, &found);
    make_pulses(778);
    found.source = TABLE_FROM_CONFIG;
    (void)node_found(&node, &found);
    restart_with(QUIESCE_LAW_PHASE);
    make_pulses(777);
    TEST_ASSERT_EQUAL_HEX32(pulses[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL_UINT32(TABLE_FROM_STORE, info(ROAD_LAW, TABLE_INFO_SOURCE));
}

static void test_how_a_record_was_found_is_told_until_it_is_written_again(void) {
    start(QUIESCE_LAW_PHASE);
    TEST_ASSERT_EQUAL_UINT32(KEEPER_WHOLE, info(ROAD_LAW, TABLE_INFO_RECORD));
    keeper_found_as(&node.tables.keeper, KEEPER_LAW_TABLE, KEEPER_OLDER);
    keeper_found_as(&node.tables.keeper, KEEPER_LEARNT, KEEPER_LOST);
    TEST_ASSERT_EQUAL_UINT32(KEEPER_OLDER, info(ROAD_LAW, TABLE_INFO_RECORD));
    TEST_ASSERT_EQUAL_UINT32(KEEPER_WHOLE, info(ROAD_TRACKER, TABLE_INFO_RECORD));
    TEST_ASSERT_EQUAL_UINT32(KEEPER_LOST, info(ROAD_LEARNT, TABLE_INFO_RECORD));
    memory.answer = KEEPER_FAILED;
    (void)ask(OP(TABLE_SAVE), ROAD_LAW, 0);
    TEST_ASSERT_EQUAL_UINT32(KEEPER_OLDER, info(ROAD_LAW, TABLE_INFO_RECORD));
    memory.answer = KEEPER_DONE;
    (void)ask(OP(TABLE_SAVE), ROAD_LAW, 0);
    TEST_ASSERT_EQUAL_UINT32(KEEPER_WHOLE, info(ROAD_LAW, TABLE_INFO_RECORD));
}

static void test_a_table_of_the_program_takes_the_place_of_what_ships(void) {
    start(QUIESCE_LAW_PHASE);
    make_pulses(777);
    (void)pack(pulses, pulses_count, 0);
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, node_ship(&node, file));
    TEST_ASSERT_EQUAL_HEX32(pulses[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL_UINT32(TABLE_SHIPS, info(ROAD_LAW, TABLE_INFO_SOURCE));
    make_pulses(778);
    const table_found_t found = {KEEPER_LAW_TABLE, TABLE_FROM_STORE, pulses, pulses_count, 7};
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_OK, node_found(&node, &found));
    TEST_ASSERT_EQUAL_HEX32(pulses[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_SHIP), ROAD_LAW, 0).result);
    TEST_ASSERT_EQUAL_HEX32(file[5], info(ROAD_LAW, TABLE_INFO_CRC));
    params.law = QUIESCE_LAW_FUZZY; // works with another kind
    node_restart(&node, &params);
    TEST_ASSERT_EQUAL_HEX32(plant_rules_table[1], info(ROAD_LAW, TABLE_INFO_CRC));
    params.law = QUIESCE_LAW_PHASE;
    node_restart(&node, &params);
    TEST_ASSERT_EQUAL_HEX32(file[5], info(ROAD_LAW, TABLE_INFO_CRC));
}

static void assert_not_shipped(quiesce_table_verdict_t verdict) {
    TEST_ASSERT_EQUAL(verdict, node_ship(&node, file));
    TEST_ASSERT_EQUAL_HEX32(plant_pulses_table[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL_UINT32(verdict, info(ROAD_LAW, TABLE_INFO_REFUSAL));
}

static void test_a_file_of_the_program_that_is_damaged_or_of_another_board_is_told(void) {
    start(QUIESCE_LAW_PHASE);
    make_pulses(777);
    (void)pack(pulses, pulses_count, 5);
    assert_not_shipped(QUIESCE_TABLE_BOARD);
    (void)pack(pulses, pulses_count, 0);
    file[20] ^= 1u;
    assert_not_shipped(QUIESCE_TABLE_CRC);
    file[20] ^= 1u;
    file[3] ^= 1u;
    assert_not_shipped(QUIESCE_TABLE_CRC);
    pulses[0]++;
    (void)pack(pulses, pulses_count, 0);
    assert_not_shipped(QUIESCE_TABLE_MAGIC);
}

// Whatever happens to a frame: what was in use stays, and the next transfer gets through.
static void check_mishap(uint32_t bytes, const mishap_t *mishap, uint32_t in_use_crc) {
    (void)transfer(bytes, mishap);
    const reply_t reply = ask(OP(TABLE_COMMIT), 0, pulses[1]);
    TEST_ASSERT_NOT_EQUAL(CAN_NODE_DONE, reply.result);
    TEST_ASSERT_EQUAL_HEX32(in_use_crc, info(ROAD_LAW, TABLE_INFO_CRC));
}

static void test_mishaps_at_every_frame_leave_the_old_table_in_use(void) {
    start(QUIESCE_LAW_PHASE);
    make_pulses(500);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, load(pulses, pulses_count).result);
    const uint32_t in_use_crc = pulses[1];
    make_pulses(777);
    const uint32_t bytes = pack(pulses, pulses_count, 0);
    const uint32_t count = 1u + (bytes - 6u + 6u) / 7u;
    for (uint32_t i = 0; i < count; i++) {
        mishap_t mishap = none;
        mishap.lost = i;
        check_mishap(bytes, &mishap, in_use_crc);
        mishap = none;
        mishap.flipped = i;
        if (i + 1u < count) { // of the last one the byte is padding
            check_mishap(bytes, &mishap, in_use_crc);
        }
        mishap = none;
        mishap.cut = i;
        check_mishap(bytes, &mishap, in_use_crc);
        mishap = none;
        mishap.twice = i;
        if (i > 0u && i + 1u < count) { // the first begins anew, nothing is heard after the last
            check_mishap(bytes, &mishap, in_use_crc);
        }
        mishap = none;
        mishap.swapped = i;
        if (i + 1u < count) {
            check_mishap(bytes, &mishap, in_use_crc);
        }
    }
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, load(pulses, pulses_count).result);
    TEST_ASSERT_EQUAL_HEX32(pulses[1], info(ROAD_LAW, TABLE_INFO_CRC));
}

static void test_of_two_senders_none_gets_a_mixture_through(void) {
    start(QUIESCE_LAW_PHASE);
    make_pulses(777);
    const uint32_t bytes = pack(pulses, pulses_count, 0);
    for (uint32_t other_begins = 2; other_begins < 40u; other_begins += 3u) {
        uint32_t done;
        uint32_t done_by_other;
        uint32_t number = 1;
        can_frame_t frame = first_frame(bytes, &done);
        node_receive(&node, &frame);
        while (done < bytes) {
            if (number == other_begins) {
                frame = first_frame(bytes, &done_by_other);
                node_receive(&node, &frame);
            }
            frame = data_frame();
            frame.data[0] = (uint8_t)(0x20u | (number++ & 15u));
            done = fill(&frame, 1, done, bytes);
            node_receive(&node, &frame);
            run(1);
        }
        TEST_ASSERT_NOT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_COMMIT), 0, pulses[1]).result);
        TEST_ASSERT_EQUAL_HEX32(plant_pulses_table[1], info(ROAD_LAW, TABLE_INFO_CRC));
    }
}

static void test_a_commit_means_one_table(void) {
    start(QUIESCE_LAW_PHASE);
    make_pulses(777);
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING_RECEIVED, ask(OP(TABLE_COMMIT), 0, pulses[1]).result);
    (void)transfer(pack(pulses, pulses_count, 0), &none);
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING_RECEIVED, ask(OP(TABLE_COMMIT), 0, pulses[1] + 1u).result);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_CHECK), 0, pulses[1]).result);
    TEST_ASSERT_EQUAL_HEX32(plant_pulses_table[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_COMMIT), 0, pulses[1]).result);
    TEST_ASSERT_EQUAL_HEX32(pulses[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING_RECEIVED, ask(OP(TABLE_COMMIT), 0, pulses[1]).result);
}

static void check_refused(uint32_t verdict, reply_t reply) {
    TEST_ASSERT_EQUAL(CAN_NODE_TABLE_REFUSED, reply.result);
    TEST_ASSERT_EQUAL_INT32(verdict, reply.param_value);
    TEST_ASSERT_EQUAL_UINT32(verdict, info(ROAD_LAW, TABLE_INFO_REFUSAL));
}

static void test_refusals_say_why(void) {
    make_pulses(777);
    check_refused(QUIESCE_TABLE_MAGIC, load(pulses, pulses_count)); // the law takes rules
    make_rules();
    rules[3] = UINT32_MAX; // numbers of inputs and outputs
    seal(rules, rules_count);
    check_refused(QUIESCE_TABLE_SHAPE, load(rules, rules_count));
    make_rules();
    rules[rules_count - 1u] ^= 1u; // and the CRC is not made anew
    check_refused(QUIESCE_TABLE_CRC, load(rules, rules_count));
    make_rules();
    (void)transfer(pack(rules, rules_count, 0x1234), &none);
    check_refused(QUIESCE_TABLE_BOARD, ask(OP(TABLE_COMMIT), 0, rules[1]));
    TEST_ASSERT_EQUAL_HEX32(plant_rules_table[1], info(ROAD_LAW, TABLE_INFO_CRC));
}

static void test_a_table_for_this_board_is_taken(void) {
    quiesce_params_default(&params);
    params.law = QUIESCE_LAW_FUZZY;
    TEST_ASSERT_TRUE(
        node_init(&node, &board, &params, (node_sources_t){.enable = NODE_ENABLE_BOARD}));
    const uint32_t crc = crc_of((const uint32_t *)(const void *)&board, sizeof board / 4u);
    TEST_ASSERT_EQUAL_HEX32(crc, info(ROAD_LAW, TABLE_INFO_BOARD));
    make_rules();
    (void)transfer(pack(rules, rules_count, crc), &none);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_COMMIT), 0, rules[1]).result);
}

static void test_numbers_out_of_range_are_refused(void) {
    TEST_ASSERT_EQUAL(CAN_NODE_NO_SUCH_TABLE, ask(OP(TABLE_INFO), ROADS, 0).result);
    TEST_ASSERT_EQUAL(CAN_NODE_NO_SUCH_TABLE, ask(OP(TABLE_INFO), 0, TABLE_INFOS).result);
    TEST_ASSERT_EQUAL(CAN_NODE_NO_SUCH_TABLE, ask(OP(TABLE_INFO), 0, (uint32_t)-1).result);
    TEST_ASSERT_EQUAL(CAN_NODE_NO_SUCH_TABLE, ask(OP(TABLE_REVERT), ROAD_LEARNT, 0).result);
    TEST_ASSERT_EQUAL(CAN_NODE_NO_SUCH_TABLE, ask(OP(TABLE_SHIP), 255, 0).result);
    TEST_ASSERT_EQUAL(CAN_NODE_NO_SUCH_TABLE, ask(OP(TABLE_SAVE), ROADS, 0).result);
    TEST_ASSERT_EQUAL(CAN_NODE_NO_SUCH_TABLE, ask(OP(TABLE_SEND), ROADS, 0).result);
    TEST_ASSERT_EQUAL(CAN_NODE_NO_SUCH_TABLE, ask(OP(TABLE_SHIP), ROAD_TRACKER, 0).result);
}

static void test_a_file_of_the_largest_size_is_heard_and_a_larger_one_is_not(void) {
    static uint32_t words[QUIESCE_TABLE_WORDS + 1u];
    words[0] = plant_rules_table[0];
    seal(words, QUIESCE_TABLE_WORDS);
    (void)transfer(pack(words, QUIESCE_TABLE_WORDS, 0), &none);
    TEST_ASSERT_EQUAL(CAN_NODE_TABLE_REFUSED, ask(OP(TABLE_COMMIT), 0, words[1]).result);
    uint32_t done;
    const can_frame_t first = first_frame(pack(words, QUIESCE_TABLE_WORDS + 1u, 0), &done);
    node_receive(&node, &first);
    tick();
    TEST_ASSERT_NOT_NULL(sent(QUIESCE_CAN_TABLE_FLOW_FRAME_ID));
    TEST_ASSERT_EQUAL_HEX8(0x32, sent(QUIESCE_CAN_TABLE_FLOW_FRAME_ID)->data[0]);
}

static void test_a_table_stays_over_a_restart_and_a_change_of_law_and_back(void) {
    make_rules();
    (void)load(rules, rules_count);
    params.slew_mA_s = 4000;
    node_restart(&node, &params);
    TEST_ASSERT_EQUAL_UINT32(TABLE_FROM_CAN, info(ROAD_LAW, TABLE_INFO_SOURCE));
    params.law = QUIESCE_LAW_PHASE;
    node_restart(&node, &params);
    TEST_ASSERT_EQUAL_HEX32(plant_pulses_table[1], info(ROAD_LAW, TABLE_INFO_CRC));
    TEST_ASSERT_EQUAL_UINT32(TABLE_SHIPS, info(ROAD_LAW, TABLE_INFO_SOURCE));
    params.law = QUIESCE_LAW_FUZZY;
    node_restart(&node, &params);
    TEST_ASSERT_EQUAL_UINT32(TABLE_FROM_CAN, info(ROAD_LAW, TABLE_INFO_SOURCE));
}

static void test_memory_that_is_slow_full_or_missing(void) {
    start(QUIESCE_LAW_PHASE);
    make_pulses(777);
    (void)load(pulses, pulses_count);
    memory.answer = KEEPER_FAILED;
    TEST_ASSERT_EQUAL(CAN_NODE_STORE_FAILED, ask(OP(TABLE_SAVE), ROAD_LAW, 0).result);
    TEST_ASSERT_EQUAL_HEX32(0, info(ROAD_LAW, TABLE_INFO_STORED_CRC));
    memory.answer = KEEPER_BUSY; // for ever
    TEST_ASSERT_EQUAL(CAN_NODE_STORE_FAILED, ask(OP(TABLE_SAVE), ROAD_LAW, 0).result);
    node_use_store(&node, NULL, NULL);
    TEST_ASSERT_EQUAL(CAN_NODE_STORE_FAILED, ask(OP(TABLE_SAVE), ROAD_LAW, 0).result);
    node_use_store(&node, store, NULL);
    memory.answer = KEEPER_BEGUN;
    const can_frame_t request = make_request(OP(TABLE_SAVE), ROAD_LAW, 0, 9);
    node_receive(&node, &request);
    run(300);
    TEST_ASSERT_NULL(sent(QUIESCE_CAN_SERVICE_REPLY_FRAME_ID));
    node_stored(&node, true);
    run(1);
    TEST_ASSERT_NOT_NULL(sent(QUIESCE_CAN_SERVICE_REPLY_FRAME_ID));
    TEST_ASSERT_EQUAL_HEX32(pulses[1], info(ROAD_LAW, TABLE_INFO_STORED_CRC));
}

// Its memory reads the words until it has them, while others arrive and are used.
static void test_a_table_that_is_being_stored_keeps_its_room(void) {
    static uint32_t saved[QUIESCE_TABLE_WORDS];
    start(QUIESCE_LAW_PHASE);
    make_pulses(1);
    (void)load(pulses, pulses_count);
    memcpy(saved, pulses, sizeof saved[0] * pulses_count);
    const uint32_t *const words = quiesce_table_in_use(&node.controller, QUIESCE_OF_LAW);
    memory.answer = KEEPER_BEGUN;
    const can_frame_t request = make_request(OP(TABLE_SAVE), ROAD_LAW, 0, 9);
    node_receive(&node, &request);
    run(10);
    can_node_answer(&node.can, CAN_NODE_STORE_FAILED, 0); // nobody waits for it any more
    run(20);
    for (uint32_t i = 2; i < 8; i++) {
        make_pulses(i);
        TEST_ASSERT_EQUAL(CAN_NODE_DONE, load(pulses, pulses_count).result);
        TEST_ASSERT_EQUAL_HEX32_ARRAY(saved, words, pulses_count);
    }
    node_stored(&node, true);
    TEST_ASSERT_EQUAL_HEX32(saved[1], info(ROAD_LAW, TABLE_INFO_STORED_CRC));
}

// What the node sends, put together; flow control without an end to its blocks.
static uint32_t fetch(uint32_t road, uint8_t *bytes, uint32_t room) {
    const reply_t reply = ask(OP(TABLE_SEND), road, 0);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, reply.result);
    const uint32_t length = (uint32_t)reply.param_value;
    uint32_t done = 0;
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(room, length);
    for (uint32_t ms = 0; done < length; ms++) {
        const can_frame_t *frame = sent(QUIESCE_CAN_TABLE_FLOW_FRAME_ID);
        TEST_ASSERT_LESS_THAN_UINT32(20000, ms);
        if (frame != NULL) {
            const bool is_first = frame->data[0] >> 4 == 1u;
            const uint32_t from = !is_first ? 1u : length > 4095u ? 6u : 2u;
            for (uint32_t i = from; i < 8u && done < length; i++) {
                bytes[done++] = frame->data[i];
            }
            can_frame_t flow = data_frame();
            flow.data[0] = 0x30;
            if (is_first) {
                node_receive(&node, &flow);
            }
        }
        tick();
    }
    return length;
}

static void test_what_is_in_use_is_sent_back_as_its_file(void) {
    static uint8_t bytes[4u * MOST_WORDS];
    start(QUIESCE_LAW_PHASE);
    make_pulses(777);
    (void)load(pulses, pulses_count);
    const uint32_t length = fetch(ROAD_LAW, bytes, sizeof bytes);
    TEST_ASSERT_EQUAL_UINT32(pack(pulses, pulses_count, 0), length);
    TEST_ASSERT_EQUAL_MEMORY(file, bytes, length);
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING_TO_SEND, ask(OP(TABLE_SEND), ROAD_TRACKER, 0).result);
}

// ---- what was learnt ----------------------------------------------------------------------------

static void test_what_was_learnt_is_saved_by_time_and_change(void) {
    start(QUIESCE_LAW_PHASE);
    run(59000);
    TEST_ASSERT_EQUAL_UINT32(0, memory.calls);
    run(1100);
    TEST_ASSERT_EQUAL_UINT32(1, memory.calls);
    TEST_ASSERT_EQUAL_HEX32(TABLE_FILE_LEARNT, memory.words[KEEPER_LEARNT][0]);
    run(300000); // nothing has been learnt since
    TEST_ASSERT_EQUAL_UINT32(1, memory.calls);
    TEST_ASSERT_EQUAL_UINT32(1, info(ROAD_LEARNT, TABLE_INFO_WRITES));
    node.tables.keeper.kept[KEEPER_LEARNT].mark = 1; // as if it had
    run(60001);
    TEST_ASSERT_EQUAL_UINT32(2, memory.calls);
    node.tables.keeper.kept[KEEPER_LEARNT].mark = 1;
    run(230000); // four minutes by now
    TEST_ASSERT_EQUAL_UINT32(2, memory.calls);
    run(11000);
    TEST_ASSERT_EQUAL_UINT32(3, memory.calls);
}

static void test_what_was_learnt_travels_as_a_table(void) {
    static uint8_t bytes[4u * MOST_WORDS];
    start(QUIESCE_LAW_PHASE);
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING_TO_SEND, ask(OP(LEARNT_RESTORE), 0, 0).result);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_SAVE), ROAD_LEARNT, 0).result);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(LEARNT_RESTORE), 0, 0).result);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(LEARNT_FORGET), 0, 0).result);
    const uint32_t length = fetch(ROAD_LEARNT, bytes, sizeof bytes);
    memcpy(file, bytes, length);
    (void)transfer(length, &none);
    const uint32_t crc = file[5];
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_CHECK), 0, crc).result);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_COMMIT), 0, crc).result);
    make_pulses(777);
    (void)load(pulses, pulses_count); // what was learnt is of other pulses now
    memcpy(file, bytes, length);
    (void)transfer(length, &none);
    const reply_t reply = ask(OP(TABLE_COMMIT), 0, crc);
    TEST_ASSERT_EQUAL(CAN_NODE_TABLE_REFUSED, reply.result);
    TEST_ASSERT_EQUAL_INT32(QUIESCE_TABLE_FIT, reply.param_value);
    start(QUIESCE_LAW_FUZZY);
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING_TO_SEND, ask(OP(TABLE_SEND), ROAD_LEARNT, 0).result);
    TEST_ASSERT_EQUAL(CAN_NODE_NOTHING_TO_SEND, ask(OP(TABLE_SAVE), ROAD_LEARNT, 0).result);
}

// What was fetched before has nothing to do with what has come since.
static void test_a_restart_drops_no_file_that_has_come(void) {
    static uint8_t bytes[4u * MOST_WORDS];
    start(QUIESCE_LAW_PHASE);
    (void)fetch(ROAD_LEARNT, bytes, sizeof bytes);
    make_pulses(777);
    (void)transfer(pack(pulses, pulses_count, 0), &none);
    params.slew_mA_s = 4000;
    node_restart(&node, &params);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_COMMIT), 0, pulses[1]).result);
}

static void test_a_restart_gives_up_what_is_fetched(void) {
    start(QUIESCE_LAW_PHASE);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_SEND), ROAD_LEARNT, 0).result);
    run(3);
    params.slew_mA_s = 4000;
    node_restart(&node, &params);
    for (uint32_t i = 0; i < 1500u; i++) {
        tick();
        TEST_ASSERT_NULL(sent(QUIESCE_CAN_TABLE_FLOW_FRAME_ID));
    }
}

// A law that learns nothing does not cost what another one has learnt.
static void test_what_was_learnt_waits_for_its_law(void) {
    static uint32_t words[QUIESCE_TABLE_WORDS];
    start(QUIESCE_LAW_PHASE);
    TEST_ASSERT_EQUAL(CAN_NODE_DONE, ask(OP(TABLE_SAVE), ROAD_LEARNT, 0).result);
    const uint32_t count = memory.count[KEEPER_LEARNT];
    memcpy(words, memory.words[KEEPER_LEARNT], 4u * count);
    words[7] += 5u; // a trim that a start does not have by itself
    words[4] = crc_of(&words[5], count - 5u);
    seal(words, count);
    const table_found_t found = {KEEPER_LEARNT, TABLE_FROM_STORE, words, count, 1};
    start(QUIESCE_LAW_FUZZY);
    TEST_ASSERT_EQUAL(QUIESCE_TABLE_FIT, node_found(&node, &found));
    run(61000); // it is looked at whether there is something to store
    restart_with(QUIESCE_LAW_PHASE);
    TEST_ASSERT_EQUAL_HEX32(words[1], info(ROAD_LEARNT, TABLE_INFO_CRC));
    restart_with(QUIESCE_LAW_FUZZY);
    restart_with(QUIESCE_LAW_PHASE);
    TEST_ASSERT_EQUAL_HEX32(words[1], info(ROAD_LEARNT, TABLE_INFO_CRC));
}

// ---- while it runs ------------------------------------------------------------------------------

static void test_an_armed_controller_takes_a_table_without_a_bump(void) {
    start(QUIESCE_LAW_PHASE);
    run(3000);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, node.out.telemetry.state);
    make_pulses(1900);
    const int32_t most_mA = (params.slew_mA_s + 999) / 1000;
    (void)transfer(pack(pulses, pulses_count, 0), &none);
    const can_frame_t request = make_request(OP(TABLE_COMMIT), 0, (int32_t)pulses[1], 3);
    node_receive(&node, &request);
    int32_t before_mA = node.out.damper[0].current_cmd_mA;
    for (uint32_t i = 0; i < 2000u; i++) {
        tick();
        const int32_t now_mA = node.out.damper[0].current_cmd_mA;
        TEST_ASSERT_INT32_WITHIN(most_mA, before_mA, now_mA);
        before_mA = now_mA;
    }
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_RUN, node.out.telemetry.state);
    TEST_ASSERT_EQUAL_HEX32(pulses[1], info(ROAD_LAW, TABLE_INFO_CRC));
}

static void test_a_table_that_changes_by_itself_is_a_fault(void) {
    start(QUIESCE_LAW_PHASE);
    make_pulses(777);
    (void)load(pulses, pulses_count);
    run(2000);
    uint32_t *words = (uint32_t *)(uintptr_t)quiesce_table_in_use(&node.controller, QUIESCE_OF_LAW);
    words[20] ^= 4u;
    run(1000);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_MEMORY, node.out.telemetry.fault);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_table_is_loaded_told_saved_and_reverted);
    RUN_TEST(test_a_saved_table_is_used_after_a_start);
    RUN_TEST(test_a_stored_table_that_is_damaged_is_told_and_not_used);
    RUN_TEST(test_a_stored_table_of_another_law_waits_for_it);
    RUN_TEST(test_a_table_that_waits_makes_way_for_one_that_is_loaded);
    RUN_TEST(test_only_the_first_good_table_waits);
    RUN_TEST(test_how_a_record_was_found_is_told_until_it_is_written_again);
    RUN_TEST(test_a_table_of_the_program_takes_the_place_of_what_ships);
    RUN_TEST(test_a_file_of_the_program_that_is_damaged_or_of_another_board_is_told);
    RUN_TEST(test_mishaps_at_every_frame_leave_the_old_table_in_use);
    RUN_TEST(test_of_two_senders_none_gets_a_mixture_through);
    RUN_TEST(test_a_commit_means_one_table);
    RUN_TEST(test_refusals_say_why);
    RUN_TEST(test_a_table_for_this_board_is_taken);
    RUN_TEST(test_numbers_out_of_range_are_refused);
    RUN_TEST(test_a_file_of_the_largest_size_is_heard_and_a_larger_one_is_not);
    RUN_TEST(test_a_table_stays_over_a_restart_and_a_change_of_law_and_back);
    RUN_TEST(test_memory_that_is_slow_full_or_missing);
    RUN_TEST(test_a_table_that_is_being_stored_keeps_its_room);
    RUN_TEST(test_what_is_in_use_is_sent_back_as_its_file);
    RUN_TEST(test_what_was_learnt_is_saved_by_time_and_change);
    RUN_TEST(test_what_was_learnt_travels_as_a_table);
    RUN_TEST(test_what_was_learnt_waits_for_its_law);
    RUN_TEST(test_a_restart_drops_no_file_that_has_come);
    RUN_TEST(test_a_restart_gives_up_what_is_fetched);
    RUN_TEST(test_an_armed_controller_takes_a_table_without_a_bump);
    RUN_TEST(test_a_table_that_changes_by_itself_is_a_fault);
    return UNITY_END();
}
