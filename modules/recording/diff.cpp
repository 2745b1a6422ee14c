#include "modules/recording/diff.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <iomanip>
#include <limits>
#include <optional>
#include <ostream>
#include <stdexcept>

#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/core/whole_file.h"
#include "modules/messages/csv.h"
#include "modules/messages/values.h"
#include "modules/recording/recorder.h"
#include "modules/runtime/wiring.h"

namespace palpate::recording {
namespace {

using messages::Value;

class Comparison {
 public:
  Comparison(const DiffOptions& options, std::size_t most_waiting, bool by_time)
      : options_(options), most_waiting_(most_waiting) {
    result_.by_time = by_time;
    if (options.csv.empty()) return;
    csv_.emplace(options.csv, "sim_time_s,topic,key,field,largest_difference\n",
                 "table of differences");
  }

  void add_a(RecordedSample sample) { add(std::move(sample), &Stream::a); }
  void add_b(RecordedSample sample) { add(std::move(sample), &Stream::b); }

  RecordingDifference finish() {
    for (auto& [name, stream] : streams_) {
      while (compare_next(name.first, name.second, stream)) {
      }
      TopicDifference& topic = result_.topics[name.first];
      topic.only_in_a += stream.a.size();
      topic.only_in_b += stream.b.size();
    }
    if (csv_) csv_->finish();
    return std::move(result_);
  }

 private:
  // Samples of one topic and key that wait for those of the other file.
  struct Stream {
    std::deque<RecordedSample> a, b;
  };

  void add(RecordedSample sample, std::deque<RecordedSample> Stream::*side) {
    const std::string topic(sample.topic->name);
    if (options_.ignore.contains(topic)) return;
    // What cannot be decoded has no key.
    const bool valid = sample.topic->type->decode(sample.payload, message_a_) == nullptr;
    const std::string key = valid ? messages::key_text(message_a_) : std::string();
    Stream& stream = streams_[{topic, key}];
    waiting_ += cost_of(sample);
    (stream.*side).push_back(std::move(sample));
    // By time the nearest is known once the next one is.
    const std::size_t needed = result_.by_time ? 2 : 1;
    if (stream.a.size() < needed || stream.b.size() < needed) return demand_room();
    while (stream.a.size() >= needed && stream.b.size() >= needed) {
      compare_next(topic, key, stream);
    }
  }

  /// Compares the first of both, or passes over one that has no partner. @return false: one is
  /// empty
  bool compare_next(const std::string& topic, const std::string& key, Stream& stream) {
    if (stream.a.empty() || stream.b.empty()) return false;
    if (result_.by_time && is_nearer(stream.a, stream.b)) {
      ++result_.topics[topic].only_in_a;
      pop(stream.a);
    } else if (result_.by_time && is_nearer(stream.b, stream.a)) {
      ++result_.topics[topic].only_in_b;
      pop(stream.b);
    } else {
      if (result_.by_time) {
        result_.farthest_ns = std::max(result_.farthest_ns, apart(stream.a[0], stream.b[0]));
      }
      compare(topic, key, stream.a.front(), stream.b.front());
      pop(stream.a);
      pop(stream.b);
    }
    return true;
  }

  /// Is the second of these nearer to the other's first than the first of these?
  static bool is_nearer(const std::deque<RecordedSample>& these,
                        const std::deque<RecordedSample>& others) {
    return these.size() > 1 && apart(these[1], others[0]) < apart(these[0], others[0]);
  }
  /// In simulated time [ns], 292 years at most: those of what no codec takes may be farther apart.
  static std::int64_t apart(const RecordedSample& a, const RecordedSample& b) {
    const std::int64_t of_a = messages::header_of(a.payload).sim_time_ns;
    const std::int64_t of_b = messages::header_of(b.payload).sim_time_ns;
    const std::uint64_t apart_ns = static_cast<std::uint64_t>(std::max(of_a, of_b)) -
                                   static_cast<std::uint64_t>(std::min(of_a, of_b));
    constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
    return static_cast<std::int64_t>(std::min<std::uint64_t>(apart_ns, kMost));
  }
  void pop(std::deque<RecordedSample>& samples) {
    waiting_ -= cost_of(samples.front());
    samples.pop_front();
  }

  static std::size_t cost_of(const RecordedSample& sample) {
    return sizeof sample + sample.payload.size();
  }

  void demand_room() const {
    if (waiting_ <= most_waiting_) return;
    throw InputError(options_.a.string() + " and " + options_.b.string() + ": more than " +
                     std::to_string(most_waiting_ >> 20) +
                     " MiB of samples are in one of them alone; leave topics out with --ignore");
  }

