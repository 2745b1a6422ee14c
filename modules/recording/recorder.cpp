#include "modules/recording/recorder.h"

#include <spdlog/fmt/fmt.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <utility>

#include "modules/bus/clock_ns.h"
#include "modules/core/error.h"
#include "modules/core/input_file.h"
#include "modules/recording/idl_text.h"
#include "modules/recording/sample_reader.h"
#include "modules/runtime/program.h"
#include "modules/scene/placed_files.h"

namespace palpate::recording {
namespace {

std::string hex(const bus::WriterId& id) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : id) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

/// None where the text is no scene.
std::set<std::filesystem::path> files_of(const std::string& resolved_text) {
  try {
    const auto files = scene::files_named(resolved_text);
    return {files.begin(), files.end()};
  } catch (const InputError&) {
    return {};
  }
}

}  // namespace

Clocks Clocks::now() { return {bus::monotonic_ns(), bus::clock_ns<std::chrono::system_clock>()}; }

SampleFile::SampleFile(const std::filesystem::path& file, const bus::BusOptions& session,
                       const Clocks& clocks, TopicSelection topics)
    : writer_(file),
      topics_(std::move(topics)),
      to_time_of_day_ns_(clocks.unix - clocks.monotonic) {
  writer_.add_metadata({kSessionMetadata,
                        {{"session", session.session},
                         {"domain", std::to_string(session.domain)},
                         {"protocol_version", std::to_string(kProtocolVersion)},
                         {"version", runtime::version_text()},
                         {"clock", kTimeOfDay},
                         {kSelectedTopics, topics_.text()},
                         {"start_monotonic_ns", std::to_string(clocks.monotonic)},
                         {"start_unix_ns", std::to_string(clocks.unix)}}});
  writer_.flush();
}

SampleFile::SampleFile(TopicSelection topics, const std::filesystem::path& file)
    : writer_(file), topics_(std::move(topics)) {
  writer_.add_metadata({kSessionMetadata,
                        {{"protocol_version", std::to_string(kProtocolVersion)},
                         {"version", runtime::version_text()},
                         {"clock", kSimulated},
                         {kSelectedTopics, topics_.text()}}});
  writer_.flush();
}

bool SampleFile::takes(const TopicSample& sample) {
  const std::uint64_t sequence = messages::header_of(sample.payload).sequence;
  numbers_[{sample.topic, sample.writer}].count(sequence);
  return topics_.takes(sample);
}

void SampleFile::write(const TopicSample& sample) {
  const Header header = messages::header_of(sample.payload);
  McapMessage message;
  message.channel_id = channel_of(sample);
  message.sequence = static_cast<std::uint32_t>(header.sequence);
  // Unsigned: a source time may be any number, and two of them fit.
  const auto time_of_day_ns = [&](std::int64_t session_ns) {
    return static_cast<std::uint64_t>(session_ns) + static_cast<std::uint64_t>(to_time_of_day_ns_);
  };
  message.log_time_ns = time_of_day_ns(sample.received_time_ns);
  if (header.source_time_ns > 0) message.publish_time_ns = time_of_day_ns(header.source_time_ns);
  writer_.add_message(message, sample.payload);
  if (sample.topic->name == bus::kScene.name) note_scene(sample);
}

std::uint64_t SampleFile::lost() const {
  std::uint64_t sum = lost_;
  for (const auto& [writer, numbers] : numbers_) sum += numbers.missing();
  return sum;
}

std::uint16_t SampleFile::channel_of(const TopicSample& sample) {
  const auto known = channels_.find({sample.topic, sample.writer});
  if (known != channels_.end()) return known->second;

  const bus::TopicInfo& topic = *sample.topic;
  auto schema = schemas_.find(topic.type->wire_name);
  if (schema == schemas_.end()) {
    const std::uint16_t id = writer_.add_schema(
        {0, std::string(topic.type->wire_name), "omgidl", std::string(idl_text_of(*topic.type))});
    schema = schemas_.emplace(topic.type->wire_name, id).first;
  }
  McapMap about{{"writer", hex(sample.writer)}};
  if (topics_.rate(topic.name) > 0) about[kThinned] = fmt::format("{}", topics_.rate(topic.name));
  const std::uint16_t channel =
      writer_.add_channel({0, schema->second, std::string(topic.name), "cdr", std::move(about)});
  channels_.emplace(std::pair{sample.topic, sample.writer}, channel);
  return channel;
}

