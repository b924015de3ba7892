// Actions before a signal ends this program.
#pragma once

namespace tumble::host {

// Registers an action, which runs when SIGHUP, SIGINT, SIGPIPE, SIGQUIT, SIGTERM or SIGXFSZ (a limit of file sizes)
// ends this program. At most four actions are kept. An action must be async-signal-safe. A signal that is ignored, as
// nohup ignores SIGHUP, stays ignored.
void before_ending(void (*action)());

}  // namespace tumble::host
