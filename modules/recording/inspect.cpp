#include "modules/recording/inspect.h"

#include <json/json.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <iomanip>
#include <limits>
#include <optional>
#include <ostream>
#include <sstream>

#include "modules/core/text.h"
#include "modules/core/units.h"
#include "modules/recording/csv_export.h"
#include "modules/recording/mcap_bytes.h"
#include "modules/recording/recorder.h"

namespace palpate::recording {
namespace {

std::string entry(const McapMap& map, const std::string& key) {
  const auto found = map.find(key);
  return found == map.end() ? "?" : printable(found->second);
}

// Of one writer; and of what it said once the session ran: one that goes on from a snapshot begins
// with the states of then, told again.
struct WriterSequence {
  bus::SequenceNumbers all, running;
};

class Summarizer {
 public:
  /// @param about_channel  of the sample: names its writer, who may go on in the next part
  void add(const RecordedSample& sample, const McapMap& about_channel, bool valid) {
    TopicSummary& topic = topics_[sample.topic->name];
    const std::int64_t time = sample.received_time_ns;
    if (topic.samples == 0) {
      topic.topic = sample.topic;
      topic.first_ns = topic.last_ns = time;
    }
    topic.longest_spacing_ns = std::max(topic.longest_spacing_ns, time - topic.last_ns);
    topic.first_ns = std::min(topic.first_ns, time);
    topic.last_ns = std::max(topic.last_ns, time);
    ++topic.samples;
    topic.bytes += sample.payload.size();
    if (!valid) ++topic.invalid;
    topic.thinned |= sample.thinned;
    add_sequence(sample, about_channel);
  }

  void finish(RecordingSummary& summary) {
    const bool goes_on =
        entry(summary.session, "clock") == kSimulated && first_sim_ns_.value_or(0) > 0;
    for (const auto& [channel, writer] : writers_) {
      TopicSummary& topic = topics_[channel.first];
      ++topic.writers;
      if (!topic.thinned) topic.missing += (goes_on ? writer.running : writer.all).missing();
    }
    summary.first_ns = topics_.empty() ? 0 : std::numeric_limits<std::int64_t>::max();
    for (const auto& [name, topic] : topics_) {
      summary.first_ns = std::min(summary.first_ns, topic.first_ns);
      summary.last_ns = std::max(summary.last_ns, topic.last_ns);
      summary.topics.push_back(topic);
    }
  }

 private:
  void add_sequence(const RecordedSample& sample, const McapMap& about_channel) {
    const Header header = messages::header_of(sample.payload);
    const auto named = about_channel.find("writer");
    const std::string name =
        named == about_channel.end() ? std::to_string(sample.channel) : named->second;
    WriterSequence& writer = writers_[{sample.topic->name, name}];
    writer.all.count(header.sequence);
    if (header.sim_time_ns > 0) writer.running.count(header.sequence);
    const bool stream = sample.topic->delivery == bus::Delivery::kStream;
    if (stream && !first_sim_ns_) first_sim_ns_ = header.sim_time_ns;
  }

