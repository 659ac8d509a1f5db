#pragma once
// Ctrl-C: ends the program with code 130 after removing the progress bar, until a verb asks to be told instead.

#include <atomic>
#include <string_view>

namespace forcegate {

/// Installs the handlers; ignores SIGPIPE, so that a dying worker is an error value and not the end of the run.
void install_signal_handlers();

/// True while a bar stands on the terminal; the handler removes it.
extern std::atomic<bool> g_bar_on_terminal;

/// After this call the first SIGINT, SIGTERM or SIGHUP sets the flag, the second ends the program.
const std::atomic<bool>& catch_interrupt();

/// Who is ended by the first of them is told so, as the error of any other end: for `json` by one object on stdout. Only this process: a
/// child gets the same Ctrl-C.
void tell_of_interrupt(bool json);

/// What that end says beside it, as of a journal that holds what is done. Before the work begins.
void help_after_interrupt(std::string_view help);

/// An object stands on stdout already.
void json_is_told();

}  // namespace forcegate
