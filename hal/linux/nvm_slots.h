/// A record with its room on the disk: a file of two slots that are written in place, in
/// turn. Once it is there no write needs more room, or a right to the folder.
///
/// A write replaces the older slot and leaves the newer one alone. Where a slot is damaged, a write
/// was cut off (a power cut; what the kernel has taken from a process that is killed it keeps):
/// that is told, not mended, because only the user knows which of the two records is the safe one.
#ifndef NVM_SLOTS_H
#define NVM_SLOTS_H

#include "linux_error.h"
#include "nvm_file.h"

#define NVM_SLOT_BYTES 2048u ///< of a record's data, at most

typedef struct {
    int fd; ///< -1: not open
    char kind[8];
    size_t bytes;
    uint32_t sequence; ///< of the newer slot
    uint32_t newer;
} nvm_slots_t;

/// Reads the newer record. NVM_DAMAGED: the file is another one, or one of the slots is damaged.
nvm_verdict_t nvm_slots_read(const char *path, const char *kind, void *data, size_t bytes,
                             linux_error_t *error);

/// Opens the file for writing. Where it is missing or damaged another takes its place, as a whole
/// or not at all, with this record in both slots. Returns false iff that cannot be done.
bool nvm_slots_open(nvm_slots_t *slots, const char *path, const char *kind, const void *data,
                    size_t bytes, linux_error_t *error);
void nvm_slots_close(nvm_slots_t *slots);

/// Waits for the disk. Returns false, with errno, iff it refused.
bool nvm_slots_write(nvm_slots_t *slots, const void *data);

/// Whether the path still leads to this file: another program may have removed it.
bool nvm_slots_are_at(const nvm_slots_t *slots, const char *path);

#endif
