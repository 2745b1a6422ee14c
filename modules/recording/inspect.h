// What a recording holds.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "modules/recording/sample_reader.h"

namespace palpate::recording {

struct TopicSummary {
  const bus::TopicInfo* topic = nullptr;
  std::size_t writers = 0;
  std::uint64_t samples = 0;
  std::uint64_t bytes = 0;              ///< of the payloads
  std::uint64_t missing = 0;            ///< gaps in the writers' sequence numbers
  bool thinned = false;                 ///< gaps were asked for, and are not counted
  std::uint64_t invalid = 0;            ///< refused by the codec: size, range, not finite
  std::int64_t first_ns = 0;            ///< earliest receive time
  std::int64_t last_ns = 0;             ///< latest receive time
  std::int64_t longest_spacing_ns = 0;  ///< between samples that follow each other

  double rate_hz() const;  ///< mean over the topic's samples; 0 for fewer than two
};

struct RecordingSummary {
  std::filesystem::path file;
  std::uint64_t file_bytes = 0;
  int parts = 1;  ///< files: a recorder that was started again began another
  bool torn = false;
  std::vector<std::string> warnings;  ///< a line each: torn files, parts left out
  McapMap cost;                       ///< recorder.h: kCostMetadata; empty if torn, or in lockstep
  McapMap session;                    ///< recorder.h: kSessionMetadata
  McapMap scene;                      ///< recorder.h: kSceneMetadata; empty if no scene was heard
  McapMap rerun;                      ///< recorder.h: kRerunMetadata; empty of a session's own
  std::int64_t first_ns = 0, last_ns = 0;  ///< receive times over all topics
  std::vector<TopicSummary> topics;        ///< those with samples, in the order of their names
};

/// Reads all of a recording.
/// @param csv_folder  if not empty: gets one file per topic and key, `probe_state_0.csv`,
/// `module_status_haptics.csv`, with the columns time_s (receive time since the recording's first
/// sample), sim_time_s, latency_s (receive time less source time), sequence, and the message's
/// own; and `module_inputs_haptics.csv` with a row per input of each status. Positions of nodes
/// are left out.
/// @param overwrite  those that another recording left there; else they are refused
/// @throws InputError as SampleReader and CsvExport do; std::runtime_error if a CSV file cannot be
/// written
RecordingSummary summarize(const std::filesystem::path& recording,
                           const std::filesystem::path& csv_folder = {}, bool overwrite = false);

/// "18.2 MB a minute, 2.1 % of a core, 0 samples lost": of a whole recording in real time.
std::string cost_text(const McapMap& cost, std::uint64_t bytes);

/// The one-screen table.
void print_summary(const RecordingSummary& summary, std::ostream& out);
/// The same for programs.
void print_json(const RecordingSummary& summary, std::ostream& out);

}  // namespace palpate::recording
