/// live: a rig in the computer at the rate of the clock on the wall, orders on stdin, what it does
/// on stdout and on a bus. docs/reference/rig-protocol.md.
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <limits>
#include <memory>
#include <poll.h>
#include <string>
#include <sys/prctl.h>
#include <unistd.h>

#include "bus_link.h"
#include "channel_factory.h"
#include "commands.h"
#include "input_error.h"
#include "live_session.h"
#include "node_link.h"
#include "run_options.h"

namespace quiesce {

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::size_t kMostLine = 65536;
constexpr int kStatesPerS = 10;
constexpr unsigned long kTimerSlack_ns = 1000; // the system's own 50 us would be all of the jitter

std::int64_t now_ns() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * kSecond_ns + now.tv_nsec;
}

/// Lines of stdin, without waiting for the rest of one.
class Orders {
  public:
    /// Waits until something comes, or until then. Returns false iff nothing did.
    static bool wait(std::int64_t until_ns) {
        const std::int64_t left_ns = std::max<std::int64_t>(0, until_ns - now_ns());
        const timespec time{left_ns / kSecond_ns, left_ns % kSecond_ns};
        pollfd input{STDIN_FILENO, POLLIN, 0};
        return ppoll(&input, 1, &time, nullptr) > 0;
    }

    /// What has come. Returns false iff that is the end.
    bool read() {
        std::array<char, 4096> bytes{};
        const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
        if (count > 0) {
            text_.append(bytes.data(), static_cast<std::size_t>(count));
        }
        if (text_.size() > kMostLine) {
            throw InputError("an order is at most " + std::to_string(kMostLine) + " bytes");
        }
        return count > 0 || (count < 0 && (errno == EINTR || errno == EAGAIN));
    }

    /// The next whole one. Returns false iff there is none.
    bool next(std::string &line) {
        const std::size_t end = text_.find('\n');
        if (end == std::string::npos) {
            return false;
        }
        line = text_.substr(0, end);
        text_.erase(0, end + 1);
        return true;
    }

  private:
    std::string text_;
};

/// Throws InputError where nobody reads any more.
void say(const Json &what) {
    const std::string line = what.dump() + '\n';
    std::size_t done = 0;
    while (done < line.size()) {
        const ssize_t count = ::write(STDOUT_FILENO, line.data() + done, line.size() - done);
        if (count < 0 && errno != EINTR) {
            throw InputError(std::string("stdout: ") + std::strerror(errno));
        }
        done += count > 0 ? static_cast<std::size_t>(count) : 0;
    }
}

/// What may be left out where the reader is slow: the tick does not wait for him.
void say_if_read(const Json &what) {
    pollfd output{STDOUT_FILENO, POLLOUT, 0};
    if (poll(&output, 1, 0) > 0) {
        say(what);
    }
}

void answer(LiveSession &session, const std::string &line) {
    try {
        session.obey(line);
        say({{"done", true}});
    } catch (const InputError &error) {
        say({{"refused", error.what()}});
    }
}

/// Returns false iff there will be no more orders.
bool take_orders(Orders &orders, LiveSession &session) {
    const bool goes_on = orders.read();
    std::string line;
    while (orders.next(line)) {
        answer(session, line);
    }
    return goes_on;
}

/// Until stdin ends, or for so many ticks.
void run_paced(LiveSession &session, std::int64_t ticks) {
    Orders orders;
    const bool waits_half_way = session.has_other_clock();
    bool is_past_half = !waits_half_way;
    while (session.pace().ticks() < ticks) {
        const std::int64_t due_ns =
            is_past_half ? session.pace().due_ns() : session.pace().half_way_ns();
        if (Orders::wait(due_ns)) {
            if (!take_orders(orders, session)) {
                return;
            }
            if (now_ns() < due_ns) {
                continue;
            }
        }
        if (!is_past_half) {
            session.half_way();
            is_past_half = true;
            continue;
        }
        is_past_half = !waits_half_way;
        const std::int64_t begin_ns = now_ns();
        session.tick(begin_ns);
        session.worked(now_ns() - begin_ns);
        if (session.is_state_due(kStatesPerS)) {
            say_if_read({{"state", session.state()}});
        }
    }
}

/// Of a plant by itself: shaken at the frequency at which its shaker is rated.
RunSetup setup_for_live(const Arguments &arguments) {
    if (arguments.text("scenario")) {
        return run_setup(arguments);
    }
    RunSetup setup = setup_of_plant(arguments, "live");
    setup.scenario.segments = {lasting_sine(setup.plant.shaker.ref_freq_Hz)};
    require_base(setup.scenario, setup.plant);
    return setup;
}

/// A controller that runs by itself gets its tables over its bus.
void refuse_tables(const Arguments &arguments) {
    for (const std::string &name : table_option_names()) {
        if (arguments.text(name)) {
            throw InputError("--" + name +
                             ": a controller of --can gets its tables over its bus: "
                             "quiesce can load");
        }
    }
}

std::unique_ptr<LiveLink> live_link(const Arguments &arguments) {
    const auto image = arguments.text("image");
    const auto channel = arguments.text("can");
    if (image && channel) {
        throw InputError("--image or --can: one controller");
    }
    const auto bus = arguments.text("bus");
    std::unique_ptr<MulticastBus> tools = bus ? std::make_unique<MulticastBus>(*bus) : nullptr;
    if (channel) {
        refuse_tables(arguments);
        return std::make_unique<BusLink>(open_channel(*channel), std::move(tools));
    }
    return std::make_unique<NodeLink>(image ? make_node_image(*image) : make_node_here(),
                                      std::move(tools));
}

bool is_enabled_at_first(const Arguments &arguments) {
    const std::string text = arguments.text("control").value_or("on");
    if (text != "on" && text != "off") {
        throw InputError("--control " + text + ": expected on or off");
    }
    return text == "on";
}

} // namespace

int cmd_live(const std::vector<std::string> &words) {
    const Arguments arguments("live", words,
                              options({run_option_names(),
                                       table_option_names(),
                                       {"bus", "ticks", "image", "can", "control"}}));
    arguments.require_no_positional();
    const bool is_enabled = is_enabled_at_first(arguments);
    RunSetup setup = setup_for_live(arguments);
    const auto most = std::numeric_limits<std::int64_t>::max();
    const std::int64_t ticks = arguments.integer("ticks", 1, most).value_or(most);
    prctl(PR_SET_TIMERSLACK, kTimerSlack_ns);
    const std::unique_ptr<LiveLink> link = live_link(arguments);
    if (link->is_complete()) {
        setup.tables = tables_from(arguments, setup.board(), setup.params);
    }
    LiveSession session(std::move(setup), *link, is_enabled, now_ns());
    say({{"ready", session.introduction()}});
    run_paced(session, ticks);
    link->leave();
    say({{"end", session.summary()}});
    return 0;
}

} // namespace quiesce
