/// Non-volatile memory as a file: a checksummed record that is replaced as a whole or not at all
/// (write aside, fsync, rename, fsync of the folder).
#ifndef NVM_FILE_H
#define NVM_FILE_H

#include "linux_error.h"

#include <stddef.h>
#include <stdint.h>

#define NVM_MAX_BYTES 16384u ///< of a record's data

typedef enum {
    NVM_OK = 0,
    NVM_MISSING = 1, ///< there is no such file: start from defaults
    NVM_DAMAGED = 2, ///< wrong magic, version, length or checksum: it is left where it is
    NVM_FAILED = 3,  ///< the system refused
} nvm_verdict_t;

/// Reads the record of a kind ("param", at most 8 characters) and version into data, which has
/// exactly bytes.
nvm_verdict_t nvm_file_read(const char *path, const char *kind, uint32_t version, void *data,
                            size_t bytes, linux_error_t *error);

/// Replaces it; takes as long as the disk does, so not in a tick. Returns false iff it could not:
/// what was there before is then still there, unless the error says that only a power cut may
/// bring it back.
bool nvm_file_write(const char *path, const char *kind, uint32_t version, const void *data,
                    size_t bytes, linux_error_t *error);

/// Makes the renaming of a file in its folder last. Returns false, with errno, iff it cannot.
bool nvm_sync_folder(const char *path);

#endif
