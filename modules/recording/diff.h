// Compares two recordings sample by sample.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "modules/recording/sample_reader.h"

namespace palpate::recording {

/// Samples of one recording that may wait for those of the other [bytes]; where there would be
/// more, compare() throws.
inline constexpr std::size_t kMostWaitingToCompare = 512u << 20;

struct DiffOptions {
  std::filesystem::path a, b;
  std::set<std::string, std::less<>> ignore = {};  ///< names of topics, and of fields as in idl/
  std::filesystem::path csv = {};  ///< --csv: a row per sample and field that differ; empty: none
};

/// Where a value differs. Samples of a topic and key are compared in the order of each file; where
/// one was recorded in real time, with that of the other that is nearest in simulated time.
struct Difference {
  std::int64_t sim_time_ns = 0;  ///< of the sample in A
  std::string topic, key;
  std::string field;  ///< "positions_m[17]"
  std::string a, b;   ///< the values
};

/// The differences of one field of a topic.
struct FieldDifference {
  std::uint64_t samples = 0;  ///< that differ in it
  double largest = 0;         ///< ∣a − b∣
  bool is_text = false;       ///< has none
  std::int64_t largest_sim_time_ns = 0;
};

struct TopicDifference {
  std::uint64_t compared = 0, differing = 0;
  std::uint64_t only_in_a = 0, only_in_b = 0;
  std::map<std::string, FieldDifference> fields;
};

struct RecordingDifference {
  std::optional<Difference> first;  ///< earliest in simulated time
  std::map<std::string, TopicDifference> topics;
  std::vector<std::string> warnings;  ///< SampleReader::warnings() of both
  /// Of two in lockstep, one of which goes on from a snapshot: since when they are compared.
  std::optional<std::int64_t> from_ns;
  bool by_time = false;          ///< samples were paired by simulated time
  std::int64_t farthest_ns = 0;  ///< then: between two of a pair
  /// Then: fields in which no two runs agree, and topics that only one of them can have.
  std::set<std::string, std::less<>> left_out = {};
  bool equal() const;
};

/// Of two sessions in lockstep that begin at different times what was said before the later one is
/// left out: one that goes on from a snapshot is compared with one never interrupted.
/// @throws InputError as SampleReader does, for a name to ignore that is none, or where more than
/// `most_waiting` bytes of one would have to wait for the other;
/// std::runtime_error if the CSV file cannot be written
RecordingDifference compare(const DiffOptions& options,
                            std::size_t most_waiting = kMostWaitingToCompare);

void print_difference(const RecordingDifference& difference, std::ostream& out);

}  // namespace palpate::recording
