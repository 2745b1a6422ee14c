#include "modules/recording/sample_reader.h"

#include <algorithm>

#include "modules/core/error.h"
#include "modules/recording/idl_text.h"

namespace palpate::recording {

SampleReader::SampleReader(const std::filesystem::path& file) : file_(file), reader_(file) {}

std::optional<RecordedSample> SampleReader::next() {
  while (auto record = reader_.next()) {
    if (auto* message = std::get_if<McapMessage>(&*record)) {
      return RecordedSample{topics_.at(message->channel_id), message->channel_id,
                            static_cast<std::int64_t>(message->log_time_ns),
                            std::move(message->data)};
    }
    if (const auto* schema = std::get_if<McapSchema>(&*record)) {
      check(*schema);
      schema_names_[schema->id] = schema->name;
    } else if (const auto* channel = std::get_if<McapChannel>(&*record)) {
      add(*channel);
    } else {
      const auto& metadata = std::get<McapMetadata>(*record);
      metadata_[metadata.name] = metadata.entries;
    }
  }
  return std::nullopt;
}

void SampleReader::check(const McapSchema& schema) const {
  const auto topics = bus::all_topics();
  const auto known = std::find_if(topics.begin(), topics.end(), [&](const bus::TopicInfo& topic) {
    return topic.type->wire_name == schema.name;
  });
  if (known == topics.end()) {
    refuse("type '" + schema.name + "' is not one of Palpate's (palpate::idl::…)");
  }
  if (schema.encoding != "omgidl" || !same_idl(schema.data, idl_text_of(*known->type))) {
    refuse("type '" + schema.name +
           "' differs from the present one: recorded by another version of Palpate");
  }
}

void SampleReader::add(const McapChannel& channel) {
  const bus::TopicInfo* topic = bus::find_topic(channel.topic);
  if (topic == nullptr) refuse("topic '" + channel.topic + "' is not one of Palpate's");
  const auto schema = schema_names_.find(channel.schema_id);
  if (schema == schema_names_.end() || schema->second != topic->type->wire_name) {
    refuse("topic '" + channel.topic + "' must be of type '" + std::string(topic->type->wire_name) +
           "'");
  }
  if (channel.message_encoding != "cdr") {
    refuse("topic '" + channel.topic + "' is encoded as '" + channel.message_encoding +
           "'; allowed: cdr");
  }
  topics_[channel.id] = topic;
}

McapMap SampleReader::metadata(const std::string& name) const {
  const auto found = metadata_.find(name);
  return found == metadata_.end() ? McapMap{} : found->second;
}

std::string SampleReader::torn_warning() const {
  return file_.string() + ": not closed by its writer; whole up to byte " +
         std::to_string(reader_.offset()) + " of " + std::to_string(reader_.file_bytes());
}

void SampleReader::refuse(const std::string& what) const {
  throw InputError(file_.string() + ": offset " + std::to_string(reader_.record_offset()) + ": " +
                   what);
}

}  // namespace palpate::recording
