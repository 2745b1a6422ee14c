#include "modules/recording/recorder.h"

#include <algorithm>
#include <chrono>

#include "modules/recording/idl_text.h"

namespace palpate::recording {
namespace {

template <class Clock>
std::string now_ns_text() {
  return std::to_string(std::chrono::nanoseconds(Clock::now().time_since_epoch()).count());
}

std::string hex(const bus::WriterId& id) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : id) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

}  // namespace

SampleFile::SampleFile(const std::filesystem::path& file, const bus::BusOptions& session)
    : writer_(file) {
  // Times in the file are of the monotonic clock; these two tell what time of day that was.
  writer_.add_metadata({kSessionMetadata,
                        {{"session", session.session},
                         {"domain", std::to_string(session.domain)},
                         {"protocol_version", std::to_string(kProtocolVersion)},
                         {"start_monotonic_ns", now_ns_text<std::chrono::steady_clock>()},
                         {"start_unix_ns", now_ns_text<std::chrono::system_clock>()}}});
  writer_.flush();
}

SampleFile::SampleFile(const std::filesystem::path& file) : writer_(file) {
  writer_.add_metadata(
      {kSessionMetadata,
       {{"protocol_version", std::to_string(kProtocolVersion)}, {"clock", "simulated"}}});
  writer_.flush();
}

void SampleFile::add(const TopicSample& sample) {
  const Header header = messages::header_of(sample.payload);
  McapMessage message;
  message.channel_id = channel_of(sample);
  message.sequence = static_cast<std::uint32_t>(header.sequence);
  message.log_time_ns = static_cast<std::uint64_t>(sample.received_time_ns);
  message.publish_time_ns =
      static_cast<std::uint64_t>(std::max<std::int64_t>(0, header.source_time_ns));
  writer_.add_message(message, sample.payload);
  if (sample.topic->name == bus::kScene.name) note_scene(sample);
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
  const std::uint16_t channel = writer_.add_channel(
      {0, schema->second, std::string(topic.name), "cdr", {{"writer", hex(sample.writer)}}});
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
}

Recorder::Recorder(bus::Bus& bus, const bus::BusOptions& session, const std::filesystem::path& file)
    : reader_(bus), file_(file, session) {}

void Recorder::poll() {
  for (const TopicSample& sample : reader_.take_all()) file_.add(sample);
  file_.flush();
}

void Recorder::close() {
  poll();
  file_.close();
}

}  // namespace palpate::recording
