#include "shm_image.h"

#include <algorithm>
#include <cerrno>
#include <sys/mman.h>
#include <system_error>
#include <thread>

#include "input_error.h"

namespace quiesce {

namespace {

/// Spins before the processor is given away: longer than an answer takes on an idle machine.
constexpr int kSpinsBeforeNap = 2048;
constexpr std::chrono::microseconds kNap(50);

std::vector<std::string> qemu_arguments(const SharedMailbox &mailbox,
                                        const InstructionCounter &counter) {
    std::vector<std::string> arguments = {
        "-object",
        "memory-backend-file,id=psram,share=on,size=" + std::to_string(MAILBOX_BYTES) +
            ",mem-path=/proc/self/fd/" + std::to_string(mailbox.descriptor()),
        "-M",
        "mps2-an386,memory-backend=psram",
        "-serial",
        "none"};
    for (const std::string &word : counter.qemu_arguments()) {
        arguments.push_back(word);
    }
    return arguments;
}

std::vector<int> inherited(const SharedMailbox &mailbox, const InstructionCounter &counter) {
    std::vector<int> numbers = counter.inherited();
    numbers.push_back(mailbox.descriptor());
    return numbers;
}

void relax() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

} // namespace

SharedMailbox::SharedMailbox() : file_(make_memory_file("quiesce-mailbox", MAILBOX_BYTES)) {
    void *memory =
        mmap(nullptr, MAILBOX_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, file_.number(), 0);
    if (memory == MAP_FAILED) {
        throw std::system_error(errno, std::generic_category(), "quiesce-mailbox");
    }
    mailbox_ = static_cast<mailbox_live_t *>(memory);
}

SharedMailbox::~SharedMailbox() {
    munmap(mailbox_, MAILBOX_BYTES);
}

ShmImage::ShmImage(const QemuOptions &options, std::size_t layout_bytes)
    : options_(options), layout_bytes_(layout_bytes), counter_(options),
      process_(options.image_path, qemu_arguments(mailbox_, counter_),
               inherited(mailbox_, counter_)) {}

StartAnswer ShmImage::start(const quiesce_board_t *board, const quiesce_params_t &params,
                            const Tables &tables) {
    mailbox_t &box = plain();
    box.params = params;
    box.has_board = board != nullptr ? 1u : 0u;
    box.board = board != nullptr ? *board : quiesce_board_t{};
    for (std::size_t i = 0; i < tables.size(); ++i) {
        const std::size_t count = std::min<std::size_t>(tables[i].size(), QUIESCE_TABLE_WORDS);
        box.table_words[i] = static_cast<std::uint32_t>(tables[i].size());
        std::copy_n(tables[i].begin(), count, box.table[i]);
    }
    box.reply = lockstep_reply_t{};
    request(MAILBOX_START);
    check_layout();
    return {box.status == 1u, box.refused};
}

std::optional<InstructionCounts> ShmImage::finish() {
    request(MAILBOX_STOP);
    if (!process_.wait_for_end(options_.answer_time) || !process_.has_succeeded()) {
        throw InputError("image " + options_.image_path + ": did not end when told to");
    }
    return counter_.read();
}

void ShmImage::request(std::uint32_t operation) {
    plain().operation = operation;
    const std::uint32_t sequence = plain().request_seq + 1u;
    __atomic_store_n(&plain().request_seq, sequence, __ATOMIC_RELEASE);
    wait_for_reply(sequence);
}

bool ShmImage::has_replied(std::uint32_t sequence) const {
    return __atomic_load_n(&mailbox_->plain.reply_seq, __ATOMIC_ACQUIRE) == sequence;
}

void ShmImage::wait_for_reply(std::uint32_t sequence) {
    for (int spin = 0; spin < kSpinsBeforeNap; ++spin) {
        if (has_replied(sequence)) {
            return;
        }
        relax();
    }
    const auto deadline = std::chrono::steady_clock::now() + options_.answer_time;
    while (!has_replied(sequence)) {
        const bool is_running = process_.is_running();
        if (has_replied(sequence)) {
            return; // the last thing that the image did
        }
        if (!is_running) {
            throw InputError("image " + options_.image_path + ": " + process_.describe_end());
        }
        if (std::chrono::steady_clock::now() > deadline) {
            throw InputError("image " + options_.image_path + ": no answer within " +
                             std::to_string(options_.answer_time.count()) +
                             " ms; is it the shared-RAM image (quiesce_mps2_shm, of a live rig "
                             "quiesce_mps2_live)?");
        }
        std::this_thread::sleep_for(kNap);
    }
}

void ShmImage::check_layout() const {
    if (mailbox_->plain.layout_bytes != layout_bytes_) {
        throw InputError("image " + options_.image_path +
                         ": was built from other sources than this bench; rebuild it");
    }
}

} // namespace quiesce
