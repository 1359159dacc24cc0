/// Opens the streams that SLCAN is spoken on. Every function throws InputError, one line that
/// begins with name, where it cannot.
#ifndef QUIESCE_STREAM_OPENERS_H
#define QUIESCE_STREAM_OPENERS_H

#include <cstdint>
#include <memory>
#include <string>

#include "byte_stream.h"

namespace quiesce {

/// Serial line or pty, taken raw (no echo, no line discipline). baud: 0 leaves it as it is.
std::unique_ptr<ByteStream> open_serial_line(const std::string &path, std::uint32_t baud,
                                             const std::string &name);

/// Unix socket that someone listens on.
std::unique_ptr<ByteStream> open_unix_socket(const std::string &path, const std::string &name);

/// TCP port (number or service) that someone listens on.
std::unique_ptr<ByteStream> open_tcp_socket(const std::string &host, const std::string &port,
                                            const std::string &name);

} // namespace quiesce

#endif
