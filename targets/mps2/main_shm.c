// Lock-step image for the shared-RAM link: serves the mailbox until it is told to stop.
#include "mailbox.h"
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

static void start(mailbox_t *box, lockstep_t *server) {
    const lockstep_table_t tables[LOCKSTEP_TABLES] = {
        {box->table[LOCKSTEP_LAW_TABLE], box->table_words[LOCKSTEP_LAW_TABLE]},
        {box->table[LOCKSTEP_TRACKER_TABLE], box->table_words[LOCKSTEP_TRACKER_TABLE]},
    };
    const quiesce_board_t *board = box->has_board != 0 ? &box->board : NULL;
    box->status = lockstep_start(server, board, &box->params, tables) ? 1u : 0u;
    box->refused = server->refused;
}

static void serve(mailbox_t *box, lockstep_t *server) {
    switch (box->operation) {
    case MAILBOX_STEP:
        lockstep_exchange(server, &box->stimulus, &box->reply);
        break;
    case MAILBOX_START:
        start(box, server);
        break;
    case MAILBOX_STOP:
        box->stack_used_bytes = stack_high_water_bytes();
        break;
    default:
        box->status = 0;
        break;
    }
}

int main(void) {
    static lockstep_t server;
    mailbox_t *const box = (mailbox_t *)MAILBOX_BASE;
    uint32_t operation;

    box->layout_bytes = sizeof *box;
    do {
        wait_for_request(box);
        operation = box->operation;
        serve(box, &server);
        __atomic_store_n(&box->reply_seq, box->request_seq, __ATOMIC_RELEASE);
    } while (operation != MAILBOX_STOP);
    return 0;
}
