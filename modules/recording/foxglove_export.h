// A recording for Foxglove: its 3D panel shows organs, probes and forces without a plug-in.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::recording {

/// At most so many surfaces, transforms and arrows a second; poses and wrenches all.
inline constexpr double kFoxglovePictureHz = 30;
/// Length of a force's arrow per newton.
inline constexpr double kFoxgloveMetresPerNewton = 0.01;

struct FoxgloveReport {
  std::uint64_t samples = 0;       ///< of the recording, all of which are in the file
  std::uint64_t translations = 0;  ///< messages beside them
  std::vector<std::string> warnings = {};
};

/// Writes the samples of a recording, all of its parts, to another file, and beside them, on
/// channels of their own:
///   /tf                 foxglove::FrameTransform  from `world` to `probe_0`, …
///   /organ_0/surface    foxglove::SceneUpdate     the organ's triangles, in `world`
///   /probe_0/shape      foxglove::SceneUpdate     in `probe_0`
///   /probe_0/force      foxglove::SceneUpdate     an arrow from the probe, 1 cm for each newton
///   /probe_0/pose       foxglove::PoseInFrame     in `world`
///   /probe_0/wrench     palpate::plot::Wrench     for plots
/// @throws InputError as SampleReader does, or if `file` is there already; std::runtime_error as
/// McapWriter does
FoxgloveReport export_to_foxglove(const std::filesystem::path& recording,
                                  const std::filesystem::path& file);

}  // namespace palpate::recording
