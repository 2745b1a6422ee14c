// The samples of a recording, front to back.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "modules/bus/topics.h"
#include "modules/recording/mcap_reader.h"

namespace palpate::recording {

struct RecordedSample {
  const bus::TopicInfo* topic = nullptr;
  std::uint16_t channel = 0;          ///< one for each writer of a topic
  std::int64_t received_time_ns = 0;  ///< monotonic clock of the recorder's host
  std::vector<std::uint8_t> payload;  ///< CDR with its encapsulation header
};

class SampleReader {
 public:
  /// @throws InputError as McapReader does
  explicit SampleReader(const std::filesystem::path& file);

  /// The next sample; none at the end, be it regular or torn.
  /// @throws InputError "file: offset N: …" if the bytes are not records, a topic is not one of
  /// ours, or a schema differs from the present one
  std::optional<RecordedSample> next();

  /// Entries of the metadata record of that name read so far; empty if there was none.
  McapMap metadata(const std::string& name) const;

  const std::filesystem::path& file() const { return file_; }
  std::uint64_t file_bytes() const { return reader_.file_bytes(); }
  /// After next() gave none: its writer was stopped hard.
  bool torn() const { return reader_.torn(); }
  /// One line about a torn file: where it ends, and what is lost.
  std::string torn_warning() const;

 private:
  void check(const McapSchema& schema) const;
  void add(const McapChannel& channel);
  [[noreturn]] void refuse(const std::string& what) const;

  std::filesystem::path file_;
  McapReader reader_;
  std::map<std::uint16_t, std::string> schema_names_;
  std::map<std::uint16_t, const bus::TopicInfo*> topics_;  ///< by channel
  std::map<std::string, McapMap> metadata_;
};

}  // namespace palpate::recording
