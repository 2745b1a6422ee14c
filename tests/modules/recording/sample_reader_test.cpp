#include "modules/recording/sample_reader.h"

#include <catch2/catch.hpp>
#include <set>

#include "modules/core/error.h"
#include "modules/recording/idl_text.h"
#include "modules/recording/mcap_bytes.h"
#include "modules/recording/repair.h"
#include "tests/modules/recording/payloads.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {
namespace {

// What reading the whole file says.
std::string message_of(const std::filesystem::path& file) {
  try {
    SampleReader reader(file);
    while (reader.next()) {
    }
    return "no error";
  } catch (const InputError& error) {
    return error.what();
  }
}

// A file with one schema and one channel.
std::string message_of(const std::filesystem::path& file, const McapSchema& schema,
                       const std::string& topic, const std::string& encoding = "cdr") {
  McapWriter writer(file);
  const auto id = writer.add_schema(schema);
  writer.add_channel({0, id, topic, encoding, {}});
  writer.close();
  return message_of(file);
}

McapSchema probe_schema() {
  const bus::TopicInfo& topic = *bus::find_topic("probe_state");
  return {0, std::string(topic.type->wire_name), "omgidl", std::string(idl_text_of(*topic.type))};
}

}  // namespace

TEST_CASE("sample reader: goes on in the parts of a recorder that was started again") {
  // Oracle: what was written, in order. A part that an older recording of that name left is none.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  const auto sample_at = [](std::int64_t time, int writer) {
    return raw_sample(bus::kProbeState, probe_state(1, 0, 1, {4, 5, 6}), time, writer);
  };
  const auto write = [&](int part, std::int64_t time) {
    SampleFile writer(part_of(file, part), {});
    writer.add(sample_at(time, 1));
    writer.add(sample_at(time + 1, 2));
    writer.close();
  };
  CHECK(part_of(file, 1) == file);
  CHECK(part_of(file, 3) == folder / "a.part3.mcap");
  write(3, 50);
  write(1, 100);
  write(2, 200);
  SampleReader reader(file);
  std::vector<std::int64_t> times;
  std::vector<int> channels;
  while (auto sample = reader.next()) {
    times.push_back(sample->received_time_ns);
    channels.push_back(sample->channel);
  }
  CHECK(times == std::vector<std::int64_t>{100, 101, 200, 201});
  CHECK(std::set<int>(channels.begin(), channels.end()).size() == 4);  // each has its own writers
  CHECK(reader.parts() == 2);
  CHECK(reader.file_bytes() ==
        std::filesystem::file_size(file) + std::filesystem::file_size(part_of(file, 2)));
  CHECK_FALSE(reader.torn());
}

TEST_CASE(
    "sample reader: a part with all the channels that a file can have is told from the next") {
  // Oracle: the writer that each part's channels name. Numbers of 16 bits began anew behind it.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  const auto write = [&](int part, int channels) {
    McapWriter writer(part_of(file, part));
    writer.add_metadata({kSessionMetadata, {{"start_unix_ns", std::to_string(part)}}});
    const std::uint16_t schema = writer.add_schema(probe_schema());
    McapMessage message;
    for (int k = 0; k < channels; ++k) {
      message.channel_id =
          writer.add_channel({0, schema, "probe_state", "cdr", {{"writer", std::to_string(part)}}});
    }
    writer.add_message(message, cdr_of(probe_state(1, 0, 1, {4, 5, 6})));
    writer.close();
  };
  write(1, 0xFFFF);
  write(2, 1);
  SampleReader reader(file);
  std::vector<std::uint32_t> channels;
  while (auto sample = reader.next()) channels.push_back(sample->channel);
  REQUIRE(channels.size() == 2);
  CHECK(reader.about_channel(channels[0]).at("writer") == "1");
  CHECK(reader.about_channel(channels[1]).at("writer") == "2");
}

