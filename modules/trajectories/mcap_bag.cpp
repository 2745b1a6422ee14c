#include "modules/trajectories/mcap_bag.h"

#include <spdlog/fmt/fmt.h>

#include <map>

#include "modules/core/error.h"
#include "modules/recording/mcap_reader.h"
#include "modules/trajectories/pose_topics.h"

namespace palpate::trajectories {
namespace {

struct Channel {
  std::string topic, type, encoding;
};

RosEncoding encoding_of(const std::filesystem::path& file, const Channel& channel) {
  if (channel.encoding == "cdr") return RosEncoding::kCdr;
  if (channel.encoding == "ros1") return RosEncoding::kRos1;
  throw InputError(fmt::format("{}: topic '{}' is encoded as {}; allowed are cdr and ros1",
                               file.string(), channel.topic, channel.encoding));
}

/// All that are announced. @param torn  set where the file has no regular end
std::map<std::uint16_t, Channel> channels_of(const std::filesystem::path& file, bool& torn) {
  recording::McapReader reader(file);
  std::map<std::uint16_t, std::string> types;
  std::map<std::uint16_t, Channel> channels;
  while (const auto record = reader.next()) {
    if (const auto* schema = std::get_if<recording::McapSchema>(&*record)) {
      types[schema->id] = schema->name;
    } else if (const auto* channel = std::get_if<recording::McapChannel>(&*record)) {
      channels[channel->id] = {channel->topic, types[channel->schema_id],
                               channel->message_encoding};
    }
  }
  torn = reader.torn();
  return channels;
}

}  // namespace

std::vector<TimedPose> read_mcap_bag(const scene::TrajectoryDevice& config,
                                     std::vector<std::string>& warnings, const Progress& progress) {
  bool torn = false;
  const auto channels = channels_of(config.file, torn);
  if (torn) warnings.push_back(config.file.string() + ": has no end; what is before it is used");
  PoseTopics topics;
  for (const auto& [id, channel] : channels) topics.add(channel.topic, channel.type);
  const PoseTopic topic = topics.choose(config);
  std::optional<RosEncoding> encoding;
  for (const auto& [id, channel] : channels) {
    if (channel.topic == topic.name) encoding = encoding_of(config.file, channel);
  }
  StampedPoses poses(config, topic, *encoding, warnings);
  recording::McapReader reader(config.file);
  while (const auto record = reader.next()) {
    const auto* message = std::get_if<recording::McapMessage>(&*record);
    if (message == nullptr || channels.at(message->channel_id).topic != topic.name) continue;
    poses.add(message->data);
    if (progress && poses.count() % kProgressEvery == 0) {
      progress(double(reader.offset()) / double(reader.file_bytes()), poses.count());
    }
  }
  return std::move(poses).finish();
}

}  // namespace palpate::trajectories
