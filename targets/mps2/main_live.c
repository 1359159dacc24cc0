// The controller with its CAN interface behind the mailbox: what a rig in the computer has on its
// bus. Each tick takes what has come and leaves what it sends.
#include "mailbox_live.h"
#include "mailbox_server.h"

_Static_assert(NODE_MAX_FRAMES <= MAILBOX_MAX_FRAMES, "a tick's frames have room");

static lockstep_node_t server;

static void start(mailbox_t *box) {
    lockstep_table_t tables[LOCKSTEP_TABLES];
    mailbox_tables(box, tables);
    const bool is_accepted = lockstep_node_start(&server, mailbox_board(box), &box->params, tables);
    mailbox_started(box, is_accepted, server.refused);
}

static void step(mailbox_live_t *live) {
    for (uint32_t i = 0; i < live->heard && i < MAILBOX_MAX_FRAMES; i++) {
        node_receive(&server.node, &live->heard_frame[i]);
    }
    live->said = lockstep_node_exchange(&server, &live->plain.stimulus, &live->pace,
                                        &live->plain.reply, live->said_frame);
}

static void serve(mailbox_t *box) {
    mailbox_live_t *const live = (mailbox_live_t *)MAILBOX_BASE;
    switch (box->operation) {
    case MAILBOX_STEP:
        step(live);
        break;
    case MAILBOX_START:
        start(box);
        break;
    case MAILBOX_STOP:
        live->said = node_farewell(&server.node, live->said_frame);
        break;
    default:
        box->status = 0;
        break;
    }
    live->tick_rate_Hz = (uint32_t)server.node.params.tick_rate_Hz;
}

int main(void) {
    mailbox_run((mailbox_t *)MAILBOX_BASE, sizeof(mailbox_live_t), serve);
    return 0;
}
