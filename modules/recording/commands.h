// What `palpate inspect` and `palpate replay` do, after their options have been parsed.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

#include "modules/bus/bus.h"
#include "modules/recording/diff.h"

namespace palpate::recording {

struct InspectOptions {
  std::filesystem::path recording;      ///< RECORDING
  std::filesystem::path csv_folder;     ///< --csv DIR; empty: none
  bool json = false;                    ///< --json
  std::filesystem::path repaired = {};  ///< --repair OUT; empty: none
  std::filesystem::path foxglove = {};  ///< --foxglove OUT; empty: none
  bool overwrite = false;               ///< tables that are in the CSV folder already
};

/// Prints the recording's table to `out`; a torn file's warning and errors go to `err`. To repair
/// it, writes what can be read to another file and prints the table of that. For Foxglove, writes
/// another file with its types beside ours.
/// @return an exit code of core/error.h
int run_inspect_command(const InspectOptions& options, std::ostream& out, std::ostream& err);

/// Prints where the two recordings of `options` differ.
/// @return kExitDone if they are equal, kExitFailed if not, kExitBadInput for anything in the way
int run_diff_command(const DiffOptions& options, std::ostream& out, std::ostream& err);

struct ReplayOptions {
  std::filesystem::path recording;  ///< RECORDING
  bus::BusOptions session;          ///< --session, --domain: where it is played
  double wait_for_reader = 5;       ///< longest wait for someone who shows it [s]
  double start = 0;                 ///< --start: seconds of it to leave out
  double rate = 1;                  ///< --rate: times as fast
  bool step = false;                ///< --step: a picture for each line of standard input
};

/// Plays a recording into a session (without SCENE; with one, see extract_probe_trajectories).
/// @return an exit code of core/error.h; kExitDone also when stopped
int run_replay_command(const ReplayOptions& options, const std::function<bool()>& stop_requested,
                       std::ostream& out, std::ostream& err);

}  // namespace palpate::recording