  void compare(const std::string& topic, const std::string& key, const RecordedSample& a,
               const RecordedSample& b) {
    TopicDifference& into = result_.topics[topic];
    ++into.compared;
    if (a.payload == b.payload) return;
    const bool valid_a = a.topic->type->decode(a.payload, message_a_) == nullptr;
    const bool valid_b = b.topic->type->decode(b.payload, message_b_) == nullptr;
    sim_time_ns_ = messages::header_of(a.payload).sim_time_ns;
    bool differs = false;
    if (valid_a && valid_b) {
      messages::list_values(message_a_, values_a_);
      messages::list_values(message_b_, values_b_);
      differs = compare_values(topic, key, into);
    } else {
      differs = true;
      note(topic, key, "payload", valid_a ? "valid" : "not valid", valid_b ? "valid" : "not valid");
      ++into.fields["payload"].samples;
    }
    into.differing += differs ? 1 : 0;
  }

  bool compare_values(const std::string& topic, const std::string& key, TopicDifference& into) {
    std::map<std::string_view, double> largest;  // of the fields that differ
    std::set<std::string_view> texts;            // of these
    const bool same_scene = is_same_scene();
    const std::size_t count = std::min(values_a_.size(), values_b_.size());
    for (std::size_t i = 0; i < count; ++i) {
      const Value &a = values_a_[i], &b = values_b_[i];
      if (a.same_as(b) || options_.ignore.contains(a.field)) continue;
      if (same_scene && (a.field == "name" || a.field == "resolved_text")) continue;
      double& most = largest[a.field];
      if (a.kind == Value::Kind::kText) texts.insert(a.field);
      if (a.field == b.field) most = std::max(most, std::abs(a.real - b.real));
      note(topic, key, messages::place_of(a), messages::text_of(a), messages::text_of(b));
      if (a.field != b.field) break;  // a longer list: what follows is shifted
    }
    for (const auto& [field, difference] : largest) {
      FieldDifference& total = into.fields[std::string(field)];
      ++total.samples;
      total.is_text = texts.contains(field);
      if (difference > total.largest || total.samples == 1) {
        total.largest = difference;
        total.largest_sim_time_ns = sim_time_ns_;
      }
      if (csv_) write_row(topic, key, field, total.is_text, difference);
    }
    return !largest.empty();
  }

  /// What a scene and its files are called is no difference, as for its digest.
  bool is_same_scene() const {
    const auto* a = std::get_if<SceneDescription>(&message_a_);
    const auto* b = std::get_if<SceneDescription>(&message_b_);
    return a != nullptr && b != nullptr && a->digest == b->digest;
  }

  void note(const std::string& topic, const std::string& key, const std::string& field,
            const std::string& a, const std::string& b) {
    if (result_.first && result_.first->sim_time_ns <= sim_time_ns_) return;
    result_.first = Difference{sim_time_ns_, topic, key, field, a, b};
  }

  void write_row(const std::string& topic, const std::string& key, std::string_view field,
                 bool is_text, double difference) {
    std::ostream& csv = csv_->stream();
    messages::write_seconds(csv, sim_time_ns_);
    csv << ',' << topic << ',' << messages::csv_text(key) << ',' << field << ',';
    if (is_text) {
      csv << "text";
    } else {
      messages::write_number(csv, difference);
    }
    csv << '\n';
  }

