/// QEMU TCG plugin: instructions executed between two addresses, counted exactly for every pass.
///
/// Arguments: begin=ADDRESS end=ADDRESS (the image's quiesce_count_begin and quiesce_count_end),
/// fd=NUMBER of an inherited descriptor, count=block|instruction, profile=off|all|PASS.
/// When QEMU ends it writes "passes N median M worst W total T worst_pass P" (the first of the
/// worst, from 1), then one line "COUNT PASSES" for each count that occurred, ascending. The median
/// of an even number of passes is the lower one. profile (slower, with count=block) adds, for all
/// passes or the one of that number, lines "at ADDRESS N": N instructions ran, between the markers,
/// in a translation block that begins at ADDRESS (which may have several such lines). They sum to
/// the count where a call stands between the markers, so that the end marker begins a block.
///
/// count=block (default) adds a whole translation block when it is entered and corrects for the
/// marker's place in its block; exact as long as no exception leaves a block early, and an image
/// takes none but its last. count=instruction adds one per instruction: slower, no such condition.
///
/// QEMU's plugin interface, version 1 (QEMU 4.2 .. 8.2), is declared here as far as it is used:
/// distributions ship no header for it.
#include <inttypes.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))

typedef uint64_t qemu_plugin_id_t;
struct qemu_info;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
enum { QEMU_PLUGIN_CB_NO_REGS = 0 };
enum { QEMU_PLUGIN_INLINE_ADD_U64 = 0 };

typedef void (*tb_translated_t)(qemu_plugin_id_t id, struct qemu_plugin_tb *block);
typedef void (*executed_t)(unsigned int cpu, void *user);
typedef void (*at_exit_t)(qemu_plugin_id_t id, void *user);

void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id, tb_translated_t callback);
void qemu_plugin_register_vcpu_tb_exec_inline(struct qemu_plugin_tb *block, int operation,
                                              void *counter, uint64_t value);
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *block, executed_t callback,
                                          int flags, void *user);
void qemu_plugin_register_vcpu_insn_exec_inline(struct qemu_plugin_insn *instruction, int operation,
                                                void *counter, uint64_t value);
void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn *instruction,
                                            executed_t callback, int flags, void *user);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t id, at_exit_t callback, void *user);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *block);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *block, size_t index);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *instruction);

extern EXPORT int qemu_plugin_version;
EXPORT int qemu_plugin_version = 1;
EXPORT int qemu_plugin_install(qemu_plugin_id_t id, const struct qemu_info *info, int argc,
                               char **argv);

/// One bin a count; a pass beyond the last is reported as worst only.
#define BINS (1u << 20)

/// One translation of a block, for the profile.
typedef struct site {
    struct site *next;
    uint64_t address;
    uint64_t instructions; ///< in the block
    uint64_t executed;     ///< between the markers
} site_t;

/// One per QEMU process: its callbacks carry no state of ours.
static struct {
    uint64_t begin_address;
    uint64_t end_address;
    bool by_block;
    FILE *out;
    uint64_t executed; ///< instructions since QEMU started, ahead by the rest of the block
    uint64_t at_begin;
    bool is_open; ///< between begin and end
    uint64_t passes;
    uint64_t worst;
    uint64_t total;
    uint64_t worst_pass;
    bool has_profile;
    uint64_t profiled_pass;     ///< 0: all
    uint64_t executed_at_begin; ///< rest of the begin marker's block, profiled passes
    site_t *sites;
    uint32_t bins[BINS];
} counter;

static bool is_profiled(void) {
    return counter.profiled_pass == 0 || counter.profiled_pass == counter.passes + 1u;
}

/// user: instructions of the block from the marker on, already in `executed` and not yet run.
static void at_begin(unsigned int cpu, void *user) {
    (void)cpu;
    counter.at_begin = counter.executed - (uintptr_t)user;
    counter.executed_at_begin += is_profiled() ? (uintptr_t)user : 0u;
    counter.is_open = true;
}

static void at_end(unsigned int cpu, void *user) {
    (void)cpu;
    if (!counter.is_open) {
        return;
    }
    const uint64_t count = counter.executed - (uintptr_t)user - counter.at_begin;
    counter.is_open = false;
    counter.passes++;
    counter.total += count;
    counter.bins[count < BINS ? count : BINS - 1u]++;
    if (count > counter.worst) {
        counter.worst = count;
        counter.worst_pass = counter.passes;
    }
}

static void at_block(unsigned int cpu, void *user) {
    site_t *site = user;
    (void)cpu;
    if (counter.is_open && is_profiled()) {
        site->executed += site->instructions;
    }
}

