/// One qemu-system-arm process with an mps2-an386 image, from its start to its reaped end.
#ifndef QUIESCE_QEMU_PROCESS_H
#define QUIESCE_QEMU_PROCESS_H

#include <chrono>
#include <string>
#include <sys/types.h>
#include <vector>

#include "file_descriptor.h"

namespace quiesce {

class QemuProcess {
  public:
    /// Starts QEMU. extra: options after the common ones. inherited: descriptors that the options
    /// name by number; they keep their numbers. Throws InputError when QEMU cannot be started.
    QemuProcess(const std::string &image_path, const std::vector<std::string> &extra,
                const std::vector<int> &inherited);

    QemuProcess(const QemuProcess &) = delete;
    QemuProcess &operator=(const QemuProcess &) = delete;

    /// Ends QEMU if it still runs: SIGTERM, after a second SIGKILL. The process is always reaped,
    /// and the kernel kills it if the bench itself is killed.
    ~QemuProcess();

    bool is_running();

    /// Waits for QEMU to end by itself. Returns false iff it still runs after the time.
    bool wait_for_end(std::chrono::milliseconds time);

    /// True iff it has ended by itself with exit code 0.
    bool has_succeeded() const;

    /// How it ended and the last line that it or the image printed: one line. Only after the end.
    std::string describe_end() const;

    /// Everything that QEMU and the image have printed so far.
    std::string output() const;

    /// Halts and resumes the whole emulator, so that an idle image takes no processor time.
    void pause();
    void resume();

    pid_t id() const { return id_; }

  private:
    void reap(int options);

    FileDescriptor output_; ///< stdout and stderr of QEMU
    pid_t id_ = -1;
    bool is_running_ = false;
    int status_ = 0; ///< as waitpid gives it; only after the end
};

} // namespace quiesce

#endif
