#include "modules/recording/sample_reader.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "modules/core/error.h"
#include "modules/core/text.h"
#include "modules/recording/mcap_bytes.h"
#include "modules/recording/own_types.h"
#include "modules/recording/recorder.h"

namespace palpate::recording {
std::filesystem::path part_of(const std::filesystem::path& recording, int number) {
  if (number <= 1) return recording;
  auto part = recording;
  part.replace_filename(recording.stem().string() + ".part" + std::to_string(number) +
                        recording.extension().string());
  return part;
}

std::optional<int> part_after(const std::filesystem::path& recording, int number) {
  const std::string begin = recording.stem().string() + ".part";
  std::optional<int> next;
  std::error_code error;
  const auto folder = std::filesystem::absolute(recording).parent_path();
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    int found = 0;
    if (!name.starts_with(begin)) continue;
    std::from_chars(name.data() + begin.size(), name.data() + name.size(), found);
    if (found <= number || part_of(recording, found).filename() != name) continue;
    next = std::min(next.value_or(found), found);
  }
  return next;
}

bool goes_on(const McapMap& before, const McapMap& later) {
  const auto entry = [](const McapMap& about, const char* key) {
    const auto found = about.find(key);
    return found == about.end() ? std::string() : found->second;
  };
  const std::string first = entry(before, "start_unix_ns"), second = entry(later, "start_unix_ns");
  return entry(before, "session") == entry(later, "session") && !first.empty() &&
         std::pair(first.size(), first) <= std::pair(second.size(), second);
}

SampleReader::SampleReader(const std::filesystem::path& file) : SampleReader(file, 1) {}

SampleReader::SampleReader(const std::filesystem::path& recording, int part)
    : recording_(recording), part_(part), file_(part_of(recording, part)), reader_(file_) {}

std::optional<RecordedSample> SampleReader::next() {
  if (later_) return later_->next();
  std::optional<RecordedSample> sample = std::exchange(first_, std::nullopt);
  if (!sample) sample = next_of_part();
  if (sample) return sample;
  look_for_next_part();
  return later_ ? later_->next() : std::nullopt;
}

void SampleReader::look_for_next_part() {
  if (std::exchange(looked_for_later_, true)) return;
  for (auto number = part_after(recording_, part_); number;
       number = part_after(recording_, *number)) {
    try {
      later_ = part_that_goes_on(*number);
      return;
    } catch (const InputError& unreadable) {
      left_out_.push_back(std::string(unreadable.what()) + "; this part is left out");
    }
  }
}

std::unique_ptr<SampleReader> SampleReader::part_that_goes_on(int number) {
  std::unique_ptr<SampleReader> part(new SampleReader(recording_, number));
  part->first_channel_ = first_channel_ + channel_count_;
  part->first_ = part->next_of_part();
  const bool taken = goes_on(metadata(kSessionMetadata), part->metadata(kSessionMetadata));
  return taken ? std::move(part) : nullptr;
}

std::uint64_t SampleReader::file_bytes() const {
  return reader_.file_bytes() + (later_ ? later_->file_bytes() : 0);
}

std::optional<RecordedSample> SampleReader::next_of_part() {
  while (auto record = reader_.next()) {
    if (auto* message = std::get_if<McapMessage>(&*record)) {
      const auto topic = topics_.find(message->channel_id);
      if (topic == topics_.end()) continue;  // a translation
      return RecordedSample{topic->second,
                            first_channel_ + message->channel_id,
                            about_.at(message->channel_id).contains(kThinned),
                            session_ns(message->log_time_ns),
                            message->log_time_ns,
                            message->publish_time_ns,
                            std::move(message->data)};
    }
    if (const auto* schema = std::get_if<McapSchema>(&*record)) {
      add(*schema);
    } else if (const auto* channel = std::get_if<McapChannel>(&*record)) {
      add(*channel);
    } else if (const auto* metadata = std::get_if<McapMetadata>(&*record)) {
      if (metadata->name == kSessionMetadata) {  // of repaired parts there are several
        read_clocks(metadata->entries);
        const auto topics = metadata->entries.find(kSelectedTopics);
        selections_.push_back(topics == metadata->entries.end() ? "" : topics->second);
        metadata_.emplace(metadata->name, metadata->entries);
      } else {
        metadata_[metadata->name] = metadata->entries;
      }
    }
  }
  return std::nullopt;
}

/// Unsigned: a file may say any number of each.
std::int64_t SampleReader::session_ns(std::uint64_t time_of_day_ns) const {
  return static_cast<std::int64_t>(time_of_day_ns - static_cast<std::uint64_t>(to_time_of_day_ns_));
}

void SampleReader::read_clocks(const McapMap& session) {
  const auto number = [&](const char* key) {
    const auto entry = session.find(key);
    std::int64_t value = 0;
    if (entry == session.end()) return value;
    const char* end = entry->second.data() + entry->second.size();
    if (std::from_chars(entry->second.data(), end, value).ptr != end || value < 0) {
      refuse(std::string(key) + " '" + entry->second + "' is no time in ns");
    }
    return value;
  };
  const auto clock = session.find("clock");
  if (clock == session.end() || clock->second != kTimeOfDay) return;
  to_time_of_day_ns_ = number("start_unix_ns") - number("start_monotonic_ns");
}

void SampleReader::add(const McapSchema& schema) {
  if (const std::string why = why_foreign(schema); !why.empty()) refuse(why);
  schema_names_[schema.id] = schema.name;
}

void SampleReader::add(const McapChannel& channel) {
  const auto schema = schema_names_.find(channel.schema_id);
  const std::string type = schema == schema_names_.end() ? "" : schema->second;
  if (const std::string why = why_foreign(channel, type); !why.empty()) refuse(why);
  if (is_translation(type)) return;
  topics_[channel.id] = bus::find_topic(channel.topic);
  about_[channel.id] = channel.metadata;
  channel_count_ = std::max(channel_count_, channel.id + std::uint32_t{1});
}

const McapMap& SampleReader::about_channel(std::uint32_t channel) const {
  if (later_ && channel >= later_->first_channel_) return later_->about_channel(channel);
  return about_.at(static_cast<std::uint16_t>(channel - first_channel_));
}

McapMap SampleReader::metadata(const std::string& name) const {
  const auto found = metadata_.find(name);
  return found == metadata_.end() ? McapMap{} : found->second;
}

bool SampleReader::selected(const std::string& topic) const {
  const auto has_it = [&](const std::string& selection) {
    const std::string entries = "," + selection + ",";
    return selection == "all" || entries.find("," + topic + ",") != std::string::npos ||
           entries.find("," + topic + "=") != std::string::npos;
  };
  return !selections_.empty() && std::ranges::all_of(selections_, has_it) &&
         (!later_ || later_->selected(topic));
}

std::vector<std::string> SampleReader::warnings() const {
  std::vector<std::string> lines;
  if (reader_.torn()) {
    lines.push_back(file_.string() + ": not closed by its writer; whole up to byte " +
                    std::to_string(reader_.offset()) + " of " +
                    std::to_string(reader_.file_bytes()));
  }
  lines.insert(lines.end(), left_out_.begin(), left_out_.end());
  if (!later_) return lines;
  for (std::string& line : later_->warnings()) lines.push_back(std::move(line));
  return lines;
}

void SampleReader::refuse(const std::string& what) const {
  throw InputError(file_.string() + ": offset " + std::to_string(reader_.record_offset()) + ": " +
                   printable(what));
}

}  // namespace palpate::recording
