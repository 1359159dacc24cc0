// What the image says of itself.
#include "board.h"
#include "image_info.h"
#include "quiesce_params.h"
#include "quiesce_version.h"
#include "shipped.h"

#define VERSION(major, minor, patch) ((major)*0x10000u + (minor)*0x100u + (patch))

extern const uint8_t image_begin[]; // image.ld

// All ones: unsealed. `quiesce firmware build` writes over it.
__attribute__((section(".image_seal"), used)) static const uint8_t seal[SHA256_BYTES] = {
    0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF,
    0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF,
};

__attribute__((section(".image_info"), used)) const image_info_t image_info = {
    .magic = IMAGE_INFO_MAGIC,
    .layout = IMAGE_INFO_LAYOUT,
    .version = VERSION(QUIESCE_VERSION_MAJOR, QUIESCE_VERSION_MINOR, QUIESCE_VERSION_PATCH),
    .param_layout = QUIESCE_PARAM_LAYOUT,
    .begin = image_begin,
    .seal = seal,
    .board = &stm32f4_board.name,
    .tables = shipped_tables,
};
