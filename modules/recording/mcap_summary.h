// The summary at a file's end, read without what is before it: it has a CRC of its own, and copies
// of what a damaged data section may have lost.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "modules/recording/mcap_records.h"

namespace palpate::recording {

struct McapSummary {
  std::map<std::uint16_t, McapSchema> schemas;
  std::map<std::uint16_t, McapChannel> channels;
  /// Where chunks, attachments, metadata, and the end of the data section (DataEnd) begin.
  std::set<std::uint64_t> places;
  bool chunked = false;  ///< then no message lies beside chunks
};

/// None where the file has no summary, as a torn one, or one whose CRC is missing or wrong.
/// @throws InputError if the file cannot be read
std::optional<McapSummary> sound_summary(const std::filesystem::path& file);

}  // namespace palpate::recording
