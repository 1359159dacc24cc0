// Lock-step image for the shared-RAM link: serves the mailbox until it is told to stop.
#include "mailbox_server.h"

static lockstep_t server;

static void start(mailbox_t *box) {
    lockstep_table_t tables[LOCKSTEP_TABLES];
    mailbox_tables(box, tables);
    const bool is_accepted = lockstep_start(&server, mailbox_board(box), &box->params, tables);
    mailbox_started(box, is_accepted, server.refused);
}

static void serve(mailbox_t *box) {
    switch (box->operation) {
    case MAILBOX_STEP:
        lockstep_exchange(&server, &box->stimulus, &box->reply);
        break;
    case MAILBOX_START:
        start(box);
        break;
    case MAILBOX_STOP:
        break;
    default:
        box->status = 0;
        break;
    }
}

int main(void) {
    mailbox_t *const box = (mailbox_t *)MAILBOX_BASE;
    mailbox_run(box, sizeof *box, serve);
    return 0;
}
