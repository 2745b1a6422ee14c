// `palpate run`: starts the modules of a scene, watches them, stops them.
#pragma once

#include <iosfwd>

#include "palpate/run_options.h"

namespace palpate::launcher {

/// Waits until every module started is ready, starts the session, prints a status line a second,
/// names a module that ends with its last error and goes on with the rest, and stops all when the
/// duration is reached or a signal says so. A window stays after that, with what was felt, until
/// the person closes it (unless options.close). A session that already runs is joined, and goes on
/// without this launcher's modules when it ends.
/// @return kExitDone; kExitFailed if a module failed; kExitBadInput if one refused its input
/// @throws InputError for a scene that cannot be used; std::runtime_error if nothing can start
int run_command(const RunOptions& options, std::ostream& out, std::ostream& log);

}  // namespace palpate::launcher
