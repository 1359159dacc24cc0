/// Mailbox in RAM that the emulator shares with the bench (words only, little-endian, no padding).
///
/// One side writes its part and then its sequence word; the other spins on that word. A request is
/// new when request_seq differs from reply_seq; the target copies the request's number when its
/// reply is complete. All words are 0 when the image starts.
#ifndef MAILBOX_H
#define MAILBOX_H

#include "lockstep.h"

/// Base of mps2-an386's 16 MiB PSRAM, which QEMU backs with a shared file.
#define MAILBOX_BASE 0x21000000u
#define MAILBOX_BYTES (16u * 1024u * 1024u)

#define MAILBOX_START 1u ///< params, board, tables -> status 1 accepted, 0 refused; what
#define MAILBOX_STEP 2u  ///< stimulus -> reply
#define MAILBOX_STOP 3u  ///< stack_used_bytes; the image ends

typedef struct {
    uint32_t request_seq;
    uint32_t reply_seq;
    uint32_t operation;
    uint32_t status;
    uint32_t layout_bytes;     ///< sizeof(mailbox_t) in the image; 0 until it runs
    uint32_t stack_used_bytes; ///< high-water mark, valid after MAILBOX_STOP
    lockstep_stimulus_t stimulus;
    lockstep_reply_t reply;
    quiesce_params_t params;
    uint32_t has_board; ///< 0: the parameters say what is wired
    quiesce_board_t board;
    lockstep_refusal_t refused;                           ///< by the last start
    uint32_t table_words[LOCKSTEP_TABLES];                ///< 0: there is none
    uint32_t table[LOCKSTEP_TABLES][QUIESCE_TABLE_WORDS]; ///< in use until the next start
} mailbox_t;

#endif
