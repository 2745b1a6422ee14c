// Plays a recording: into a session as it was, or as input of a new run.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "modules/recording/sample_reader.h"
#include "modules/recording/session_samples.h"

namespace palpate::recording {

struct PlayReport {
  std::uint64_t samples = 0;
  std::uint64_t refused = 0;  ///< by DDS: not of their topic's type
  double duration = 0;        ///< from the first sample to the last [s]
  bool stopped = false;       ///< before the end
};

struct PlayOptions {
  double start = 0;  ///< of the recording to leave out [s]; what held then is written first
  double rate = 1;   ///< times as fast as it was received
  /// Called after each picture (node_positions), instead of keeping time; false ends it.
  std::function<bool()> wait_for_step;
  /// Sequence numbers as those of one writer of each topic: what the recording had thinned out, or
  /// several had written, is no gap for who listens.
  bool counts_anew = false;
};

/// @throws InputError where the recording ends before `start` [s], and as SampleReader does
void check_start(const std::filesystem::path& recording, double start);

/// Writes every sample, byte for byte but for options.counts_anew, with the spacing at which it was
/// received. A sample that is late is written at once; none is left out.
/// @param stop_requested  asked at least every 20 ms
/// @throws InputError as SampleReader::next does, and where the recording ends before the start
PlayReport play(SampleReader& recording, SessionWriter& session,
                const std::function<bool()>& stop_requested, const PlayOptions& options = {});

/// A probe's recorded motion as a file for the device `trajectory`.
struct ProbeTrajectory {
  std::uint32_t probe = 0;  ///< index in the recorded scene's list
  std::filesystem::path file;
  std::size_t rows = 0;
  double duration = 0;  ///< session time of the last row [s]
};

/// Writes `folder`/probe_<index>.csv (columns t, x, y, z, qx, qy, qz, qw in s and m, frame W) for
/// each probe in the recording, t being session time, so that a run that replaces the probes'
/// devices by these files moves them as they moved. Where the session was reset, the last stretch
/// counts.
/// @param warnings  receives a line for each reset, invalid sample and a torn file
/// @throws InputError if the recording cannot be read or holds no motion of a probe;
/// std::runtime_error if a file cannot be written
std::vector<ProbeTrajectory> extract_probe_trajectories(const std::filesystem::path& recording,
                                                        const std::filesystem::path& folder,
                                                        std::vector<std::string>& warnings);

}  // namespace palpate::recording
