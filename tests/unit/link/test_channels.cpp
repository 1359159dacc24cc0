/// Channels over real ptys and sockets, and the text that names them.
#include "channel_factory.h"

#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <linux/can.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "can_link.h"
#include "comparing_link.h"
#include "images.h"
#include "in_process_link.h"
#include "lockstep_peer.h"
#include "socketcan_channel.h"

namespace quiesce {
namespace {

LinkClock::time_point soon() {
    return LinkClock::now() + std::chrono::seconds(10);
}

can_frame_t frame_of(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
    can_frame_t frame{};
    frame.id = id;
    for (const std::uint8_t byte : data) {
        frame.data[frame.length++] = byte;
    }
    return frame;
}

void expect_equal_to_host(const std::string &channel) {
    CanLink link(open_channel(channel), {});
    InProcessLink host;
    ComparingLink comparing(host, link);
    ASSERT_TRUE(comparing.start(nullptr, default_params(), {}));
    lockstep_reply_t reply;
    for (std::uint32_t tick = 0; tick < 200; ++tick) {
        comparing.exchange(varied_stimulus(tick), reply);
    }
    EXPECT_EQ(comparing.mismatches(), 0u);
}

/// A socket that listens, and what leads to it.
struct Listener {
    FileDescriptor socket;
    std::string channel;

