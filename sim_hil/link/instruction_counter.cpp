#include "instruction_counter.h"

#include <filesystem>
#include <sstream>

#include "elf_symbols.h"
#include "input_error.h"

namespace quiesce {

namespace {

std::string plugin_beside_this_program() {
    return std::filesystem::read_symlink("/proc/self/exe").parent_path() / "icount_plugin.so";
}

std::uint32_t marker(const std::string &image_path, const std::string &name) {
    const auto symbols = read_elf_symbols(image_path);
    const auto found = symbols.find(name);
    if (found == symbols.end()) {
        throw InputError("image " + image_path + ": has no symbol " + name +
                         ", so its instructions cannot be counted; rebuild it, or pass --plugin "
                         "none");
    }
    return found->second;
}

} // namespace

InstructionCounter::InstructionCounter(const QemuOptions &options) {
    if (options.plugin_path == "none") {
        return;
    }
    const std::string plugin =
        options.plugin_path.empty() ? plugin_beside_this_program() : options.plugin_path;
    if (!std::filesystem::exists(plugin)) {
        throw InputError("plugin " + plugin +
                         ": not found; build the target icount_plugin, or pass --plugin none");
    }
    report_ = make_memory_file("instruction-counts", 0);
    std::ostringstream argument;
    argument << escape_commas(plugin)
             << ",begin=" << marker(options.image_path, "quiesce_count_begin")
             << ",end=" << marker(options.image_path, "quiesce_count_end")
             << ",fd=" << report_.number()
             << ",count=" << (options.count_each_instruction ? "instruction" : "block")
             << ",profile=" << options.profile;
    plugin_argument_ = argument.str();
}

std::vector<std::string> InstructionCounter::qemu_arguments() const {
    if (plugin_argument_.empty()) {
        return {};
    }
    return {"-plugin", plugin_argument_};
}

std::vector<int> InstructionCounter::inherited() const {
    if (plugin_argument_.empty()) {
        return {};
    }
    return {report_.number()};
}

std::optional<InstructionCounts> InstructionCounter::read() const {
    std::istringstream report(read_memory_file(report_));
    std::string word;
    InstructionCounts counts{};
    report >> word >> counts.ticks >> word >> counts.median >> word >> counts.worst >> word >>
        counts.total >> word >> counts.worst_tick;
    if (!report || counts.ticks == 0) {
        return std::nullopt;
    }
    return counts;
}

std::map<std::uint32_t, std::uint64_t> InstructionCounter::read_profile() const {
    std::istringstream report(read_memory_file(report_));
    std::map<std::uint32_t, std::uint64_t> out;
    for (std::string line; std::getline(report, line);) {
        std::istringstream words(line);
        std::string at;
        std::uint32_t address = 0;
        std::uint64_t count = 0;
        if (words >> at >> address >> count && at == "at") {
            out[address] += count;
        }
    }
    return out;
}

} // namespace quiesce
