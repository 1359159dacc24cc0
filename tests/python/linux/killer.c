// Runs a program and kills it at its N-th system call, of whichever thread: before the kernel does
// it. killer N COUNT_FILE PROGRAM ARGUMENT...; N 0: only counts. The processes that it starts are
// left alone. Ends with the program's code, or 128 and the signal.
#define _GNU_SOURCE
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

static void start(char **arguments) {
    if (ptrace(PTRACE_TRACEME, 0, NULL, NULL) != 0) {
        _exit(126);
    }
    execv(arguments[0], arguments);
    _exit(127);
}

/// The signal to go on with after a stop: the tracer's own ones are nobody's.
static int pass_on(int status, int *is_call) {
    const int signal_number = WSTOPSIG(status);
    *is_call = signal_number == (SIGTRAP | 0x80);
    const int is_mine = *is_call || signal_number == SIGTRAP || signal_number == SIGSTOP;
    return is_mine ? 0 : signal_number;
}

int main(int count, char **arguments) {
    if (count < 4) {
        return 125;
    }
    const long kill_at = strtol(arguments[1], NULL, 10);
    const pid_t program = fork();
    if (program == 0) {
        start(arguments + 3);
    }
    int status = 0;
    int is_entry = 1; // of the calls of all threads; each has its own half of a pair
    long stops = 0;
    int end = 0;
    if (waitpid(program, &status, 0) != program || !WIFSTOPPED(status)) {
        return 124;
    }
    ptrace(PTRACE_SETOPTIONS, program, NULL,
           PTRACE_O_TRACESYSGOOD | PTRACE_O_TRACECLONE | PTRACE_O_EXITKILL);
    ptrace(PTRACE_SYSCALL, program, NULL, NULL);
    for (;;) {
        const pid_t who = waitpid(-1, &status, __WALL);
        if (who < 0) {
            break;
        }
        if (!WIFSTOPPED(status)) {
            end = who == program
                      ? (WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status))
                      : end;
            continue;
        }
        int is_call = 0;
        const int number = pass_on(status, &is_call);
        if (is_call) {
            struct __ptrace_syscall_info about;
            is_entry = ptrace(PTRACE_GET_SYSCALL_INFO, who, sizeof about, &about) > 0 &&
                       about.op == PTRACE_SYSCALL_INFO_ENTRY;
            stops += is_entry;
            if (is_entry && stops == kill_at) {
                kill(program, SIGKILL);
            }
        }
        ptrace(PTRACE_SYSCALL, who, NULL, number);
    }
    FILE *const file = fopen(arguments[2], "w");
    if (file == NULL || fprintf(file, "%ld\n", stops) < 0 || fclose(file) != 0) {
        return 123;
    }
    return end;
}
