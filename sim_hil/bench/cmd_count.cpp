/// count: an image that runs by itself to its end, its instructions counted between its markers.
#include <iostream>

#include "arguments.h"
#include "commands.h"
#include "image_run.h"
#include "input_error.h"
#include "json.h"

namespace quiesce {

namespace {

/// A million ticks take a minute or two; a loaded machine must not look like a dead image.
constexpr std::chrono::minutes kLongestRun(60);

std::vector<std::uint32_t> words_from(const Arguments &arguments) {
    std::vector<std::uint32_t> out;
    for (const std::string &text : arguments.all("word")) {
        const auto value = parse_integer(text);
        if (!value || *value < 0 || *value > UINT32_MAX) {
            throw InputError("--word " + text + ": expected an integer in 0..4294967295");
        }
        out.push_back(static_cast<std::uint32_t>(*value));
    }
    return out;
}

std::string profile_from(const Arguments &arguments) {
    std::string text = arguments.text("profile").value_or("off");
    if (text != "all" && text != "off" && parse_integer(text).value_or(0) < 1) {
        throw InputError("--profile " + text + ": expected off, all or the number of a pass");
    }
    return text;
}

} // namespace

int cmd_count(const std::vector<std::string> &words) {
    const Arguments arguments("count", words, {"image", "word", "data", "profile", "plugin"});
    arguments.require_no_positional();
    QemuOptions options;
    options.image_path = arguments.required("image");
    options.plugin_path = arguments.text("plugin").value_or("");
    options.profile = profile_from(arguments);
    options.answer_time = kLongestRun;
    const ImageRun run =
        run_image(options, words_from(arguments), arguments.text("data").value_or(""));
    Json out = {
        {"passes", run.counts.ticks},
        {"worst", run.counts.worst},
        {"worst_pass", run.counts.worst_tick},
        {"median", run.counts.median},
        {"mean", static_cast<double>(run.counts.total) / static_cast<double>(run.counts.ticks)},
        {"printed", run.printed}};
    if (options.profile != "off") {
        Json profile = Json::object();
        for (const auto &[address, count] : run.profile) {
            profile.set(std::to_string(address), count);
        }
        out.set("profile", profile);
    }
    std::cout << out.dump() << '\n';
    return 0;
}

} // namespace quiesce
