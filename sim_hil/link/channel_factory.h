/// Makes the channel that --can names: one line in channel_factory.cpp adds a kind.
#ifndef QUIESCE_CHANNEL_FACTORY_H
#define QUIESCE_CHANNEL_FACTORY_H

#include <memory>
#include <string>

#include "frame_channel.h"

namespace quiesce {

/// channel:
///   slcan:/dev/pts/5              serial line or pty
///   slcan:unix:can.sock           Unix socket that someone listens on
///   slcan:tcp:localhost:5556      TCP port that someone listens on
///   slcan:fd:5                    descriptor that this program was started with, such as a pty's
///   socketcan:can0                interface of this machine
/// A serial line may be followed by ,baud=N (of the line) and ,bitrate=N (of the bus; the adapter
/// is told to set it and to open). Throws InputError where the text is none of these, the message
/// lists them, and where the channel cannot be opened.
std::unique_ptr<FrameChannel> open_channel(const std::string &channel);

} // namespace quiesce

#endif
