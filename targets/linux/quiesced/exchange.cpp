#include "exchange.h"

#include <cerrno>
#include <system_error>

#include <sys/eventfd.h>
#include <unistd.h>

namespace quiesced {

Exchange::Exchange() : wake_fd(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (wake_fd < 0) {
        throw std::system_error(errno, std::generic_category(), "eventfd");
    }
}

Exchange::~Exchange() {
    close(wake_fd);
}

void Exchange::wake() const {
    const std::uint64_t one = 1;
    const ssize_t ignored = write(wake_fd, &one, sizeof one);
    (void)ignored;
}

} // namespace quiesced
