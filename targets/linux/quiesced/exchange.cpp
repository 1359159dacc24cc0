#include "exchange.h"

#include <cerrno>
#include <system_error>

#include <new>

#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

namespace quiesced {

namespace {

using SharedWord = std::atomic<std::uint32_t>;
static_assert(SharedWord::is_always_lock_free, "two processes share it");

SharedWord &make_shared_word() {
    void *page = mmap(nullptr, sizeof(SharedWord), PROT_READ | PROT_WRITE,
                      MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (page == MAP_FAILED) {
        throw std::system_error(errno, std::generic_category(), "shared memory");
    }
    return *new (page) SharedWord(QUIESCE_FAULT_NONE);
}

} // namespace

Exchange::Exchange()
    : latched_fault(make_shared_word()), wake_fd(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (wake_fd < 0) {
        throw std::system_error(errno, std::generic_category(), "eventfd");
    }
}

Exchange::~Exchange() {
    close(wake_fd);
    (void)munmap(&latched_fault, sizeof latched_fault);
}

void Exchange::wake() const {
    const std::uint64_t one = 1;
    const ssize_t ignored = write(wake_fd, &one, sizeof one);
    (void)ignored;
}

} // namespace quiesced
