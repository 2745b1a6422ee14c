// Records a session: every sample of every topic, into one MCAP file (docs/recording.md).
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "modules/recording/hearing.h"
#include "modules/recording/mcap_writer.h"
#include "modules/recording/session_samples.h"
#include "modules/recording/space_watch.h"
#include "modules/recording/topic_selection.h"
#include "modules/recording/writing_thread.h"

namespace palpate::recording {

// Names of the metadata records.
inline constexpr const char* kSessionMetadata = "palpate session";  ///< first record of the file
inline constexpr const char* kCostMetadata = "palpate recorder";    ///< last: what it took
inline constexpr const char* kSceneMetadata = "palpate scene";      ///< name, digest; once known
/// Where only some stages were computed: `stages`; the rest is of `recording`, whose scene was
/// `scene` with `digest`.
inline constexpr const char* kRerunMetadata = "palpate rerun";

/// Metadata of a session: TopicSelection::text(). Topics without a sample were silent if they are
/// in it. Recordings made before have no such entry.
inline constexpr const char* kSelectedTopics = "topics";

/// Metadata `clock` of a session: the file's times are nanoseconds since 1970. Before, they were of
/// the monotonic clock, and the entry was missing.
inline constexpr const char* kTimeOfDay = "time of day";
/// Of a lockstep session.
inline constexpr const char* kSimulated = "simulated";

/// One instant on two clocks [ns].
struct Clocks {
  std::int64_t monotonic = 0;
  std::int64_t unix = 0;

  static Clocks now();
};

/// Puts samples into the file. Each writer of a topic has a channel of its own, so that gaps in
/// its sequence numbers can be told from other writers' samples.
class SampleFile {
 public:
  /// @throws std::runtime_error as McapWriter does
  /// @param clocks  what time of day the samples' monotonic times are: the file's are of the day
  /// @param topics  what is to be added
  SampleFile(const std::filesystem::path& file, const bus::BusOptions& session,
             const Clocks& clocks = Clocks::now(), TopicSelection topics = {});
  /// Of a lockstep session: times are simulated, nothing tells of the machine.
  static SampleFile of_lockstep(const std::filesystem::path& file, TopicSelection topics = {}) {
    return SampleFile(std::move(topics), file);
  }

  /// Leaves out what was not selected.
  void add(const TopicSample& sample) {
    if (takes(sample)) write(sample);
  }
  /// Whether it was selected; counts what is missing before it. One thread may ask while another
  /// writes.
  bool takes(const TopicSample& sample);
  /// Selected or not.
  void write(const TopicSample& sample);
  void add_metadata(const McapMetadata& metadata) { writer_.add_metadata(metadata); }
  /// In the place of a file of that name which a scene names and which is there.
  void add_attachment(const McapAttachment& attachment);
  void end_chunk() { writer_.end_chunk(); }
  void flush() { writer_.flush(); }
  void close() { writer_.close(); }
  const McapStatistics& statistics() const { return writer_.statistics(); }
  std::uint64_t bytes_written() const { return writer_.bytes_written(); }
  /// Gaps in the sequence numbers of what was to be added, selected or not.
  std::uint64_t lost() const;
  void add_lost() { ++lost_; }

 private:
  SampleFile(TopicSelection topics, const std::filesystem::path& file);
  std::uint16_t channel_of(const TopicSample& sample);
  void note_scene(const TopicSample& sample);
  void attach_files(const SceneDescription& scene, std::uint64_t log_time_ns);

  McapWriter writer_;
  TopicSelection topics_;
  std::int64_t to_time_of_day_ns_ = 0;
  std::map<std::string_view, std::uint16_t> schemas_;  ///< by type name
  std::map<std::pair<const bus::TopicInfo*, bus::WriterId>, std::uint16_t> channels_;
  std::map<std::pair<const bus::TopicInfo*, bus::WriterId>, bus::SequenceNumbers> numbers_;
  std::uint64_t lost_ = 0;  ///< beside them
  std::string scene_digest_;
  std::set<std::string> attached_;  ///< names that add_attachment() was given
};

/// Hears a session and writes it down, in a thread of its own.
class Recorder {
 public:
  /// @param session  told in the file: what `bus` was made of
  /// @throws std::runtime_error if the bus or the file fails
  Recorder(bus::Bus& bus, const bus::BusOptions& session, const std::filesystem::path& file,
           const TopicSelection& topics = {});

  /// Takes all that has arrived. Call at least every 50 ms, or fast topics lose samples on a bus
  /// that does not gather them (bus::Arrivals).
  /// @return what is to be said of the disk's space, mostly nothing
  /// @throws std::runtime_error naming the file and the system's reason (disk full, …)
  std::string poll();
  /// The disk has no more room: close().
  bool full() const { return full_; }
  /// So far.
  std::uint64_t samples_written() const { return samples_written_; }

  /// Writes what is left, and what the recorder took, and ends the file.
  /// @return that: `wall_s`, `processor_s` of this process, `samples_lost`
  McapMap close();

  int matched_writers() const { return reader_.matched_writers(); }
  /// Whether it is on record what these modules say from now on, and the scene already. Call it
  /// always with the same ones.
  bool hears(const std::vector<std::string>& modules);
  /// After close().
  const SampleFile& file() const { return file_; }

 private:
  double age() const;  ///< [s]
  void end_round();
  std::string news();

  bus::Bus& bus_;
  SessionReader reader_;
  std::optional<Hearing> hearing_;
  bool heard_scene_ = false;
  SampleFile file_;
  SpaceWatch space_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::atomic<bool> full_ = false;
  std::atomic<std::uint64_t> samples_written_ = 0;
  std::mutex news_mutex_;
  std::string news_;
  WritingThread thread_;  ///< uses all before
};

}  // namespace palpate::recording