void SampleFile::note_scene(const TopicSample& sample) {
  messages::AnyMessage message;
  if (sample.topic->type->decode(sample.payload, message) != nullptr)
    return;  // recorded all the same
  const auto& scene = std::get<SceneDescription>(message);
  if (scene.digest == scene_digest_) return;
  scene_digest_ = scene.digest;
  writer_.add_metadata({kSceneMetadata, {{"name", scene.name}, {"digest", scene.digest}}});
  attach_files(scene, static_cast<std::uint64_t>(sample.received_time_ns + to_time_of_day_ns_));
}

void SampleFile::add_attachment(const McapAttachment& attachment) {
  writer_.add_attachment(attachment);
  attached_.insert(attachment.name);
}

/// The scene, and the files it names where they lie on this host, too.
void SampleFile::attach_files(const SceneDescription& scene, std::uint64_t log_time_ns) {
  writer_.add_attachment({log_time_ns, "scene.yaml", "application/yaml", scene.resolved_text});
  for (const auto& file : files_of(scene.resolved_text)) {
    if (attached_.contains(file.filename().string())) continue;
    std::string bytes;
    try {
      bytes = read_input(file, kMostRecordBytes / 2);  // of more, readers refuse the record
    } catch (const std::exception&) {  // whatever is wrong with it, the recording goes on
      continue;
    }
    if (bytes.empty()) continue;
    writer_.add_attachment(
        {log_time_ns, file.filename().string(), "application/octet-stream", std::move(bytes)});
  }
}

Recorder::Recorder(bus::Bus& bus, const bus::BusOptions& session, const std::filesystem::path& file,
                   const TopicSelection& topics)
    : bus_(bus),
      reader_(bus, [&](std::string_view topic) { return topics.has(topic); }),
      file_(file, session, Clocks::now(), topics),
      space_(file),
      thread_(
          {[this](const TopicSample& sample) { file_.write(sample); }, [this] { end_round(); }}) {}

std::string Recorder::poll() {
  thread_.check();
  for (const TopicSample& sample : reader_.take_all()) {
    heard_scene_ |= sample.topic->name == bus::kScene.name;
    if (file_.takes(sample) && !thread_.add(sample)) file_.add_lost();
  }
  return news();
}

bool Recorder::hears(const std::vector<std::string>& modules) {
  if (!hearing_) hearing_.emplace(bus_, modules);
  return hearing_->complete(reader_) && heard_scene_;
}

void Recorder::end_round() {
  file_.flush();
  samples_written_ = file_.statistics().message_count;
  const std::string said = space_.look(age(), file_.bytes_written());
  full_ = space_.full();
  if (said.empty()) return;
  const std::lock_guard lock(news_mutex_);
  news_ = said;
}

std::string Recorder::news() {
  const std::lock_guard lock(news_mutex_);
  return std::exchange(news_, {});
}

McapMap Recorder::close() {
  poll();
  thread_.finish();
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& time) {
    return double(time.tv_sec) + 1e-6 * double(time.tv_usec);
  };
  file_.end_chunk();
  const double processor = seconds(used.ru_utime) + seconds(used.ru_stime);
  McapMap cost{{"wall_s", fmt::format("{:.3f}", age())},
               {"processor_s", fmt::format("{:.3f}", processor)},
               {"samples_lost", std::to_string(file_.lost())}};
  file_.add_metadata({kCostMetadata, cost});
  file_.close();
  return cost;
}

double Recorder::age() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
}

}  // namespace palpate::recording
