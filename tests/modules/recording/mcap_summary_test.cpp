#include "modules/recording/mcap_summary.h"

#include <catch2/catch.hpp>

#include "tests/modules/recording/mcap_sample_file.h"

namespace palpate::recording {

TEST_CASE("mcap summary: has copies of all schemas and channels, and says where records begin") {
  // Oracle: what was written, and the offsets where it was.
  const ScratchFolder folder;
  const auto ends = write_sample_file(folder / "a.mcap", 6);
  const auto summary = sound_summary(folder / "a.mcap");
  REQUIRE(summary);
  const SampleContents contents;
  REQUIRE(summary->schemas.size() == 2);
  REQUIRE(summary->channels.size() == 2);
  for (const auto& schema : contents.schemas) {
    CHECK(content_of(summary->schemas.at(schema.id)) == content_of(schema));
  }
  for (const auto& channel : contents.channels) {
    CHECK(content_of(summary->channels.at(channel.id)) == content_of(channel));
  }
  CHECK(summary->chunked);
  // Metadata, two chunks, the end of the data; schemas and channels have no index.
  CHECK(summary->places == std::set<std::uint64_t>{ends[0], ends[5], ends[6], ends[7]});
}

TEST_CASE("mcap summary: one that is damaged, or missing, is none") {
  // Oracle: the footer's place by the format; any byte behind the data section is covered.
  const ScratchFolder folder;
  const auto ends = write_sample_file(folder / "a.mcap", 6);
  const auto sound = bytes_of(folder / "a.mcap");
  const std::size_t start = ends.back() + kMcapEnvelopeBytes + 4;
  for (std::size_t place = start; place < sound.size() - kMcapMagic.size(); ++place) {
    auto bytes = sound;
    bytes[place] ^= 1;
    write_bytes(folder / "b.mcap", bytes);
    INFO(place);
    CHECK_FALSE(sound_summary(folder / "b.mcap"));
  }
  for (const std::size_t length : {sound.size() - 1, start, std::size_t{40}, std::size_t{9}}) {
    write_bytes(folder / "b.mcap", {sound.begin(), sound.begin() + std::ptrdiff_t(length)});
    CHECK_FALSE(sound_summary(folder / "b.mcap"));
  }
}

}  // namespace palpate::recording