    FileDescriptor accept() const {
        return FileDescriptor(::accept(socket.number(), nullptr, nullptr));
    }
};

Listener tcp_listener() {
    FileDescriptor listening(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto *any = reinterpret_cast<sockaddr *>(&address);
    EXPECT_EQ(bind(listening.number(), any, size), 0);
    EXPECT_EQ(listen(listening.number(), 1), 0);
    EXPECT_EQ(getsockname(listening.number(), any, &size), 0);
    return {std::move(listening), "slcan:tcp:127.0.0.1:" + std::to_string(ntohs(address.sin_port))};
}

Listener unix_listener(const std::string &path) {
    FileDescriptor listening(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    EXPECT_EQ(bind(listening.number(), reinterpret_cast<sockaddr *>(&address), sizeof address), 0);
    EXPECT_EQ(listen(listening.number(), 1), 0);
    return {std::move(listening), "slcan:unix:" + path};
}

class Folder {
  public:
    Folder() {
        std::string name = (std::filesystem::temp_directory_path() / "quiesce-XXXXXX").string();
        path_ = mkdtemp(name.data());
    }
    Folder(const Folder &) = delete;
    Folder &operator=(const Folder &) = delete;
    ~Folder() { std::filesystem::remove_all(path_); }
    std::string file(const char *name) const { return path_ + "/" + name; }

  private:
    std::string path_;
};

TEST(channel, pty) {
    Pty pty = make_pty();
    const std::string path = pty.path;
    // Held open, so that the master does not see a hang-up before the bench opens it.
    const FileDescriptor other(open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    const LockstepPeer peer(std::move(pty.master));
    expect_equal_to_host("slcan:" + path);
    expect_equal_to_host("slcan:" + path); // a second bench after the first
}

TEST(channel, one_bench_at_a_time_has_a_serial_line) {
    const Pty pty = make_pty();
    const auto first = open_channel("slcan:" + pty.path);
    expect_contains(error_of([&] { open_channel("slcan:" + pty.path); }), "has locked it");
}

TEST(channel, pty_whose_other_side_goes) {
    Pty pty = make_pty();
    const auto channel = open_channel("slcan:" + pty.path);
    pty.master.close();
    can_frame_t frame;
    EXPECT_EQ(error_of([&] { channel->receive(frame, soon()); }),
              "slcan:" + pty.path + ": the other side has closed the line");
}

TEST(channel, adapter_is_told_its_bit_rate_opened_and_closed) {
    const Pty pty = make_pty();
    const FileDescriptor other(open(pty.path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    open_channel("slcan:" + pty.path + ",baud=115200,bitrate=500000").reset();
    std::string seen;
    char byte = 0;
    const std::string expected = "\rC\rS6\rO\rC\r";
    while (seen.size() < expected.size() && read(pty.master.number(), &byte, 1) == 1) {
        seen += byte;
    }
    EXPECT_EQ(seen, expected);
}

TEST(channel, tcp) {
    const Listener listener = tcp_listener();
    std::unique_ptr<LockstepPeer> peer;
    std::thread accepting([&] { peer = std::make_unique<LockstepPeer>(listener.accept()); });
    expect_equal_to_host(listener.channel);
    accepting.join();
}

TEST(channel, unix_socket) {
    const Folder folder;
    const Listener listener = unix_listener(folder.file("can.sock"));
    std::unique_ptr<LockstepPeer> peer;
    std::thread accepting([&] { peer = std::make_unique<LockstepPeer>(listener.accept()); });
    expect_equal_to_host(listener.channel);
    accepting.join();
}

TEST(channel, socket_that_is_closed_at_once) {
    const Listener listener = tcp_listener();
    const auto channel = open_channel(listener.channel);
    listener.accept().close();
    can_frame_t frame;
    expect_contains(error_of([&] { channel->receive(frame, soon()); }), "has closed the line");
}

TEST(channel, line_that_takes_no_bytes) {
    const Listener listener = tcp_listener();
    const auto channel = open_channel(listener.channel);
    const can_frame_t frame = frame_of(0x603, {1, 2, 3, 4});
    expect_contains(error_of([&] {
                        for (;;) {
                            channel->send(&frame, 1, LinkClock::now());
                        }
                    }),
                    "takes no bytes");
}

// SocketCAN: a pair of message sockets stands for the kernel's; the frames are the kernel's.

TEST(socketcan_channel, frames_keep_id_kind_length_and_data) {
    auto ends = socket_pair(SOCK_SEQPACKET);
    SocketCanChannel first(std::move(ends.first), "can0"), second(std::move(ends.second), "can1");
    can_frame_t remote = frame_of(0x7FF, {});
    remote.is_remote = true;
    can_frame_t extended = frame_of(0x1FFFFFFF, {1, 2, 3, 4, 5, 6, 7, 8});
    extended.is_extended = true;
    for (const can_frame_t &sent : {frame_of(0x603, {1, 0xFF}), remote, extended}) {
        can_frame_t got{};
        first.send(&sent, 1, soon());
        ASSERT_TRUE(second.receive(got, soon()));
        EXPECT_EQ(std::memcmp(&sent, &got, sizeof got), 0);
    }
}

TEST(socketcan_channel, what_is_no_data_frame_is_dropped) {
    auto ends = socket_pair(SOCK_SEQPACKET);
    SocketCanChannel channel(std::move(ends.first), "can0");
    can_frame error_frame{};
    error_frame.can_id = CAN_ERR_FLAG | 0x600u;
    error_frame.can_dlc = 8;
    can_frame too_long{};
    too_long.can_id = 0x603;
    too_long.can_dlc = 9;
    can_frame good{};
    good.can_id = 0x604;
    const int other = ends.second.number();
    ASSERT_EQ(send(other, &error_frame, sizeof error_frame, 0), ssize_t{sizeof error_frame});
    ASSERT_EQ(send(other, &too_long, sizeof too_long, 0), ssize_t{sizeof too_long});
    ASSERT_EQ(send(other, &good, 7, 0), 7);
    ASSERT_EQ(send(other, &good, sizeof good, 0), ssize_t{sizeof good});
    can_frame_t got{};
    ASSERT_TRUE(channel.receive(got, soon()));
    EXPECT_EQ(got.id, 0x604u);
    EXPECT_FALSE(channel.receive(got, LinkClock::now()));
}

TEST(socketcan_channel, bus_that_takes_no_frames) {
    auto ends = socket_pair(SOCK_SEQPACKET);
    SocketCanChannel channel(std::move(ends.first), "can0");
    const can_frame_t frame = frame_of(0x603, {});
    expect_contains(error_of([&] {
                        for (;;) {
                            channel.send(&frame, 1, LinkClock::now());
                        }
                    }),
                    "can0: the bus takes no frames");
    ends.second.close();
    expect_contains(error_of([&] { channel.send(&frame, 1, soon()); }), "can0: ");
}

TEST(socketcan_channel, no_such_interface_or_no_can_at_all_is_one_line) {
    const std::string error = error_of([] { open_channel("socketcan:nocan9"); });
    EXPECT_EQ(error.rfind("socketcan:nocan9: ", 0), 0u) << error;
    EXPECT_TRUE(error.find("has no CAN (modules can, can_raw); use a slcan: channel") !=
                    std::string::npos ||
                error.find("no such CAN interface; ip link lists") != std::string::npos)
        << error;
}

struct BadChannel {
    const char *text;
    const char *message;
};

TEST(channel, text_that_names_none_is_refused) {
    const std::string long_path = "slcan:unix:/" + std::string(200, 'x');
    const std::string long_interface = "socketcan:" + std::string(40, 'x');
    const BadChannel kBad[] = {
        {"", "--can : is no CAN channel; give one of slcan:/dev/ttyACM0"},
        {"can0", "--can can0: is no CAN channel"},
        {"slcan:", "names no device"},
        {"slcan:,bitrate=500000", "names no device"},
        {"slcan:/dev/null", "slcan:/dev/null: is no serial line or pty"},
        {"slcan:/no/such/line", "slcan:/no/such/line: No such file or directory"},
        {"slcan:/dev/ptmx,speed=1", "\"speed=1\" is no setting of a serial line"},
        {"slcan:/dev/ptmx,baud=fast", "\"fast\" is no rate"},
        {"slcan:/dev/ptmx,baud=0", "\"0\" is no rate"},
        {"slcan:/dev/ptmx,baud=-5", "\"-5\" is no rate"},
        {"slcan:/dev/ptmx,baud=99999999999", "\"99999999999\" is no rate"},
        {"slcan:/dev/ptmx,baud=12345", "no such baud rate; choose one of 9600, 19200"},
        {"slcan:/dev/ptmx,bitrate=123456", "SLCAN has no bit rate 123456; choose one of 10000"},
        {"slcan:/dev/ptmx,", "\"\" is no setting of a serial line"},
        {"slcan:unix:", "names no path"},
        {"slcan:unix:/no/such/socket", "slcan:unix:/no/such/socket: No such file"},
        {long_path.c_str(), "the path is too long for a socket, at most 107 bytes"},
        {"slcan:tcp:", "names no host and port"},
        {"slcan:tcp:localhost", "names no host and port"},
        {"slcan:tcp:localhost:", "names no host and port"},
        {"slcan:tcp::5556", "names no host and port"},
        {"slcan:tcp:127.0.0.1:1", "slcan:tcp:127.0.0.1:1: Connection refused; nobody listens"},
        {"slcan:tcp:127.0.0.1:nosuchservice", "slcan:tcp:127.0.0.1:nosuchservice: "},
        {"socketcan:", "socketcan:: "},
        {long_interface.c_str(), "socketcan:xxxx"},
    };
    for (const BadChannel &bad : kBad) {
        expect_contains(error_of([&] { open_channel(bad.text); }), bad.message);
    }
}

} // namespace
} // namespace quiesce
