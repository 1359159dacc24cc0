#include "line_finder.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <vector>

#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace quiesced {

namespace {

/// Whether the line is found; trouble says what keeps it from being used.
struct Finding {
    bool is_found = false;
    std::string trouble;
};

bool line_info(int fd, std::uint32_t offset, gpio_v2_line_info &info) {
    info = gpio_v2_line_info{};
    info.offset = offset;
    return ioctl(fd, GPIO_V2_GET_LINEINFO_IOCTL, &info) == 0;
}

Finding judged(const gpio_v2_line_info &info) {
    const bool is_used = (info.flags & GPIO_V2_LINE_FLAG_USED) != 0;
    return {true, is_used ? "is in use by \"" + std::string(info.consumer) + "\"" : ""};
}

Finding find_on(int fd, const std::string &name) {
    gpiochip_info chip{};
    if (ioctl(fd, GPIO_GET_CHIPINFO_IOCTL, &chip) != 0) {
        return {};
    }
    gpio_v2_line_info info;
    for (std::uint32_t offset = 0; offset < chip.lines; ++offset) {
        if (line_info(fd, offset, info) && name == info.name) {
            return judged(info);
        }
    }
    return {};
}

std::string trouble_at(const std::string &chip, const std::string &offset) {
    const std::string path = chip.front() == '/' ? chip : "/dev/" + chip;
    const int fd = open(path.c_str(), O_RDWR | O_CLOEXEC);
    if (fd < 0) {
        return path + ": " + std::strerror(errno);
    }
    gpio_v2_line_info info;
    const auto number = static_cast<std::uint32_t>(
        std::min<unsigned long>(std::strtoul(offset.c_str(), nullptr, 10), UINT32_MAX));
    std::string trouble =
        line_info(fd, number, info) ? judged(info).trouble : path + " has no line " + offset;
    close(fd);
    return trouble;
}

bool is_number(const std::string &text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

std::string trouble_by_name(const std::string &name) {
    std::error_code ignored;
    int chips = 0;
    for (const auto &entry : std::filesystem::directory_iterator("/dev", ignored)) {
        if (entry.path().filename().string().rfind("gpiochip", 0) != 0) {
            continue;
        }
        const int fd = open(entry.path().c_str(), O_RDWR | O_CLOEXEC);
        if (fd < 0) {
            continue;
        }
        ++chips;
        const Finding finding = find_on(fd, name);
        close(fd);
        if (finding.is_found) {
            return finding.trouble;
        }
    }
    return "no such line on the " + std::to_string(chips) + " GPIO chips that can be opened";
}

} // namespace

std::string line_trouble(const std::string &line) {
    const std::size_t colon = line.rfind(':');
    const bool has_offset =
        colon != std::string::npos && colon > 0 && is_number(line.substr(colon + 1));
    return has_offset ? trouble_at(line.substr(0, colon), line.substr(colon + 1))
                      : trouble_by_name(line);
}

} // namespace quiesced
