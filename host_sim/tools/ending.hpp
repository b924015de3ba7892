// What must be done before a signal ends this program.
#pragma once

namespace tumble::host {

// Calls `action` when SIGHUP, SIGINT, SIGPIPE, SIGQUIT, SIGTERM or SIGXFSZ (a limit of file sizes) ends this program,
// once for each action that is given, four at most. It may do only what a signal handler may. A signal that is ignored,
// as nohup ignores SIGHUP, stays so.
void before_ending(void (*action)());

}  // namespace tumble::host
