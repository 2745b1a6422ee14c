// Records a session: every sample of every topic, into one MCAP file (docs/recording.md).
#pragma once

#include <filesystem>
#include <map>
#include <utility>

#include "modules/recording/mcap_writer.h"
#include "modules/recording/session_samples.h"

namespace palpate::recording {

// Names of the metadata records.
inline constexpr const char* kSessionMetadata = "palpate session";  ///< first record of the file
inline constexpr const char* kSceneMetadata = "palpate scene";      ///< name, digest; once known

/// Puts samples into the file. Each writer of a topic has a channel of its own, so that gaps in
/// its sequence numbers can be told from other writers' samples.
class SampleFile {
 public:
  /// @throws std::runtime_error as McapWriter does
  SampleFile(const std::filesystem::path& file, const bus::BusOptions& session);
  /// Of a lockstep session: times are simulated, nothing tells of the machine.
  explicit SampleFile(const std::filesystem::path& file);

  void add(const TopicSample& sample);
  void flush() { writer_.flush(); }
  void close() { writer_.close(); }
  const McapStatistics& statistics() const { return writer_.statistics(); }
  std::uint64_t bytes_written() const { return writer_.bytes_written(); }

 private:
  std::uint16_t channel_of(const TopicSample& sample);
  void note_scene(const TopicSample& sample);

  McapWriter writer_;
  std::map<std::string_view, std::uint16_t> schemas_;  ///< by type name
  std::map<std::pair<const bus::TopicInfo*, bus::WriterId>, std::uint16_t> channels_;
  std::string scene_digest_;
};

/// Hears a session and writes it down.
class Recorder {
 public:
  /// @param session  told in the file: what `bus` was made of
  /// @throws std::runtime_error if the bus or the file fails
  Recorder(bus::Bus& bus, const bus::BusOptions& session, const std::filesystem::path& file);

  /// Writes all that has arrived. Call at least every 50 ms, or fast topics lose samples.
  /// @throws std::runtime_error naming the file and the system's reason (disk full, …)
  void poll();

  /// Writes what is left and ends the file.
  void close();

  int matched_writers() const { return reader_.matched_writers(); }
  const SampleFile& file() const { return file_; }

 private:
  SessionReader reader_;
  SampleFile file_;
};

}  // namespace palpate::recording
