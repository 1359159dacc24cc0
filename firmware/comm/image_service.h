/// Requests about the program itself (operations IMAGE_.. of ServiceRequest): another image comes
/// in pieces over TableData, into a place of the target's that does not run, and is tried at the
/// next start. Refused while armed, and while a fault is latched, which the restart would forget;
/// from its first piece to its end nothing can be armed or driven, nor while an image is on trial.
#ifndef IMAGE_SERVICE_H
#define IMAGE_SERVICE_H

#include "can_service.h"
#include "table_link.h"

#ifdef __cplusplus
extern "C" {
#endif

/// The first word of a piece, which comes as a table does: then CRC-32 of what follows, the number
/// of words in all, the place of its first word in the image, and the image's words.
#define IMAGE_PIECE_MAGIC UINT32_C(0x31504951) ///< "QIP1"
#define IMAGE_PIECE_HEAD_WORDS 4u
#define IMAGE_PIECE_WORDS 1024u ///< of the image, at the most; places are multiples of 4

/// An update from which nothing comes for so long is given up, and a store that has not erased by
/// then.
#define IMAGE_SERVICE_QUIET_MS 30000u

/// IMAGE_INFO's param_index.
typedef enum {
    IMAGE_INFO_VERSION = 0,  ///< of the one that runs: major << 16 | minor << 8 | patch
    IMAGE_INFO_SLOT = 1,     ///< where it lies, 0 or 1
    IMAGE_INFO_MARK = 2,     ///< first word of its seal
    IMAGE_INFO_IS_TRIAL = 3, ///< it has not confirmed itself
    IMAGE_INFO_OTHER = 4,    ///< state of the other place: slot_state_t
    IMAGE_INFO_BEGIN = 5,    ///< address of the other place
    IMAGE_INFO_ROOM = 6,     ///< bytes for an image there
    IMAGE_INFO_BOARD = 7,    ///< CRC-32 of the board's name
    IMAGE_INFO_WORDS = 8,    ///< that have been written so far
    IMAGE_INFOS
} image_info_number_t;

typedef enum {
    IMAGE_STORE_FAILED = 0,
    IMAGE_STORE_DONE = 1,
    IMAGE_STORE_BUSY = 2, ///< ask again in the next tick
    IMAGE_STORE_REFUSED = 3,
} image_store_answer_t;

/// The target's. Each returns at once; nothing else is asked for until it is not BUSY.
typedef struct {
    void *context;
    /// Makes the other place empty.
    image_store_answer_t (*prepare)(void *context);
    /// Words of the image, at most IMAGE_PIECE_WORDS, which stay where they are.
    image_store_answer_t (*write)(void *context, uint32_t at, const uint32_t *words,
                                  uint32_t count);
    /// All of it is there: REFUSED where it is not whole, or not for this board or place.
    image_store_answer_t (*finish)(void *context);
    /// By IMAGE_INFO_.. .
    uint32_t (*tell)(void *context, image_info_number_t what);
    /// The program is started again, once the reply has had the time to leave.
    void (*start)(void *context);
} image_store_t;

typedef enum {
    IMAGE_STAGE_NONE = 0,
    IMAGE_STAGE_ERASES, ///< to its end, whoever waits for it
    IMAGE_STAGE_OPEN,   ///< pieces may come
    IMAGE_STAGE_FINISHED,
} image_stage_t;

struct image_work;
typedef struct image_service image_service_t;

struct image_service {
    const image_store_t *store; ///< NULL: there is no other place
    /// image_service_work and image_service_go_on, which a program without places need not hold.
    bool (*work)(image_service_t *self, const struct image_work *work, can_node_result_t *result,
                 int32_t *value);
    void (*go_on)(image_service_t *self, uint32_t passed_ms);
    image_stage_t stage;
    bool is_awaited; ///< an erasure, by a request
    bool is_starting;
    bool is_held; ///< by the target: on trial
    image_store_answer_t erased;
    uint32_t written;  ///< words
    uint32_t quiet_ms; ///< left
};

/// Zeros: there is no other place.
void image_service_use(image_service_t *self, const image_store_t *store);

/// What a request is worked on with.
typedef struct image_work {
    const can_service_request_t *request;
    table_link_t *link;
    quiesce_tables_t *tables; ///< of which the room for what arrives
    bool is_armed;
    bool has_latched_fault;
} image_work_t;

/// Works on a request, once a tick. Returns true once *result and *value are its reply.
bool image_service_work(image_service_t *self, const image_work_t *work, can_node_result_t *result,
                        int32_t *value);

/// There is no request any more.
static inline void image_service_rest(image_service_t *self) {
    self->is_awaited = false;
}

/// Once a tick, of one that erases or is open.
void image_service_go_on(image_service_t *self, uint32_t passed_ms);

/// An update has begun, and has neither ended nor been given up.
static inline bool image_service_is_under_way(const image_service_t *self) {
    return self->stage == IMAGE_STAGE_ERASES || self->stage == IMAGE_STAGE_OPEN;
}

/// Once a tick: what was begun goes on, and time passes.
static inline void image_service_pass(image_service_t *self, uint32_t passed_ms) {
    if (image_service_is_under_way(self)) {
        self->go_on(self, passed_ms);
    }
}

/// Nothing may be armed or driven.
static inline bool image_service_holds(const image_service_t *self) {
    return image_service_is_under_way(self) || self->is_starting || self->is_held;
}

#ifdef __cplusplus
}
#endif

#endif
