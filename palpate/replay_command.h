// `palpate replay`: a recording shown as it was, or its probes' motion as input of a new run.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "palpate/run_options.h"

namespace palpate::launcher {

struct Playing {
  double start = 0;                     ///< seconds of the recording to leave out
  double rate = 1;                      ///< times as fast
  bool step = false;                    ///< a picture for each press of Enter
  std::vector<std::string> rerun = {};  ///< stages that are computed anew (rerun.h); empty: none
};

/// A recording that is only shown, or of which some stages are computed anew, takes few of the
/// options of a run.
/// @param given  names of options
/// @throws InputError naming one that would do nothing
void check_replay_options(const std::vector<std::string>& given, const Playing& playing,
                          const RunOptions& run);

/// Without a scene in `run`: plays every sample into the session, with a visualizer that shows it
/// (unless run.headless without frames). With one: runs that scene, every probe of the recording
/// moving as it moved then; all else is computed anew. With stages to rerun these alone, of that
/// scene or else of the recorded one.
/// @return an exit code of core/error.h
/// @throws InputError for a recording or scene that cannot be used
int replay_command(const std::filesystem::path& recording, const Playing& playing,
                   const RunOptions& run, std::ostream& out, std::ostream& log);

}  // namespace palpate::launcher
