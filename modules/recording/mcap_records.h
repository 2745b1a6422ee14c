// The records of the MCAP container (https://mcap.dev/spec) that recordings use.
//
// File:    magic, records …, magic.  Record: opcode u8, length of the content u64, content.
// Numbers are little-endian; a string is a u32 length and UTF-8 bytes; a map is a u32 length in
// bytes and its entries.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace palpate::recording {

inline constexpr std::array<unsigned char, 8> kMcapMagic{0x89, 'M',  'C',  'A',
                                                         'P',  0x30, '\r', '\n'};
inline constexpr std::size_t kMcapEnvelopeBytes = 9;  ///< opcode and length before each content
inline constexpr std::size_t kFooterBytes = 20;       ///< content of the footer; its last 4: a CRC

enum class McapOpcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

/// A longer record that would have to be in memory is refused; no mesh or chunk comes near it.
inline constexpr std::uint64_t kMostRecordBytes = 256u << 20;
/// Of a schema; ours have some thousands.
inline constexpr std::uint64_t kMostSchemaBytes = 1u << 20;

using McapMap = std::map<std::string, std::string>;

struct McapHeader {
  std::string profile;
  std::string library;
};

struct McapSchema {
  std::uint16_t id = 0;  ///< 1 …
  std::string name;      ///< "palpate::idl::ProbeState"
  std::string encoding;  ///< "omgidl"
  std::string data;      ///< the IDL text
};

struct McapChannel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;
  std::string topic;
  std::string message_encoding;  ///< "cdr"
  McapMap metadata;
};

struct McapMessage {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0;      ///< when it was received
  std::uint64_t publish_time_ns = 0;  ///< when its writer made it
  std::vector<std::uint8_t> data;
};

struct McapMetadata {
  std::string name;
  McapMap entries;
};

/// A file that lies in the recording: a scene, a mesh.
struct McapAttachment {
  std::uint64_t log_time_ns = 0;
  std::string name;        ///< "scene.yaml"
  std::string media_type;  ///< "application/yaml"
  std::string data;
};

/// Where a chunk and the indexes of its messages lie; a record of the summary.
struct McapChunkIndex {
  std::uint64_t message_start_time_ns = 0;
  std::uint64_t message_end_time_ns = 0;
  std::uint64_t offset = 0;                                      ///< of the chunk's record
  std::uint64_t length = 0;                                      ///< of that record
  std::map<std::uint16_t, std::uint64_t> message_index_offsets;  ///< by channel
  std::uint64_t message_index_length = 0;                        ///< of all of them
  std::string compression;
  std::uint64_t compressed_size = 0;
  std::uint64_t uncompressed_size = 0;
};

struct McapStatistics {
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0;
  std::uint32_t attachment_count = 0;
  std::uint32_t metadata_count = 0;
  std::uint32_t chunk_count = 0;
  std::uint64_t message_start_time_ns = 0;  ///< smallest log time, 0 without messages
  std::uint64_t message_end_time_ns = 0;    ///< largest log time, 0 without messages
  std::map<std::uint16_t, std::uint64_t> channel_message_counts;
};

}  // namespace palpate::recording