  std::map<std::string_view, TopicSummary> topics_;
  std::map<std::pair<std::string_view, std::string>, WriterSequence> writers_;
  std::optional<std::int64_t> first_sim_ns_;  ///< of streams
};

std::string fixed(double value, int decimals) {
  std::ostringstream stream;
  stream << std::fixed << std::setprecision(decimals) << value;
  return stream.str();
}

std::string time_of_day(const std::string& unix_ns) {
  try {
    const std::time_t seconds = std::stoll(unix_ns) / kNanosecondsPerSecond;
    std::tm utc{};
    std::ostringstream stream;
    stream << std::put_time(gmtime_r(&seconds, &utc), "%Y-%m-%d %H:%M:%S UTC");
    return stream.str();
  } catch (const std::logic_error&) {  // the recording does not say
    return "at an unknown time";
  }
}

std::string session_text(const McapMap& session) {
  if (entry(session, "clock") == kSimulated) {
    return "in lockstep, or in one process: times are simulated";
  }
  return entry(session, "session") + " in domain " + entry(session, "domain") + ", recorded " +
         time_of_day(entry(session, "start_unix_ns"));
}

void print_row(const TopicSummary& topic, std::int64_t start_ns, std::ostream& out) {
  const std::string type(
      topic.topic->type->wire_name.substr(topic.topic->type->wire_name.rfind(':') + 1));
  out << std::left << std::setw(17) << topic.topic->name << std::setw(18) << type << std::right
      << std::setw(8) << topic.samples << std::setw(9) << fixed(topic.rate_hz(), 1) << std::setw(12)
      << topic.bytes << std::setw(9) << fixed(seconds_from_ns(topic.first_ns - start_ns), 3)
      << std::setw(9) << fixed(seconds_from_ns(topic.last_ns - start_ns), 3) << std::setw(9)
      << (topic.thinned ? "thinned" : std::to_string(topic.missing)) << std::setw(12)
      << fixed(1e3 * seconds_from_ns(topic.longest_spacing_ns), 1) << std::setw(8) << topic.invalid
      << std::setw(8) << topic.writers << '\n';
}

}  // namespace

double TopicSummary::rate_hz() const {
  if (samples < 2 || last_ns <= first_ns) return 0;
  return static_cast<double>(samples - 1) / seconds_from_ns(last_ns - first_ns);
}

RecordingSummary summarize(const std::filesystem::path& recording,
                           const std::filesystem::path& csv_folder, bool overwrite) {
  SampleReader reader(recording);
  Summarizer summarizer;
  std::optional<CsvExport> csv;
  if (!csv_folder.empty()) csv.emplace(csv_folder, overwrite);
  std::optional<std::int64_t> start_ns;
  messages::AnyMessage message;
  while (const auto sample = reader.next()) {
    if (!start_ns) start_ns = sample->received_time_ns;
    const bool valid = sample->topic->type->decode(sample->payload, message) == nullptr;
    summarizer.add(*sample, reader.about_channel(sample->channel), valid);
    if (csv && valid) csv->add(*sample, message, *start_ns);
  }
  if (csv) csv->close();

  RecordingSummary summary;
  summary.file = recording;
  summary.file_bytes = reader.file_bytes();
  summary.parts = reader.parts();
  summary.torn = reader.torn();
  summary.warnings = reader.warnings();
  summary.session = reader.metadata(kSessionMetadata);
  summary.scene = reader.metadata(kSceneMetadata);
  summary.cost = reader.metadata(kCostMetadata);
  summary.rerun = reader.metadata(kRerunMetadata);
  summarizer.finish(summary);
  return summary;
}

std::string cost_text(const McapMap& cost, std::uint64_t bytes) {
  const auto number = [&](const char* key) {
    return std::strtod(entry(cost, key).c_str(), nullptr);
  };
  const double wall = number("wall_s");
  if (!(wall > 0)) return "what it took is not known";
  return fixed(60e-6 * static_cast<double>(bytes) / wall, 1) + " MB a minute, " +
         fixed(100 * number("processor_s") / wall, 1) + " % of a core, " +
         entry(cost, "samples_lost") + " samples lost";
}

void print_summary(const RecordingSummary& summary, std::ostream& out) {
  out << "recording  " << summary.file.string() << ", "
      << fixed(1e-6 * double(summary.file_bytes), 1) << " MB, "
      << (summary.parts > 1 ? "in " + std::to_string(summary.parts) + " parts, " : "")
      << (summary.torn ? "torn: ends at its last whole record" : "whole") << '\n'
      << "session    " << session_text(summary.session) << '\n';
  if (summary.scene.empty()) {
    out << "scene      none was heard\n";
  } else {
    out << "scene      " << entry(summary.scene, "name") << ", digest "
        << entry(summary.scene, "digest") << '\n';
  }
  if (!summary.rerun.empty()) {
    out << "rerun      " << entry(summary.rerun, "stages") << " computed anew; the rest is of "
        << entry(summary.rerun, "recording") << ", scene " << entry(summary.rerun, "scene")
        << ", digest " << entry(summary.rerun, "digest") << '\n';
  }
  out << "duration   " << fixed(seconds_from_ns(summary.last_ns - summary.first_ns), 3) << " s\n";
  if (!summary.cost.empty()) {
    out << "recorder   " << cost_text(summary.cost, summary.file_bytes) << '\n';
  }
  out << "\ntopic            type               samples  rate Hz       bytes  first s   last s"
         "  missing  longest ms invalid writers\n";
  for (const TopicSummary& topic : summary.topics) print_row(topic, summary.first_ns, out);
}

void print_json(const RecordingSummary& summary, std::ostream& out) {
  Json::Value value;
  value["recording"] = summary.file.string();
  value["bytes"] = Json::UInt64(summary.file_bytes);
  value["torn"] = summary.torn;
  value["parts"] = summary.parts;
  for (const auto& [key, text] : summary.session) value["session"][key] = text;
  for (const auto& [key, text] : summary.scene) value["scene"][key] = text;
  for (const auto& [key, text] : summary.cost) value["recorder"][key] = text;
  for (const auto& [key, text] : summary.rerun) value["rerun"][key] = text;
  value["duration_s"] = seconds_from_ns(summary.last_ns - summary.first_ns);
  value["topics"] = Json::arrayValue;
  for (const TopicSummary& topic : summary.topics) {
    Json::Value row;
    row["topic"] = std::string(topic.topic->name);
    row["samples"] = Json::UInt64(topic.samples);
    row["rate_hz"] = topic.rate_hz();
    row["bytes"] = Json::UInt64(topic.bytes);
    row["first_s"] = seconds_from_ns(topic.first_ns - summary.first_ns);
    row["last_s"] = seconds_from_ns(topic.last_ns - summary.first_ns);
    row["missing"] = Json::UInt64(topic.missing);
    row["thinned"] = topic.thinned;
    row["invalid"] = Json::UInt64(topic.invalid);
    row["longest_spacing_s"] = seconds_from_ns(topic.longest_spacing_ns);
    row["writers"] = Json::UInt64(topic.writers);
    value["topics"].append(row);
  }
  out << Json::writeString(Json::StreamWriterBuilder(), value) << '\n';
}

}  // namespace palpate::recording
