#include "mailbox_server.h"

#include "nap.h"
#include "stack.h"

#include <stddef.h>

/// Polls of the request before the image naps: far longer than a bench takes that has a processor.
#define POLLS_BEFORE_NAP 10000u
#define NAP_US 50u

static bool has_request(const mailbox_t *box) {
    return __atomic_load_n(&box->request_seq, __ATOMIC_ACQUIRE) != box->reply_seq;
}

static void wait_for_request(const mailbox_t *box) {
    for (uint32_t poll = 0; poll < POLLS_BEFORE_NAP; poll++) {
        if (has_request(box)) {
            return;
        }
    }
    while (!has_request(box)) {
        nap_us(NAP_US);
    }
}

void mailbox_tables(const mailbox_t *box, lockstep_table_t tables[LOCKSTEP_TABLES]) {
    for (uint32_t i = 0; i < LOCKSTEP_TABLES; i++) {
        tables[i] = (lockstep_table_t){box->table[i], box->table_words[i]};
    }
}

const quiesce_board_t *mailbox_board(const mailbox_t *box) {
    return box->has_board != 0 ? &box->board : NULL;
}

void mailbox_started(mailbox_t *box, bool is_accepted, lockstep_refusal_t refused) {
    box->status = is_accepted ? 1u : 0u;
    box->refused = refused;
}

void mailbox_run(mailbox_t *box, uint32_t layout_bytes, mailbox_serve_t serve) {
    uint32_t operation;
    box->layout_bytes = layout_bytes;
    do {
        wait_for_request(box);
        operation = box->operation;
        serve(box);
        if (operation == MAILBOX_STOP) {
            box->stack_used_bytes = stack_high_water_bytes();
        }
        __atomic_store_n(&box->reply_seq, box->request_seq, __ATOMIC_RELEASE);
    } while (operation != MAILBOX_STOP);
}
