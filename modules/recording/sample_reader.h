// The samples of a recording, front to back; of one whose recorder was started again, of all its
// parts.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "modules/bus/topics.h"
#include "modules/recording/mcap_reader.h"

namespace palpate::recording {

struct RecordedSample {
  const bus::TopicInfo* topic = nullptr;
  std::uint32_t channel = 0;          ///< one for each writer of a topic, over all parts
  bool thinned = false;               ///< of its writer's samples only some are here
  std::int64_t received_time_ns = 0;  ///< monotonic clock of the recorder's host
  std::uint64_t log_time_ns = 0;      ///< the same, on the file's clock
  std::uint64_t publish_time_ns = 0;  ///< when its writer made it, on the file's clock
  std::vector<std::uint8_t> payload;  ///< CDR with its encapsulation header
};

/// Metadata of a channel whose topic was recorded at most so many times a second.
inline constexpr const char* kThinned = "at_most_hz";

/// Where a recorder that is started again goes on: FILE.part2.mcap, FILE.part3.mcap, …
/// @param number  1: the recording's own name
std::filesystem::path part_of(const std::filesystem::path& recording, int number);

/// The next one there is after that number; nothing if none is. A recorder that ended before it had
/// made its file leaves a number out.
std::optional<int> part_after(const std::filesystem::path& recording, int number);

/// Whether a part whose session's metadata are `later` goes on where one of `before` ended: an
/// earlier recording of that name may have left parts behind.
bool goes_on(const McapMap& before, const McapMap& later);

class SampleReader {
 public:
  /// @throws InputError as McapReader does
  explicit SampleReader(const std::filesystem::path& file);

  /// The next sample; none at the end, be it regular or torn. Translations for Foxglove
  /// (foxglove_export.h) are passed over. After the end comes the next part, if it is of the same
  /// session and was begun later; `channel` goes on counting. A part that does not even begin as a
  /// recording does is left out.
  /// @throws InputError "file: offset N: …" if the bytes are not records, a topic is not one of
  /// ours, or a schema differs from the present one
  std::optional<RecordedSample> next();

  /// Entries of the metadata record of that name read so far; empty if there was none.
  McapMap metadata(const std::string& name) const;

  /// After next() gave none: whether all that was said of a topic was to be recorded, or a part of
  /// it at regular times. False of recordings that do not say.
  bool selected(const std::string& topic) const;

  /// Metadata of a sample's channel: `writer`, kThinned.
  const McapMap& about_channel(std::uint32_t channel) const;

  const std::filesystem::path& file() const { return file_; }
  std::uint64_t file_bytes() const;                                 ///< with those of parts begun
  int parts() const { return 1 + (later_ ? later_->parts() : 0); }  ///< begun
  /// After next() gave none: the writer of one of its parts was stopped hard.
  bool torn() const { return reader_.torn() || (later_ && later_->torn()); }
  /// After next() gave none: a line about each torn file, where it ends, and about each part left
  /// out.
  std::vector<std::string> warnings() const;

 private:
  SampleReader(const std::filesystem::path& recording, int part);
  std::optional<RecordedSample> next_of_part();
  void look_for_next_part();
  std::unique_ptr<SampleReader> part_that_goes_on(int number);
  void read_clocks(const McapMap& session);
  std::int64_t session_ns(std::uint64_t time_of_day_ns) const;
  void add(const McapSchema& schema);
  void add(const McapChannel& channel);
  [[noreturn]] void refuse(const std::string& what) const;

  std::filesystem::path recording_;
  int part_;
  std::filesystem::path file_;
  McapReader reader_;
  std::int64_t to_time_of_day_ns_ = 0;
  std::uint32_t first_channel_ = 0;  ///< in the numbers that next() gives
  std::uint32_t channel_count_ = 0;
  std::unique_ptr<SampleReader> later_;
  bool looked_for_later_ = false;
  std::vector<std::string> left_out_;    ///< parts behind this one
  std::optional<RecordedSample> first_;  ///< read already
  std::map<std::uint16_t, std::string> schema_names_;
  std::map<std::uint16_t, const bus::TopicInfo*> topics_;  ///< by channel
  std::map<std::uint16_t, McapMap> about_;                 ///< channels
  std::map<std::string, McapMap> metadata_;
  std::vector<std::string> selections_;  ///< of repaired parts there are several
};

}  // namespace palpate::recording
