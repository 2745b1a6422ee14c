#include <catch2/catch.hpp>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "idl/ContactModel.h"
#include "idl/Contacts.h"
#include "idl/HapticForce.h"
#include "idl/NodePositions.h"
#include "idl/ProbeState.h"
#include "idl/SessionControl.h"
#include "modules/bus/topics.h"

namespace palpate::bus {
namespace {

struct Row {
  std::string name, type, kind;
  bool operator<(const Row& other) const { return name < other.name; }
  bool operator==(const Row&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Row& row) {
  return out << row.name << " " << row.type << " " << row.kind;
}

// Rows "| `name` | Type | … | kind | …" of the table of topics.
std::set<Row> documented() {
  std::ifstream file(PALPATE_SOURCE_DIR "/docs/topics.md");
  REQUIRE(file);
  const std::regex row(R"(^\| `([a-z_]+)` \| ([A-Za-z]+) \|.*\| (stream|state) \|.*)");
  std::set<Row> rows;
  for (std::string line; std::getline(file, line);) {
    std::smatch match;
    if (std::regex_match(line, match, row)) rows.insert({match[1], match[2], match[3]});
  }
  return rows;
}

// Bytes on the wire, with the 4 that every payload begins with.
template <class Wire>
std::string bytes(const Wire& wire) {
  return std::to_string(4 + Wire::getCdrSerializedSize(wire));
}

/// @param blocks  of triangles
std::string node_positions_bytes(std::size_t nodes, std::size_t blocks) {
  idl::NodePositions wire;
  wire.block_boxes_m().resize(6 * blocks);
  wire.positions_m().resize(3 * nodes);
  return bytes(wire);
}

}  // namespace

TEST_CASE("docs/topics.md: names, types and kinds of all topics are those of the code", "[bus]") {
  // Oracle: modules/bus/topics.h.
  std::set<Row> coded;
  for (const TopicInfo& topic : all_topics()) {
    coded.insert({std::string(topic.name), std::string(topic.type->name),
                  topic.delivery == Delivery::kStream ? "stream" : "state"});
  }
  CHECK(documented() == coded);
}

TEST_CASE("topics: every one that is declared is among all topics", "[bus]") {
  // Oracle: the declarations, counted in the header's text.
  std::ifstream file(PALPATE_SOURCE_DIR "/modules/bus/topics.h");
  std::stringstream text;
  text << file.rdbuf();
  const std::string header = text.str();
  const std::regex definition(R"(constexpr TopicOf<)");
  const auto begin = std::sregex_iterator(header.begin(), header.end(), definition);
  CHECK(static_cast<std::size_t>(std::distance(begin, {})) == all_topics().size());
}

TEST_CASE("docs/topics.md: sizes are those of the wire types", "[bus]") {
  // Oracle: the serialized sizes computed by the generated code.
  std::ifstream file(PALPATE_SOURCE_DIR "/docs/topics.md");
  std::stringstream text;
  text << file.rdbuf();
  const auto row_with = [&](const std::string& topic, const std::string& size) {
    return std::regex_search(text.str(), std::regex("\\| `" + topic + "` \\|.*\\| " + size));
  };
  CHECK(row_with("probe_state", bytes(idl::ProbeState()) + " B"));
  CHECK(row_with("probe_input", bytes(idl::ProbeState()) + " B"));
  CHECK(row_with("contact_model", bytes(idl::ContactModel()) + " B"));
  CHECK(row_with("haptic_force", bytes(idl::HapticForce()) + " B"));
  CHECK(row_with("session_control", bytes(idl::SessionControl()) + " B"));
  CHECK(row_with("contacts", bytes(idl::Contacts()) + " B \\+ 88 B per contact"));
  // Halved until no block has more than 128 of 1,096 and of 38,996 triangles.
  CHECK(node_positions_bytes(550, 16) == "7080");
  CHECK(node_positions_bytes(19'500, 512) == "246384");
  CHECK(row_with("node_positions", "7.1 KB / 246 KB"));
}

}  // namespace palpate::bus
