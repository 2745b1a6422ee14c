// A small MCAP file with every kind of record that recordings use.
#pragma once

#include <filesystem>
#include <utility>
#include <vector>

#include "modules/recording/mcap_writer.h"

namespace palpate::recording {

/// Writes metadata, two schemas, two channels and `message_count` messages.
/// @return the offsets behind each whole record, as the writer counts them
inline std::vector<std::uint64_t> write_sample_file(const std::filesystem::path& file,
                                                    int message_count, bool close = true) {
  McapWriter writer(file);
  std::vector<std::uint64_t> ends{writer.bytes_written()};
  const auto note = [&] { ends.push_back(writer.bytes_written()); };
  writer.add_metadata({"session", {{"name", "bench"}, {"clock", "monotonic"}}});
  note();
  const auto force = writer.add_schema({0, "Force", "omgidl", "struct Force { double f; };"});
  note();
  const auto pose = writer.add_schema({0, "Pose", "omgidl", "struct Pose { double x; };"});
  note();
  const auto forces = writer.add_channel({0, force, "haptic_force", "cdr", {}});
  note();
  const auto poses = writer.add_channel({0, pose, "probe_state", "cdr", {{"key", "probe"}}});
  note();
  for (int i = 0; i < message_count; ++i) {
    const auto k = static_cast<std::uint64_t>(i);
    const McapMessage message{i % 3 == 0 ? poses : forces,
                              static_cast<std::uint32_t>(i + 1),
                              1'000'000 * (k + 1),
                              999'000 * (k + 1),
                              {}};
    const std::vector<std::uint8_t> payload(static_cast<std::size_t>(i), std::uint8_t(0xA0 + i));
    writer.add_message(message, payload);
    note();
  }
  if (close) {
    writer.close();
  } else {
    writer.flush();
  }
  return ends;
}

}  // namespace palpate::recording
