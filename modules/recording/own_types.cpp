#include "modules/recording/own_types.h"

#include <algorithm>

#include "modules/bus/topics.h"
#include "modules/recording/foxglove_messages.h"
#include "modules/recording/idl_text.h"

namespace palpate::recording {

bool is_translation(const std::string& type) {
  return std::ranges::find(foxglove::kTypes, type) != foxglove::kTypes.end();
}

std::string why_foreign(const McapSchema& schema) {
  if (is_translation(schema.name)) return "";
  const auto topics = bus::all_topics();
  const auto known = std::ranges::find_if(
      topics, [&](const bus::TopicInfo& topic) { return topic.type->wire_name == schema.name; });
  if (known == topics.end()) {
    return "type '" + schema.name + "' is not one of Palpate's (palpate::idl::…)";
  }
  if (schema.encoding == "omgidl" && same_idl(schema.data, idl_text_of(*known->type))) return "";
  return "type '" + schema.name +
         "' differs from the present one: recorded by another version of Palpate";
}

std::string why_foreign(const McapChannel& channel, const std::string& type) {
  if (is_translation(type)) return "";
  const std::string subject = "topic '" + channel.topic + "' ";
  const bus::TopicInfo* const topic = bus::find_topic(channel.topic);
  if (topic == nullptr) return subject + "is not one of Palpate's";
  if (type != topic->type->wire_name) {
    return subject + "must be of type '" + std::string(topic->type->wire_name) + "'";
  }
  if (channel.message_encoding == "cdr") return "";
  return subject + "is encoded as '" + channel.message_encoding + "'; allowed: cdr";
}

}  // namespace palpate::recording
