#include "modules/recording/mcap_writer.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <system_error>

#include "modules/core/error.h"
#include "modules/recording/mcap_bytes.h"

namespace palpate::recording {
namespace {

constexpr std::size_t kFlushBytes = 1u << 20;

std::vector<std::uint8_t> content_of(const McapSchema& schema) {
  std::vector<std::uint8_t> content;
  ByteWriter(content).u16(schema.id).text(schema.name).text(schema.encoding).text(schema.data);
  return content;
}

std::vector<std::uint8_t> content_of(const McapChannel& channel) {
  std::vector<std::uint8_t> content;
  ByteWriter(content)
      .u16(channel.id)
      .u16(channel.schema_id)
      .text(channel.topic)
      .text(channel.message_encoding)
      .text_map(channel.metadata);
  return content;
}

std::vector<std::uint8_t> content_of(const McapStatistics& statistics) {
  std::vector<std::uint8_t> content;
  ByteWriter writer(content);
  writer.u64(statistics.message_count)
      .u16(statistics.schema_count)
      .u32(statistics.channel_count)
      .u32(0)  // attachments
      .u32(statistics.metadata_count)
      .u32(0)  // chunks
      .u64(statistics.message_start_time_ns)
      .u64(statistics.message_end_time_ns)
      .u32(static_cast<std::uint32_t>(10 * statistics.channel_message_counts.size()));
  for (const auto& [channel, count] : statistics.channel_message_counts) {
    writer.u16(channel).u64(count);
  }
  return content;
}

/// A scene, or a mesh it names, given as the recording by mistake.
void refuse_to_replace_what_is_no_recording(const std::filesystem::path& file) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) return;
  std::array<std::uint8_t, kMcapMagic.size()> first{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(reinterpret_cast<char*>(first.data()), first.size());
  const auto count = static_cast<std::size_t>(stream.gcount());
  if (count == 0 || std::equal(first.begin(), first.end(), kMcapMagic.begin())) return;
  throw InputError(file.string() + ": is no recording, and is not replaced by one");
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& file) : file_(file) {
  refuse_to_replace_what_is_no_recording(file);
  descriptor_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor_ < 0) fail("open", errno);
  append(kMcapMagic);
  std::vector<std::uint8_t> content;
  ByteWriter(content).text("").text("palpate");  // no profile: topics are documented by schemas
  append_record(McapOpcode::kHeader, content);
  flush();
}

McapWriter::~McapWriter() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::uint16_t McapWriter::add_schema(McapSchema schema) {
  PALPATE_DEMAND(schemas_.size() < 0xFFFF);
  schema.id = static_cast<std::uint16_t>(schemas_.size() + 1);
  append_record(McapOpcode::kSchema, content_of(schema));
  schemas_.push_back(std::move(schema));
  statistics_.schema_count = static_cast<std::uint16_t>(schemas_.size());
  return schemas_.back().id;
}

std::uint16_t McapWriter::add_channel(McapChannel channel) {
  PALPATE_DEMAND(channel.schema_id <= schemas_.size() && channels_.size() < 0xFFFF);
  channel.id = static_cast<std::uint16_t>(channels_.size() + 1);
  append_record(McapOpcode::kChannel, content_of(channel));
  channels_.push_back(std::move(channel));
  statistics_.channel_count = static_cast<std::uint32_t>(channels_.size());
  return channels_.back().id;
}

void McapWriter::add_message(const McapMessage& message, std::span<const std::uint8_t> data) {
  PALPATE_DEMAND(message.channel_id >= 1 && message.channel_id <= channels_.size());
  scratch_.clear();
  ByteWriter(scratch_)
      .u16(message.channel_id)
      .u32(message.sequence)
      .u64(message.log_time_ns)
      .u64(message.publish_time_ns)
      .raw(data);
  append_record(McapOpcode::kMessage, scratch_);

  McapStatistics& s = statistics_;
  const bool first = s.message_count == 0;
  s.message_start_time_ns =
      first ? message.log_time_ns : std::min(s.message_start_time_ns, message.log_time_ns);
  s.message_end_time_ns = std::max(s.message_end_time_ns, message.log_time_ns);
  ++s.message_count;
  ++s.channel_message_counts[message.channel_id];
}