TEST_CASE("sample reader: a topic was selected if each part says so") {
  // Oracle: the selections given; thinned is selected. A recording that does not say has none.
  const ScratchFolder folder;
  const auto selected = [&](const std::vector<std::string>& first,
                            const std::vector<std::string>& second, const std::string& topic) {
    const auto file = folder / "a.mcap";
    int part = 0;
    for (const auto& words : {first, second}) {
      SampleFile writer(part_of(file, ++part), {}, {0, 100 * part}, TopicSelection(words));
      writer.add(raw_sample(bus::kProbeState, probe_state(1, 0, 1, {4, 5, 6}), 50));
      writer.close();
    }
    SampleReader reader(file);
    while (reader.next()) {
    }
    CHECK(reader.parts() == 2);
    return reader.selected(topic);
  };
  const std::vector<std::string> states{"probe_state"}, both{"probe_state", "contacts=25"};
  CHECK(selected({}, {}, "probe_input"));
  CHECK(selected(both, both, "contacts"));
  CHECK(selected(both, both, "scene"));
  CHECK_FALSE(selected(both, both, "probe_input"));
  CHECK_FALSE(selected(both, states, "contacts"));
  CHECK_FALSE(selected(states, {}, "contacts"));
  CHECK_FALSE(selected(both, both, "contact"));

  const auto old = folder / "old.mcap";
  McapWriter writer(old);
  writer.add_metadata({kSessionMetadata, {{"session", "bench"}}});
  writer.close();
  SampleReader reader(old);
  CHECK_FALSE(reader.next());
  CHECK_FALSE(reader.selected("scene"));
}

TEST_CASE("sample reader: numbers of parts may be missing, and are read in their order") {
  // Oracle: what was written; names that are no part's are passed over.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  for (const int part : {1, 4, 10}) {
    SampleFile writer(part_of(file, part), {});
    writer.add(raw_sample(bus::kProbeState, probe_state(1, 0, 1, {4, 5, 6}), part, 1));
    writer.close();
  }
  for (const char* name : {"a.part2.txt", "a.part03.mcap", "a.partx.mcap", "ab.part2.mcap"})
    write_bytes(folder / name, {});
  CHECK(part_after(file, 1) == 4);
  CHECK(part_after(file, 4) == 10);
  CHECK_FALSE(part_after(file, 10).has_value());
  SampleReader reader(file);
  std::vector<std::int64_t> times;
  while (auto sample = reader.next()) times.push_back(sample->received_time_ns);
  CHECK(times == std::vector<std::int64_t>{1, 4, 10});
  CHECK(reader.parts() == 3);
  CHECK(repair(file, folder / "whole.mcap").warnings.empty());
  SampleReader repaired(folder / "whole.mcap");
  times.clear();
  while (auto sample = repaired.next()) times.push_back(sample->received_time_ns);
  CHECK(times == std::vector<std::int64_t>{1, 4, 10});
}

TEST_CASE("sample reader: a later part that is no recording is left out, and named") {
  // Oracle: the samples of the parts before and behind it; one line about it, however often one
  // asks for a next sample.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  for (const int part : {1, 3}) {
    SampleFile writer(part_of(file, part), {});
    writer.add(raw_sample(bus::kProbeState, probe_state(1, 0, 1, {4, 5, 6}), part, 1));
    writer.close();
  }
  const std::string bad = part_of(file, 2).string();
  std::string why = bad +
                    ": offset 0: not an MCAP file of version 0 (its first bytes are not "
                    "\\x89MCAP0\\r\\n); this part is left out";
  SECTION("empty") { write_bytes(bad, {}); }
  SECTION("junk") { write_bytes(bad, std::vector<std::uint8_t>(100, 'x')); }
  SECTION("a folder") {
    std::filesystem::create_directory(bad);
    why = bad + ": is a folder, not a file; this part is left out";
  }
  SampleReader reader(file);
  std::vector<std::int64_t> times;
  while (auto sample = reader.next()) times.push_back(sample->received_time_ns);
  CHECK_FALSE(reader.next());
  CHECK(times == std::vector<std::int64_t>{1, 3});
  CHECK(reader.parts() == 2);
  CHECK(reader.warnings() == std::vector<std::string>{why});
}

