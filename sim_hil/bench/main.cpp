/// quiesce_bench: the simulated plant in lock-step with the controller on one of its targets.
#include <cstdio>
#include <exception>

#include "commands.h"

namespace {

struct Entry {
    const char *name;
    const char *usage;
    quiesce::Command run;
};

const Entry kCommands[] = {
    {"board-check", "FILE", quiesce::cmd_board_check},
    {"board-keys", "", quiesce::cmd_board_keys},
    {"compare",
     "--scenario FILE --law NAME --seeds N,N,... --target T [--board FILE] [--image ELF] "
     "[--plugin SO] [--rules FILE] [--pulses FILE] [--force-map FILE] [--law-table FILE] "
     "[--can CHANNEL] [--telemetry-every N] [--wait-s X] [--plant FILE] [--set NAME=VALUE]... "
     "[--noise-mg X] [--dt-us N]",
     quiesce::cmd_compare},
    {"count", "--image ELF [--word N]... [--data FILE] [--profile off|all|PASS] [--plugin SO]",
     quiesce::cmd_count},
    {"fuzzy-surface", "[--rules FILE]", quiesce::cmd_fuzzy_surface},
    {"live",
     "--plant FILE|--scenario FILE --law NAME [--board FILE] [--bus GROUP:PORT] [--ticks N] "
     "[--image ELF|--can CHANNEL] [--control on|off] "
     "[--set NAME=VALUE]... [--rules FILE] [--pulses FILE] [--force-map FILE] [--law-table FILE] "
     "[--seed N] [--noise-mg X] [--dt-us N]",
     quiesce::cmd_live},
    {"params", "", quiesce::cmd_params},
    {"plant-check", "FILE", quiesce::cmd_plant_check},
    {"replay",
     "--counts FILE --trace FILE [--board FILE] [--law NAME] [--set NAME=VALUE]... [--target T] "
     "[--record-ticks N] [--from-tick N] [--every N] [--columns NAME,NAME...]",
     quiesce::cmd_replay},
    {"run",
     "--scenario FILE --law NAME [--plant FILE] [--board FILE] [--set NAME=VALUE]... [--target T] "
     "[--image ELF] "
     "[--plugin SO] [--can CHANNEL] [--telemetry-every N] [--wait-s X] [--rules FILE] "
     "[--pulses FILE] [--force-map FILE] [--law-table FILE] [--seed N] [--noise-mg X] "
     "[--dt-us N] "
     "[--trace FILE] "
     "[--columns NAME,NAME...] [--every N] [--repeat N]",
     quiesce::cmd_run},
    {"scenario-check", "FILE", quiesce::cmd_scenario_check},
    {"serve", "(a line of input: options of run, tabs between; a line of output: its object)",
     quiesce::cmd_serve},
    {"table-check", "--file FILE [--board FILE]", quiesce::cmd_table_check},
    {"uart-rate", "--image ELF --echo-image ELF [--exchanges N]", quiesce::cmd_uart_rate},
};

void print_usage(std::FILE *out) {
    std::fprintf(out, "usage: quiesce_bench COMMAND [OPTION VALUE]...\n");
    for (const Entry &entry : kCommands) {
        std::fprintf(out, "  %s %s\n", entry.name, entry.usage);
    }
}

int run_command(const Entry &entry, int argc, char **argv) {
    try {
        return entry.run(std::vector<std::string>(argv + 2, argv + argc));
    } catch (const std::exception &error) {
        std::fprintf(stderr, "quiesce_bench: %s\n", error.what());
        return 2;
    }
}

} // namespace

int main(int argc, char **argv) {
    const std::string name = argc > 1 ? argv[1] : "";
    if (name == "--help" || name == "-h") {
        print_usage(stdout);
        return 0;
    }
    for (const Entry &entry : kCommands) {
        if (name == entry.name) {
            return run_command(entry, argc, argv);
        }
    }
    std::fprintf(stderr, "quiesce_bench: %s; --help lists the commands\n",
                 name.empty() ? "no command given" : ("unknown command " + name).c_str());
    return 2;
}
