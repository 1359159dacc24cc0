#include "quiesce.h"

#include <stddef.h>

#include "controller_tables.h"
#include "crc32.h"
#include "table.h"

#define SHIPPED QUIESCE_TABLE_ROOMS

// How free a room is: 2 nothing is kept there, 1 the table before the one in use, 0 the one in use,
// or somebody reads it.
static uint32_t freedom(const quiesce_tables_t *tables, uint32_t room) {
    uint32_t least = room == tables->held ? 0u : 2u;
    for (uint32_t i = 0; i < QUIESCE_TABLE_OWNERS; i++) {
        const uint32_t by = tables->of[i].now == room ? 0u : tables->of[i].before == room ? 1u : 2u;
        least = by < least ? by : least;
    }
    return least;
}

// Where what arrives next goes: the first of the freest. SHIPPED: nowhere.
static uint32_t free_room(const quiesce_tables_t *tables) {
    uint32_t found = SHIPPED;
    uint32_t most = 0;
    for (uint32_t room = 0; room < QUIESCE_TABLE_ROOMS; room++) {
        const uint32_t freed = freedom(tables, room);
        if (freed > most) {
            found = room;
            most = freed;
        }
    }
    return found;
}

static void forget_arrival(quiesce_tables_t *tables) {
    tables->filled = 0;
    tables->summed = 0;
    tables->crc = 0;
}

static bool begin_arrival(quiesce_tables_t *tables) {
    const uint32_t room = free_room(tables);
    if (room == SHIPPED) {
        return false;
    }
    for (uint32_t i = 0; i < QUIESCE_TABLE_OWNERS; i++) {
        if (tables->of[i].before == room) {
            tables->of[i].before = tables->of[i].now; // there is none to go back to
        }
    }
    tables->arrival = room;
    forget_arrival(tables);
    return true;
}

void quiesce_tables_init(quiesce_tables_t *tables) {
    for (uint32_t i = 0; i < QUIESCE_TABLE_OWNERS; i++) {
        tables->of[i].now = SHIPPED;
        tables->of[i].before = SHIPPED;
        tables->of[i].shipped = NULL;
    }
    tables->arrival = 0;
    tables->held = SHIPPED;
    forget_arrival(tables);
}

void quiesce_tables_hold(quiesce_tables_t *tables, const uint32_t *words) {
    tables->held = SHIPPED;
    for (uint32_t room = 0; room < QUIESCE_TABLE_ROOMS; room++) {
        if (words == tables->words[room]) {
            tables->held = room;
        }
    }
}

bool quiesce_tables_have_room(const quiesce_tables_t *tables) {
    return free_room(tables) != SHIPPED;
}

uint32_t *quiesce_tables_room(quiesce_tables_t *tables) {
    (void)begin_arrival(tables);
    return tables->words[tables->arrival];
}

void quiesce_tables_ship(quiesce_tables_t *tables, const uint32_t *words) {
    quiesce_owner_t owner;
    if (quiesce_table_kind(words[TABLE_MAGIC], &owner) != NULL) {
        tables->of[owner].shipped = words;
    }
}

bool quiesce_tables_write(quiesce_tables_t *tables, uint32_t offset, const uint32_t *words,
                          uint32_t count) {
    if ((offset != 0 && offset != tables->filled) || count > QUIESCE_TABLE_WORDS ||
        offset > QUIESCE_TABLE_WORDS - count) {
        return false;
    }
    if (offset == 0 && !begin_arrival(tables)) {
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        tables->words[tables->arrival][offset + i] = words[i];
    }
    tables->filled = offset + count;
    return true;
}

bool quiesce_tables_sum(quiesce_tables_t *tables, uint32_t words) {
    const uint32_t from = tables->summed > TABLE_SUMMED_FROM ? tables->summed : TABLE_SUMMED_FROM;
    if (tables->filled <= from) {
        return true;
    }
    const uint32_t left = tables->filled - from;
    const uint32_t count = left < words ? left : words;
    tables->crc = crc32_continue(tables->crc, &tables->words[tables->arrival][from], count);
    tables->summed = from + count;
    return tables->summed == tables->filled;
}

const uint32_t *quiesce_tables_arrival(const quiesce_tables_t *tables, uint32_t *count) {
    *count = tables->filled;
    return tables->words[tables->arrival];
}

