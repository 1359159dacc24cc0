// The image's side of the mailbox: waits for a request, has it served, answers.
#ifndef MAILBOX_SERVER_H
#define MAILBOX_SERVER_H

#include "mailbox.h"

/// Does what box->operation asks for, but for MAILBOX_STOP, which it may add to.
typedef void (*mailbox_serve_t)(mailbox_t *box);

/// Until MAILBOX_STOP has been served. layout_bytes: of all that the two sides share.
void mailbox_run(mailbox_t *box, uint32_t layout_bytes, mailbox_serve_t serve);

/// The tables of a start.
void mailbox_tables(const mailbox_t *box, lockstep_table_t tables[LOCKSTEP_TABLES]);

/// Its board; NULL: the parameters say what is wired.
const quiesce_board_t *mailbox_board(const mailbox_t *box);

/// Its answer.
void mailbox_started(mailbox_t *box, bool is_accepted, lockstep_refusal_t refused);

#endif
