/// Signals as flags. The control loop blocks them; they reach the other thread, whose handler only
/// sets a flag and wakes it.
#ifndef QUIESCED_SIGNALS_H
#define QUIESCED_SIGNALS_H

namespace quiesced {

/// Blocks all that can be caught and ends a process in this thread and those it starts, and
/// installs handlers: SIGHUP reloads, SIGUSR1 writes the status file, the others request the stop.
/// Left alone is what a fault of the program raises (SIGSEGV and the like); SIGPIPE, SIGXFSZ and
/// what would stop the process where it is are ignored.
void install_signals();

/// Lets this thread take them. wake_fd: an eventfd that each writes to; -1: none.
void take_signals(int wake_fd);

bool stop_is_requested();
/// True once for each request.
bool take_reload_request();
bool take_status_request();

/// Makes sure that 0, 1 and 2 are open, so that nothing else gets these numbers.
void reserve_standard_files();

} // namespace quiesced

#endif
