#include "image_run.h"

#include <filesystem>
#include <iomanip>
#include <sstream>

#include "input_error.h"
#include "instruction_counter.h"
#include "mailbox.h"
#include "qemu_process.h"

namespace quiesce {

namespace {

void check_data(const std::string &path) {
    std::error_code error;
    const auto bytes = std::filesystem::file_size(path, error);
    if (error || bytes == 0 || bytes > MAILBOX_BYTES) {
        throw InputError("--data " + path + ": expected a file of 1 .. " +
                         std::to_string(MAILBOX_BYTES) + " bytes");
    }
}

std::vector<std::string> qemu_arguments(const InstructionCounter &counter,
                                        const std::vector<std::uint32_t> &words,
                                        const std::string &data_path) {
    std::vector<std::string> arguments = {"-M", "mps2-an386", "-serial", "none"};
    if (!data_path.empty()) {
        arguments.insert(arguments.end(),
                         {"-device", "loader,addr=" + std::to_string(MAILBOX_BASE) +
                                         ",force-raw=on,file=" + escape_commas(data_path)});
    }
    std::uint32_t address = MAILBOX_BASE;
    for (const std::uint32_t word : words) {
        arguments.insert(arguments.end(),
                         {"-device", "loader,addr=" + std::to_string(address) +
                                         ",data=" + std::to_string(word) + ",data-len=4"});
        address += sizeof word;
    }
    for (const std::string &word : counter.qemu_arguments()) {
        arguments.push_back(word);
    }
    return arguments;
}

std::map<std::string, std::uint32_t> parse_printed(const std::string &text,
                                                   const std::string &image) {
    std::map<std::string, std::uint32_t> out;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string name, rest;
        std::uint32_t value = 0;
        if (!(words >> name >> std::hex >> value) || words >> rest) {
            std::ostringstream message;
            message << "image " << image << ": printed '" << line << "', no name and value";
            throw InputError(message.str());
        }
        out[name] = value;
    }
    return out;
}

} // namespace

ImageRun run_image(const QemuOptions &options, const std::vector<std::uint32_t> &words,
                   const std::string &data_path) {
    if (!data_path.empty()) {
        check_data(data_path);
        if (!words.empty()) {
            throw InputError("--data and --word are for the same place: give one of them");
        }
    }
    const InstructionCounter counter(options);
    const std::string &image = options.image_path;
    QemuProcess process(image, qemu_arguments(counter, words, data_path), counter.inherited());
    if (!process.wait_for_end(options.answer_time)) {
        throw InputError("image " + image + ": has not ended after " +
                         std::to_string(options.answer_time.count()) + " ms");
    }
    if (!process.has_succeeded()) {
        throw InputError("image " + image + ": " + process.describe_end());
    }
    const auto counts = counter.read();
    if (!counts) {
        throw InputError("image " + image + ": ended without a pass between its markers");
    }
    return {*counts, counter.read_profile(), parse_printed(process.output(), image)};
}

} // namespace quiesce
