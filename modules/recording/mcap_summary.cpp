#include "modules/recording/mcap_summary.h"

#include <span>
#include <vector>

#include "modules/core/crc32.h"
#include "modules/core/input_file.h"
#include "modules/recording/mcap_bytes.h"
#include "modules/recording/mcap_codec.h"

namespace palpate::recording {
namespace {

constexpr std::uint64_t kDataEndBytes = kMcapEnvelopeBytes + sizeof(std::uint32_t);
constexpr std::uint64_t kEndBytes = kMcapEnvelopeBytes + kFooterBytes + kMcapMagic.size();

using Bytes = std::vector<std::uint8_t>;

/// From `offset` to the end; empty where it cannot be read.
Bytes tail_of(std::ifstream& stream, std::uint64_t offset, std::uint64_t file_bytes) {
  if (offset > file_bytes || file_bytes - offset > kMostRecordBytes) return {};
  Bytes bytes(file_bytes - offset);
  stream.seekg(static_cast<std::streamoff>(offset));
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return stream ? bytes : Bytes{};
}

void add(McapSummary& summary, McapOpcode opcode, std::span<const std::uint8_t> content) {
  switch (opcode) {
    case McapOpcode::kSchema: {
      McapSchema schema = parse_schema(content);
      summary.schemas[schema.id] = std::move(schema);
      return;
    }
    case McapOpcode::kChannel: {
      McapChannel channel = parse_channel(content);
      summary.channels[channel.id] = std::move(channel);
      return;
    }
    case McapOpcode::kChunkIndex:
      summary.places.insert(parse_chunk_index(content).offset);
      summary.chunked = true;
      return;
    case McapOpcode::kAttachmentIndex:
    case McapOpcode::kMetadataIndex:
      summary.places.insert(ByteReader(content).u64());
      return;
    default:
      return;
  }
}

/// Where the summary begins, as the footer says; none if there is no footer.
std::optional<std::uint64_t> start_of_summary(const Bytes& end) {
  if (end.size() != kEndBytes) return std::nullopt;
  ByteReader footer(end);
  const bool is_footer =
      footer.u8() == static_cast<std::uint8_t>(McapOpcode::kFooter) && footer.u64() == kFooterBytes;
  const std::uint64_t start = footer.u64();
  if (!is_footer || start == 0) return std::nullopt;
  return start;
}

bool is_sound(std::span<const std::uint8_t> summary) {
  const std::size_t covered = summary.size() - kMcapMagic.size() - sizeof(std::uint32_t);
  const std::uint32_t stated = ByteReader(summary.subspan(covered)).u32();
  return stated != 0 && stated == crc32(summary.first(covered));
}

}  // namespace

std::optional<McapSummary> sound_summary(const std::filesystem::path& file) {
  std::ifstream stream = open_input(file);
  const std::uint64_t file_bytes = std::filesystem::file_size(file);
  if (file_bytes < kEndBytes) return std::nullopt;
  const auto start = start_of_summary(tail_of(stream, file_bytes - kEndBytes, file_bytes));
  if (!start) return std::nullopt;
  const Bytes bytes = tail_of(stream, *start, file_bytes);
  if (bytes.size() < kEndBytes || !is_sound(bytes)) return std::nullopt;
  McapSummary summary;
  if (*start > kDataEndBytes) summary.places.insert(*start - kDataEndBytes);
  try {
    ByteReader records(std::span<const std::uint8_t>(bytes).first(bytes.size() - kEndBytes));
    while (!records.rest().empty()) {
      const auto opcode = static_cast<McapOpcode>(records.u8());
      add(summary, opcode, records.take(records.u64()));
    }
  } catch (const McapFieldError&) {
    return std::nullopt;
  }
  return summary;
}

}  // namespace palpate::recording
