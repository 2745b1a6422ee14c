#include "modules/bus/roles.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "modules/bus/topics.h"

namespace palpate::bus {
namespace {

bool may(const std::vector<std::string_view>& topics, std::string_view topic) {
  return std::ranges::find(topics, topic) != topics.end();
}

}  // namespace

TEST_CASE("roles: each topic is written and read by those that docs/topics.md names", "[bus]") {
  // Oracle: the page's table, by hand; states of the tissue have one writer.
  const auto writers = [](std::string_view topic) {
    std::set<std::string_view> names;
    for (const Role& role : roles()) {
      if (may(role.writes, topic)) names.insert(role.name);
    }
    return names;
  };
  using Names = std::set<std::string_view>;
  CHECK(writers("scene") == Names{"palpate"});
  CHECK(writers("surface") == Names{"deformation"});
  CHECK(writers("node_positions") == Names{"deformation"});
  CHECK(writers("contact_model") == Names{"deformation"});
  CHECK(writers("contacts") == Names{"collision"});
  CHECK(writers("probe_state") == Names{"haptics"});
  CHECK(writers("haptic_force") == Names{"haptics"});
  CHECK(writers("probe_input") == Names{"driver", "emulated_device", "visualizer"});
  CHECK(writers("session_control") == Names{"palpate", "visualizer"});
}

TEST_CASE("roles: a viewer hears all and tells nothing but its clock", "[bus]") {
  // Oracle: its definition.
  const Role* viewer = find_role("viewer");
  REQUIRE(viewer != nullptr);
  REQUIRE(viewer->writes.size() == 1);
  CHECK(viewer->writes.front() == "clock");
  CHECK(viewer->reads.size() == all_topics().size());
  CHECK(find_role("stranger") == nullptr);
}

TEST_CASE("roles: all topics they name exist", "[bus]") {
  // Oracle: topics.h.
  for (const Role& role : roles()) {
    for (const auto& topics : {role.writes, role.reads}) {
      for (const auto topic : topics) CHECK(find_topic(topic) != nullptr);
    }
  }
}

TEST_CASE("roles: each of several processes of a job plays the job's") {
  // Oracle: the names by hand.
  REQUIRE(find_role("deformation") != nullptr);
  CHECK(find_role("deformation_2") == find_role("deformation"));
  for (const char* name : {"deformation_", "deformation_2x", "nobody_2", "_2", ""}) {
    CHECK(find_role(name) == nullptr);
  }
}

}  // namespace palpate::bus