void McapWriter::add_metadata(const McapMetadata& metadata) {
  const std::uint64_t offset = offset_;
  std::vector<std::uint8_t> content;
  ByteWriter(content).text(metadata.name).text_map(metadata.entries);
  append_record(McapOpcode::kMetadata, content);
  metadata_places_.push_back({offset, offset_ - offset, metadata.name});
  ++statistics_.metadata_count;
}

void McapWriter::append(std::span<const std::uint8_t> bytes) {
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  offset_ += bytes.size();
}

void McapWriter::append_record(McapOpcode opcode, std::span<const std::uint8_t> content) {
  PALPATE_DEMAND(descriptor_ >= 0);
  ByteWriter(pending_).u8(static_cast<std::uint8_t>(opcode)).u64(content.size());
  offset_ += kMcapEnvelopeBytes;
  append(content);
  if (pending_.size() >= kFlushBytes) flush();
}

void McapWriter::flush() {
  std::size_t done = 0;
  while (done < pending_.size()) {
    const ssize_t written = ::write(descriptor_, pending_.data() + done, pending_.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int reason = errno;
      pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(done));
      fail("write", reason);
    }
    done += static_cast<std::size_t>(written);
  }
  pending_.clear();
}

void McapWriter::close() {
  if (descriptor_ < 0) return;
  std::vector<std::uint8_t> content;
  ByteWriter(content).u32(0);  // CRC of the data section: not given, it would cost every sample
  append_record(McapOpcode::kDataEnd, content);
  flush();
  append_summary();
  append(kMcapMagic);
  flush();
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0) fail("close", errno);
}

// Schemas, channels, statistics and metadata index each as one group, then one offset per group.
// pending_ holds exactly the summary when its CRC is taken.
void McapWriter::append_summary() {
  struct Group {
    McapOpcode opcode;
    std::vector<std::vector<std::uint8_t>> contents;
  };
  std::vector<Group> groups{{McapOpcode::kSchema, {}},
                            {McapOpcode::kChannel, {}},
                            {McapOpcode::kStatistics, {content_of(statistics_)}},
                            {McapOpcode::kMetadataIndex, {}}};
  for (const McapSchema& schema : schemas_) groups[0].contents.push_back(content_of(schema));
  for (const McapChannel& channel : channels_) groups[1].contents.push_back(content_of(channel));
  for (const MetadataPlace& place : metadata_places_) {
    ByteWriter(groups[3].contents.emplace_back())
        .u64(place.offset)
        .u64(place.length)
        .text(place.name);
  }

  std::vector<std::uint8_t> summary;
  std::vector<std::uint8_t> offsets;
  const auto append_to = [](std::vector<std::uint8_t>& bytes, McapOpcode opcode,
                            const std::vector<std::uint8_t>& content) {
    ByteWriter(bytes).u8(static_cast<std::uint8_t>(opcode)).u64(content.size()).raw(content);
  };
  const std::uint64_t summary_start = offset_;
  for (const Group& group : groups) {
    if (group.contents.empty()) continue;
    const std::uint64_t start = summary.size();
    for (const auto& content : group.contents) append_to(summary, group.opcode, content);
    std::vector<std::uint8_t> content;
    ByteWriter(content)
        .u8(static_cast<std::uint8_t>(group.opcode))
        .u64(summary_start + start)
        .u64(summary.size() - start);
    append_to(offsets, McapOpcode::kSummaryOffset, content);
  }
  const std::uint64_t summary_offset_start = summary_start + summary.size();
  ByteWriter(summary).raw(offsets);
  // The CRC covers the summary and the footer up to the CRC itself.
  ByteWriter(summary)
      .u8(static_cast<std::uint8_t>(McapOpcode::kFooter))
      .u64(20)
      .u64(summary_start)
      .u64(summary_offset_start);
  ByteWriter(summary).u32(crc32(summary));
  append(summary);
}

void McapWriter::fail(const char* doing, int system_error) const {
  throw std::runtime_error(file_.string() + ": cannot " + doing + ": " +
                           std::generic_category().message(system_error));
}

}  // namespace palpate::recording
