// Two places for an image in a file that is the flash of a board with boot code, for can_peer: what
// runs is always the same program, and calls itself what the image says that was started.
#ifndef IMAGE_PEER_H
#define IMAGE_PEER_H

#include "images.h"
#include "node.h"

// file: 512 KiB. board: its name. bad: a version that ends as soon as it is started, 0: none.
// Returns false where the file cannot be used.
bool image_peer_open(const char *file, const char *board, unsigned bad);

// What boot code and image do at a start. Returns false where no image runs.
bool image_peer_start(node_t *node);

// Returns whether it is to be started again.
bool image_peer_tick(node_t *node);

#endif
