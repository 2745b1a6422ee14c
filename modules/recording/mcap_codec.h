// The content of each kind of MCAP record, behind its opcode and length: written and read back.
// Chunks are mcap_chunk.h's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "modules/recording/mcap_records.h"

namespace palpate::recording {

using McapContent = std::vector<std::uint8_t>;

McapContent content_of(const McapHeader& header);
McapContent content_of(const McapSchema& schema);
McapContent content_of(const McapChannel& channel);
McapContent content_of(const McapMetadata& metadata);
McapContent content_of(const McapAttachment& attachment);  ///< its CRC last
McapContent content_of(const McapChunkIndex& index);
McapContent content_of(const McapStatistics& statistics);

/// Appends a record: opcode, length, content.
void append_record(std::vector<std::uint8_t>& bytes, McapOpcode opcode,
                   std::span<const std::uint8_t> content);
/// Appends the record of a message; all but its payload is taken from `message`.
void append_message(std::vector<std::uint8_t>& bytes, const McapMessage& message,
                    std::span<const std::uint8_t> data);

/// @throws McapFieldError where the content is not of its kind, or damaged
McapHeader parse_header(std::span<const std::uint8_t> content);
McapSchema parse_schema(std::span<const std::uint8_t> content);
McapChannel parse_channel(std::span<const std::uint8_t> content);
McapMessage parse_message(std::span<const std::uint8_t> content);
McapMetadata parse_metadata(std::span<const std::uint8_t> content);
McapAttachment parse_attachment(std::span<const std::uint8_t> content);
McapChunkIndex parse_chunk_index(std::span<const std::uint8_t> content);
McapStatistics parse_statistics(std::span<const std::uint8_t> content);

}  // namespace palpate::recording
