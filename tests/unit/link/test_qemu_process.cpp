#include <cstdlib>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "images.h"
#include "qemu_process.h"

namespace quiesce {
namespace {

using std::chrono::milliseconds;

const std::vector<std::string> kMachine = {"-M", "mps2-an386", "-serial", "none"};

/// PATH as it was, whatever the test did to it.
class SavedPath {
  public:
    SavedPath() : path_(std::getenv("PATH")) {}
    ~SavedPath() { setenv("PATH", path_.c_str(), 1); }

  private:
    std::string path_;
};

TEST(qemu_process, missing_qemu_says_how_to_get_it) {
    const SavedPath saved;
    setenv("PATH", "/nonexistent", 1);
    EXPECT_EQ(error_of([] { QemuProcess(kEchoImage, kMachine, {}); }),
              "qemu-system-arm not found: install it (Debian: qemu-system-arm) or run ./tools/hil");
    int status = 0;
    EXPECT_EQ(waitpid(-1, &status, WNOHANG), -1); // nothing left to reap
}

TEST(qemu_process, missing_image_ends_qemu_with_its_message) {
    QemuProcess process("no/such.elf", kMachine, {});
    ASSERT_TRUE(process.wait_for_end(milliseconds(10000)));
    EXPECT_FALSE(process.has_succeeded());
    expect_contains(process.describe_end(), "qemu-system-arm ended with code 1: ");
    expect_contains(process.describe_end(), "no/such.elf");
}

TEST(qemu_process, destructor_ends_and_reaps) {
    pid_t id = 0;
    {
        QemuProcess process(kEchoImage, kMachine, {});
        id = process.id();
        EXPECT_TRUE(process.is_running());
    }
    EXPECT_EQ(kill(id, 0), -1);
    EXPECT_EQ(errno, ESRCH);
}

TEST(qemu_process, destructor_ends_a_paused_emulator) {
    pid_t id = 0;
    {
        QemuProcess process(kEchoImage, kMachine, {});
        id = process.id();
        process.pause();
    }
    EXPECT_EQ(kill(id, 0), -1);
}

TEST(qemu_process, death_is_noticed_and_described) {
    QemuProcess process(kEchoImage, kMachine, {});
    kill(process.id(), SIGKILL);
    ASSERT_TRUE(process.wait_for_end(milliseconds(10000)));
    EXPECT_FALSE(process.has_succeeded());
    expect_contains(process.describe_end(), "was killed by signal 9: it printed nothing");
}

TEST(qemu_process, running_image_is_not_reported_as_ended) {
    QemuProcess process(kEchoImage, kMachine, {});
    EXPECT_FALSE(process.wait_for_end(milliseconds(50)));
    EXPECT_TRUE(process.is_running());
    EXPECT_FALSE(process.has_succeeded());
}

TEST(qemu_process, dies_with_a_bench_that_is_killed) {
    int report[2];
    ASSERT_EQ(pipe(report), 0);
    ASSERT_EQ(prctl(PR_SET_CHILD_SUBREAPER, 1), 0); // the orphan is ours to reap
    const pid_t bench = fork();
    if (bench == 0) {
        const QemuProcess process(kEchoImage, kMachine, {});
        const pid_t id = process.id();
        [[maybe_unused]] const ssize_t written = write(report[1], &id, sizeof id);
        raise(SIGKILL);
    }
    pid_t emulator = 0;
    ASSERT_EQ(read(report[0], &emulator, sizeof emulator), ssize_t{sizeof emulator});
    int status = 0;
    EXPECT_EQ(waitpid(bench, &status, 0), bench);
    EXPECT_EQ(waitpid(emulator, &status, 0), emulator);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    close(report[0]);
    close(report[1]);
}

} // namespace
} // namespace quiesce
