// `palpate run --lockstep`: the real processes, driven by their data. And `--in-process`: the same
// session, the same bits, in one process.
#pragma once

#include <iosfwd>

#include "palpate/run_options.h"

namespace palpate::launcher {

/// Simulated time between two grants [s]. Nobody is more than two of them ahead of the slowest, so
/// memory stays bounded while a process is stopped.
inline constexpr double kGrant = 0.1;

/// Runs the scene for its duration (options.duration, else the scene's).
/// @returns the program's exit code
/// @throws InputError if neither says how long, or for a scene that cannot be used
int run_lockstep(const RunOptions& options, std::ostream& out, std::ostream& log);
int run_in_process(const RunOptions& options, std::ostream& out, std::ostream& log);

}  // namespace palpate::launcher
