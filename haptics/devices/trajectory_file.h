// Reads a recorded trajectory: CSV, optional '#' comment lines, a header, then one row per sample.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "modules/core/types.h"

namespace palpate::haptics {

/// One row of a recording.
struct TimedPose {
  double time = 0;  ///< as written in the file [s]
  Pose pose;        ///< in the recording's frame
};

/// Reads `file`: header `t,x,y,z,qx,qy,qz,qw` or the same with `,fx,fy,fz` (columns that are
/// checked but not used). Seconds, metres; coordinates within ±1000 m.
///
/// A row is skipped with a warning "file.csv:17: …" if it has another number of columns than the
/// header, a value that is not a finite number, a coordinate out of range, a time less than 1 µs
/// after the last good row's, or a quaternion whose length differs from 1 by more than 1e-3.
/// Accepted quaternions are normalised. A gap is a step in time over 0.1 s or over five times the
/// median step; it is reported, and bridged by the interpolation. Of each of the two kinds the
/// first 20 are reported in full, the rest by their number (and the longest gap).
///
/// @returns at least two rows, times strictly increasing
/// @throws InputError if the file cannot be read, its header is another one, or fewer than two
///         rows are usable
std::vector<TimedPose> read_trajectory(const std::filesystem::path& file,
                                       std::vector<std::string>& warnings);

}  // namespace palpate::haptics