// The arrival, summed to its end. Returns whether its CRC is right.
static bool is_whole(quiesce_tables_t *tables) {
    (void)quiesce_tables_sum(tables, QUIESCE_TABLE_WORDS);
    return tables->filled >= TABLE_HEAD_WORDS &&
           tables->words[tables->arrival][TABLE_CRC] == tables->crc;
}

// Damage is told by the full check, which finds what else is wrong first.
quiesce_table_verdict_t quiesce_tables_check(quiesce_tables_t *tables, const quiesce_t *self) {
    return controller_check_table(self, tables->words[tables->arrival], tables->filled,
                                  is_whole(tables));
}

// What a revert goes back to: a room whose words law and tracker did not take is none.
static uint32_t room_in_use(const quiesce_tables_t *tables, const quiesce_t *self,
                            quiesce_owner_t owner) {
    return quiesce_tables_is_loaded(tables, self, owner) ? tables->of[owner].now : SHIPPED;
}

quiesce_table_verdict_t quiesce_tables_commit(quiesce_tables_t *tables, quiesce_t *self) {
    const uint32_t *words = tables->words[tables->arrival];
    uint32_t before[QUIESCE_TABLE_OWNERS];
    for (uint32_t i = 0; i < QUIESCE_TABLE_OWNERS; i++) {
        before[i] = room_in_use(tables, self, (quiesce_owner_t)i);
    }
    quiesce_owner_t owner;
    const quiesce_table_verdict_t verdict =
        controller_use_table(self, words, tables->filled, is_whole(tables));
    if (verdict == QUIESCE_TABLE_OK && quiesce_table_kind(words[TABLE_MAGIC], &owner) != NULL) {
        tables->of[owner].before = before[owner];
        tables->of[owner].now = tables->arrival;
    }
    forget_arrival(tables);
    return verdict;
}

bool quiesce_tables_keep(quiesce_tables_t *tables) {
    const uint32_t *words = tables->words[tables->arrival];
    quiesce_owner_t owner;
    if (quiesce_table_check(words, tables->filled) != QUIESCE_TABLE_OK ||
        quiesce_table_kind(words[TABLE_MAGIC], &owner) == NULL ||
        tables->of[owner].now != SHIPPED) {
        return false;
    }
    tables->of[owner].now = tables->arrival;
    forget_arrival(tables);
    return true;
}

// Returns false iff nobody takes what is there.
static bool use_room(const quiesce_tables_t *tables, quiesce_t *self, quiesce_owner_t owner,
                     uint32_t room) {
    const uint32_t *words = room == SHIPPED ? tables->of[owner].shipped : tables->words[room];
    if (words != NULL && quiesce_table_use(self, words, words[TABLE_WORDS]) == QUIESCE_TABLE_OK) {
        return true;
    }
    return room == SHIPPED && quiesce_table_drop(self, owner);
}

bool quiesce_tables_revert(quiesce_tables_t *tables, quiesce_t *self, quiesce_owner_t owner) {
    const uint32_t before = tables->of[owner].before;
    if (before == tables->of[owner].now || !use_room(tables, self, owner, before)) {
        return false;
    }
    tables->of[owner].now = before;
    return true;
}

bool quiesce_tables_unload(quiesce_tables_t *tables, quiesce_t *self, quiesce_owner_t owner) {
    if (!use_room(tables, self, owner, SHIPPED)) {
        return false;
    }
    if (tables->of[owner].now != SHIPPED) {
        tables->of[owner].before = tables->of[owner].now;
        tables->of[owner].now = SHIPPED;
    }
    return true;
}

void quiesce_tables_resume(const quiesce_tables_t *tables, quiesce_t *self) {
    for (uint32_t i = 0; i < QUIESCE_TABLE_OWNERS; i++) {
        const quiesce_owner_t owner = (quiesce_owner_t)i;
        if (!use_room(tables, self, owner, tables->of[owner].now)) {
            (void)use_room(tables, self, owner, SHIPPED);
        }
    }
}

bool quiesce_tables_is_loaded(const quiesce_tables_t *tables, const quiesce_t *self,
                              quiesce_owner_t owner) {
    const uint32_t now = tables->of[owner].now;
    return now != SHIPPED && quiesce_table_in_use(self, owner) == tables->words[now];
}

bool quiesce_tables_is_waiting(const quiesce_tables_t *tables, const quiesce_t *self,
                               quiesce_owner_t owner) {
    return tables->of[owner].now != SHIPPED && !quiesce_tables_is_loaded(tables, self, owner);
}
