// `palpate replay --rerun`: some of the stages again, in one process, on what the others said when
// they were recorded.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "palpate/run_options.h"

namespace palpate::launcher {

class UnpackedScene;

/// @param stages  haptics, collision, deformation: which are computed anew
/// @param run     its scene; `record` gets what was recorded of the others and what these say
/// @param recorded_with  the scene of the recording, and the files that come from it
/// @param another_scene  than the recorded one, be it with other settings
/// @throws InputError for a recording that cannot stand in: of a session that was reset, or from
///         later than its start, without a topic that is needed, of another organ
int rerun(const std::filesystem::path& recording, const std::vector<std::string>& stages,
          const RunOptions& run, const UnpackedScene& recorded_with, bool another_scene,
          std::ostream& out, std::ostream& log);

}  // namespace palpate::launcher