TEST_CASE("sample reader: gives each sample with its topic, its channel and its time") {
  // Oracle: round trip with SampleFile; one channel per writer.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  const auto first = raw_sample(bus::kProbeState, probe_state(1, 0, 0, {1, 2, 3}), 1000, 1);
  const auto second = raw_sample(bus::kProbeState, probe_state(1, 0, 1, {4, 5, 6}), 2000, 2);
  const auto third = raw_sample(bus::kNodePositions, node_positions(1, 1e-3, 5), 3000, 1);
  {
    SampleFile writer(file, {});
    for (const auto& sample : {first, second, third, first}) writer.add(sample);
    writer.close();
  }
  SampleReader reader(file);
  std::vector<RecordedSample> samples;
  while (auto sample = reader.next()) samples.push_back(*sample);
  REQUIRE(samples.size() == 4);
  CHECK(samples[0].topic == first.topic);
  CHECK(samples[2].topic == third.topic);
  CHECK(samples[0].payload == first.payload);
  CHECK(samples[1].payload == second.payload);
  CHECK(samples[1].received_time_ns == 2000);
  CHECK(samples[0].channel != samples[1].channel);
  CHECK(samples[0].channel == samples[3].channel);
  CHECK_FALSE(reader.torn());
}

TEST_CASE("sample reader: other types, other versions and other encodings are refused") {
  // Oracle: the message each rule must give, and the record's place: the schema record follows
  // magic and header, 8 + 24 bytes.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap";
  const std::string schema_place = file.string() + ": offset 32: ";
  CHECK(message_of(file, probe_schema(), "probe_state") == "no error");
  CHECK(message_of(file, {0, "std_msgs/String", "ros2msg", "string data"}, "/chatter") ==
        schema_place + "type 'std_msgs/String' is not one of Palpate's (palpate::idl::…)");

  McapSchema older = probe_schema();
  older.data.replace(older.data.find("position_m"), 10, "place_m");
  const std::string differs = schema_place +
                              "type 'palpate::idl::ProbeState' differs from the present one: "
                              "recorded by another version of Palpate";
  CHECK(message_of(file, older, "probe_state") == differs);
  McapSchema other_encoding = probe_schema();
  other_encoding.encoding = "ros2idl";
  CHECK(message_of(file, other_encoding, "probe_state") == differs);

  using Catch::EndsWith;
  CHECK_THAT(message_of(file, probe_schema(), "tool_state"),
             EndsWith(": topic 'tool_state' is not one of Palpate's"));
  CHECK_THAT(message_of(file, probe_schema(), "contacts"),
             EndsWith(": topic 'contacts' must be of type 'palpate::idl::Contacts'"));
  CHECK_THAT(message_of(file, probe_schema(), "probe_state", "json"),
             EndsWith(": topic 'probe_state' is encoded as 'json'; allowed: cdr"));
}

TEST_CASE("sample reader: what a recording says reaches no terminal as a command") {
  // Oracle: ECMA-48: control characters are below U+0020, U+007F, and U+0080 … U+009F.
  const ScratchFolder folder;
  CHECK_THAT(message_of(folder / "a.mcap", probe_schema(), "\x1b[31m"),
             Catch::EndsWith(": topic '?[31m' is not one of Palpate's"));
}

TEST_CASE("sample reader: comments of an IDL file may change between versions") {
  // Oracle: the rule of same_idl().
  const ScratchFolder folder;
  McapSchema schema = probe_schema();
  schema.data = "// Reworded.\n" + schema.data;
  CHECK(message_of(folder / "a.mcap", schema, "probe_state") == "no error");
}

TEST_CASE("sample reader: a torn file says where it ends") {
  // Oracle: the sizes of the files, cut in the middle of the last chunk.
  const ScratchFolder folder;
  const auto file = folder / "torn.mcap";
  std::uint64_t whole = 0;
  {
    SampleFile writer(file, {});
    writer.add(raw_sample(bus::kNodePositions, node_positions(1, 1e-3, 5), 1));
    writer.end_chunk();
    whole = writer.bytes_written();
    writer.add(raw_sample(bus::kNodePositions, node_positions(2, 1e-3, 5), 2));
    writer.end_chunk();
    writer.flush();
  }
  std::filesystem::resize_file(file, whole + 20);
  SampleReader reader(file);
  CHECK(reader.next());
  CHECK_FALSE(reader.next());
  CHECK(reader.torn());
  CHECK(reader.warnings() ==
        std::vector<std::string>{file.string() + ": not closed by its writer; whole up to byte " +
                                 std::to_string(whole) + " of " + std::to_string(whole + 20)});
}

}  // namespace palpate::recording