  const DiffOptions& options_;
  std::size_t most_waiting_;
  std::size_t waiting_ = 0;  ///< bytes of what has no partner yet
  std::optional<WholeFile> csv_;
  RecordingDifference result_;
  std::map<std::pair<std::string, std::string>, Stream> streams_;
  messages::AnyMessage message_a_, message_b_;
  std::vector<Value> values_a_, values_b_;
  std::int64_t sim_time_ns_ = 0;  // of the samples being compared
};

void check_names(const DiffOptions& options) {
  std::set<std::string_view> known = messages::field_names();
  for (const bus::TopicInfo& topic : bus::all_topics()) known.insert(topic.name);
  for (const std::string& name : options.ignore) {
    if (known.contains(name)) continue;
    throw InputError("--ignore " + name + ": neither a topic nor a field of a message");
  }
}

/// Whether it says that its clock was that of the day.
bool is_of_real_time(const std::filesystem::path& file) {
  SampleReader reader(file);
  if (!reader.next()) return false;
  const McapMap session = reader.metadata(kSessionMetadata);
  const auto clock = session.find("clock");
  return clock != session.end() && clock->second == kTimeOfDay;
}

/// Fields in which no two runs of real time agree: whose clock, how many before, and the simulated
/// time, of which is told how far pairs are apart. Topics that tell of the machine, where only one
/// of both has a clock.
std::set<std::string, std::less<>> beyond_compare(bool real_a, bool real_b) {
  std::set<std::string, std::less<>> names;
  if (real_a || real_b) names = {"source_time_ns", "sim_time_ns", "sequence_number"};
  if (real_a == real_b) return names;
  for (const bus::TopicInfo& topic : bus::all_topics()) {
    if (runtime::find_wire(topic.name) == nullptr) names.emplace(topic.name);
  }
  return names;
}

/// When the streams of a session in lockstep begin, simulated [ns]; none of one in real time.
std::optional<std::int64_t> beginning_of(const std::filesystem::path& file) {
  SampleReader reader(file);
  while (const auto sample = reader.next()) {
    if (sample->topic->delivery != bus::Delivery::kStream) continue;
    const McapMap session = reader.metadata(kSessionMetadata);
    const auto clock = session.find("clock");
    if (clock == session.end() || clock->second != kSimulated) break;
    return sample->received_time_ns;
  }
  return std::nullopt;
}

/// Since when both sessions were heard, where one began later.
std::optional<std::int64_t> common_beginning(const DiffOptions& options) {
  const auto a = beginning_of(options.a), b = beginning_of(options.b);
  return a && b && *a != *b ? std::optional(std::max(*a, *b)) : std::nullopt;
}

/// Said at `from_ns` or later; the scene, told before all, is compared in any case.
std::optional<RecordedSample> next_since(const std::optional<std::int64_t>& from_ns,
                                         SampleReader& reader) {
  auto sample = reader.next();
  while (sample && from_ns && sample->received_time_ns < *from_ns &&
         sample->topic->name != bus::kScene.name) {
    sample = reader.next();
  }
  return sample;
}

}  // namespace

bool RecordingDifference::equal() const {
  return std::ranges::all_of(topics, [](const auto& topic) {
    const TopicDifference& t = topic.second;
    return t.differing == 0 && t.only_in_a == 0 && t.only_in_b == 0;
  });
}

RecordingDifference compare(const DiffOptions& options, std::size_t most_waiting) {
  check_names(options);
  const auto from_ns = common_beginning(options);
  SampleReader a(options.a), b(options.b);
  const bool real_a = is_of_real_time(options.a), real_b = is_of_real_time(options.b);
  const std::set<std::string, std::less<>> left_out = beyond_compare(real_a, real_b);
  DiffOptions judged = options;
  judged.ignore.insert(left_out.begin(), left_out.end());
  Comparison comparison(judged, most_waiting, real_a || real_b);
  // In turns: of recordings of one session little waits for the other.
  for (bool more_a = true, more_b = true; more_a || more_b;) {
    auto sample_a = more_a ? next_since(from_ns, a) : std::nullopt;
    auto sample_b = more_b ? next_since(from_ns, b) : std::nullopt;
    more_a = sample_a.has_value();
    more_b = sample_b.has_value();
    if (more_a) comparison.add_a(std::move(*sample_a));
    if (more_b) comparison.add_b(std::move(*sample_b));
  }
  RecordingDifference difference = comparison.finish();
  difference.from_ns = from_ns;
  difference.left_out = left_out;
  for (const SampleReader* file : {&a, &b}) {
    for (std::string& line : file->warnings()) difference.warnings.push_back(std::move(line));
  }
  return difference;
}

void print_difference(const RecordingDifference& difference, std::ostream& out) {
  if (difference.from_ns) {
    out << "compared from " << seconds_from_ns(*difference.from_ns)
        << " s of the session on, where one of them begins\n\n";
  }
  if (difference.by_time) {
    out << "recorded in real time: each sample beside the one nearest in simulated time, at most "
        << seconds_from_ns(difference.farthest_ns) << " s away; not compared:";
    for (const std::string& name : difference.left_out) out << ' ' << name;
    out << "\n\n";
  }
  if (difference.first) {
    const Difference& first = *difference.first;
    out << "first difference at " << seconds_from_ns(first.sim_time_ns)
        << " s of the session: " << first.topic << (first.key.empty() ? "" : " of ") << first.key
        << ", " << first.field << ": " << first.a << " and " << first.b << "\n\n";
  }
  out << "topic             compared  differing  only in A  only in B\n";
  for (const auto& [name, topic] : difference.topics) {
    out << std::left << std::setw(16) << name << std::right << std::setw(10) << topic.compared
        << std::setw(11) << topic.differing << std::setw(11) << topic.only_in_a << std::setw(11)
        << topic.only_in_b << '\n';
    for (const auto& [field, d] : topic.fields) {
      out << "  " << field << ": " << d.samples << " samples, ";
      if (d.is_text) {
        out << "another text";
      } else {
        out << "at most " << d.largest;
      }
      out << " at " << seconds_from_ns(d.largest_sim_time_ns) << " s\n";
    }
  }
  out << (difference.equal() ? "equal\n" : "different\n");
}

}  // namespace palpate::recording