static void profile(struct qemu_plugin_tb *block, size_t instructions) {
    const uint64_t address = qemu_plugin_insn_vaddr(qemu_plugin_tb_get_insn(block, 0));
    if (address == counter.end_address) {
        return; // runs after the markers
    }
    site_t *site = malloc(sizeof *site);
    if (site == NULL) {
        fprintf(stderr, "icount plugin: out of memory\n");
        abort();
    }
    *site = (site_t){counter.sites, address, instructions, 0};
    counter.sites = site;
    qemu_plugin_register_vcpu_tb_exec_cb(block, at_block, QEMU_PLUGIN_CB_NO_REGS, site);
}

static void mark(struct qemu_plugin_insn *instruction, uint64_t instructions_ahead) {
    const uint64_t address = qemu_plugin_insn_vaddr(instruction);
    void *user = (void *)(uintptr_t)instructions_ahead;
    if (address == counter.begin_address) {
        qemu_plugin_register_vcpu_insn_exec_cb(instruction, at_begin, QEMU_PLUGIN_CB_NO_REGS, user);
    }
    if (address == counter.end_address) {
        qemu_plugin_register_vcpu_insn_exec_cb(instruction, at_end, QEMU_PLUGIN_CB_NO_REGS, user);
    }
}

static void block_translated(qemu_plugin_id_t id, struct qemu_plugin_tb *block) {
    const size_t count = qemu_plugin_tb_n_insns(block);
    (void)id;
    if (counter.by_block) {
        qemu_plugin_register_vcpu_tb_exec_inline(block, QEMU_PLUGIN_INLINE_ADD_U64,
                                                 &counter.executed, count);
    }
    if (counter.has_profile) {
        profile(block, count);
    }
    for (size_t i = 0; i < count; i++) {
        struct qemu_plugin_insn *instruction = qemu_plugin_tb_get_insn(block, i);
        mark(instruction, counter.by_block ? count - i : 0u);
        if (!counter.by_block) {
            qemu_plugin_register_vcpu_insn_exec_inline(instruction, QEMU_PLUGIN_INLINE_ADD_U64,
                                                       &counter.executed, 1);
        }
    }
}

static uint64_t median(void) {
    uint64_t seen = 0;
    for (uint64_t count = 0; count < BINS; count++) {
        seen += counter.bins[count];
        if (2u * seen >= counter.passes) {
            return count;
        }
    }
    return BINS;
}

static void report_profile(void) {
    fprintf(counter.out, "at %" PRIu64 " %" PRIu64 "\n", counter.begin_address,
            counter.executed_at_begin);
    for (const site_t *site = counter.sites; site != NULL; site = site->next) {
        if (site->executed != 0) {
            fprintf(counter.out, "at %" PRIu64 " %" PRIu64 "\n", site->address, site->executed);
        }
    }
}

static void report(qemu_plugin_id_t id, void *user) {
    (void)id;
    (void)user;
    fprintf(counter.out,
            "passes %" PRIu64 " median %" PRIu64 " worst %" PRIu64 " total %" PRIu64
            " worst_pass %" PRIu64 "\n",
            counter.passes, counter.passes == 0 ? 0 : median(), counter.worst, counter.total,
            counter.worst_pass);
    for (uint32_t count = 0; count < BINS; count++) {
        if (counter.bins[count] != 0) {
            fprintf(counter.out, "%" PRIu32 " %" PRIu32 "\n", count, counter.bins[count]);
        }
    }
    if (counter.has_profile) {
        report_profile();
    }
    fclose(counter.out);
}

static void take_argument(const char *argument) {
    const char *equals = strchr(argument, '=');
    if (equals == NULL) {
        return;
    }
    const size_t length = (size_t)(equals - argument);
    if (strncmp(argument, "begin", length) == 0) {
        counter.begin_address = strtoull(equals + 1, NULL, 0);
    } else if (strncmp(argument, "end", length) == 0) {
        counter.end_address = strtoull(equals + 1, NULL, 0);
    } else if (strncmp(argument, "fd", length) == 0) {
        counter.out = fdopen((int)strtol(equals + 1, NULL, 0), "w");
    } else if (strncmp(argument, "count", length) == 0) {
        counter.by_block = strcmp(equals + 1, "instruction") != 0;
    } else if (strncmp(argument, "profile", length) == 0) {
        counter.has_profile = strcmp(equals + 1, "off") != 0;
        counter.profiled_pass = strtoull(equals + 1, NULL, 10); // 0 for "all"
    }
}

EXPORT int qemu_plugin_install(qemu_plugin_id_t id, const struct qemu_info *info, int argc,
                               char **argv) {
    (void)info;
    counter.by_block = true;
    for (int i = 0; i < argc; i++) {
        take_argument(argv[i]);
    }
    if (counter.out == NULL || counter.begin_address == 0 || counter.end_address == 0) {
        fprintf(stderr, "icount plugin: needs begin=, end= and fd= of an open descriptor\n");
        return 1;
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, block_translated);
    qemu_plugin_register_atexit_cb(id, report, NULL);
    return 0;
}
