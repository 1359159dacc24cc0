#include <algorithm>
#include <cctype>
#include <cstdio>
#include <exception>
#include <string>

#include "check.h"
#include "clear_fault.h"
#include "lockstep_mode.h"
#include "make_safe.h"
#include "names.h"
#include "options.h"
#include "run.h"
#include "signals.h"

namespace {

int run(const quiesced::Options &options) {
    switch (options.mode) {
    case quiesced::Mode::check:
        return quiesced::check(options.config_file);
    case quiesced::Mode::make_safe:
        return quiesced::make_safe(options.config_file);
    case quiesced::Mode::clear_fault:
        return quiesced::clear_fault(options.config_file);
    case quiesced::Mode::lockstep:
        return quiesced::run_lockstep(options.config_file);
    case quiesced::Mode::version:
        (void)std::printf("quiesced %s (%s)\n", quiesced::version(), gpio_library());
        return 0;
    case quiesced::Mode::help:
        (void)std::fputs(quiesced::kUsage, stdout);
        return 0;
    case quiesced::Mode::run:
        break;
    }
    return quiesced::run_controller(options.config_file, options.ticks);
}

/// What a file or an argument holds may be quoted in a message, which stays one line.
std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, '?');
    return text;
}

} // namespace

int main(int argc, char **argv) {
    quiesced::reserve_standard_files();
    try {
        return run(quiesced::parse_options({argv + std::min(argc, 1), argv + argc}));
    } catch (const std::exception &error) {
        (void)std::fprintf(stderr, "quiesced: %s\n", one_line(error.what()).c_str());
        return 2;
    }
}
