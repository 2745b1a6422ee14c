// The snapshot that a run without a clock writes (modules/runtime/snapshot.h): in one process as it
// is, in lockstep of the parts that its processes leave.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "modules/scene/scene.h"
#include "palpate/run_options.h"

namespace palpate::launcher {

/// @throws InputError where what it says of snapshots does not go together, or a file is there
/// already
void check_snapshots(const RunOptions& options);

/// Where a module of a lockstep writes its part of options.snapshot.
std::filesystem::path snapshot_part(const RunOptions& options, const std::string& module);

/// Says that it is written, and of which time: a cycle may begin later than was asked for.
void tell_snapshot(const RunOptions& options, std::int64_t time_ns, std::ostream& log);

/// Says why it is not. @return the exit code
int tell_no_snapshot(const RunOptions& options, double reached, std::ostream& log);

/// Those that are there.
void remove_snapshot_parts(const RunOptions& options, const std::vector<std::string>& modules);

/// Writes it of its parts, which are taken away.
/// @return false where the modules have not all left theirs
bool unite_snapshot(const RunOptions& options, const std::vector<std::string>& modules,
                    const scene::Scene& scene, std::ostream& log);

}  // namespace palpate::launcher
