#include "modules/recording/topic_selection.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "modules/core/units.h"
#include "tests/modules/recording/payloads.h"

namespace palpate::recording {

TEST_CASE("topic selection: words choose topics, later ones count, the scene is always there") {
  // Oracle: by hand.
  CHECK(TopicSelection().has("contacts"));
  CHECK(TopicSelection(std::vector<std::string>{}).has("contacts"));
  const TopicSelection two({"haptic_force", "node_positions=30"});
  CHECK(two.has("haptic_force"));
  CHECK(two.rate("haptic_force") == 0);
  CHECK(two.rate("node_positions") == 30);
  CHECK_FALSE(two.has("contacts"));
  CHECK(two.has("scene"));
  const TopicSelection most({"contacts=5", "all", "node_positions=0.5"});
  CHECK(most.rate("contacts") == 0);
  CHECK(most.has("module_status"));
  CHECK(most.rate("node_positions") == 0.5);
}

TEST_CASE("topic selection: its text makes it again") {
  // Oracle: by hand.
  CHECK(TopicSelection().text() == "all");
  CHECK(TopicSelection(std::vector<std::string>{}).text() == "all");
  CHECK(TopicSelection({"node_positions=12.5", "contacts"}).text() ==
        "contacts,node_positions=12.5,scene");
}

TEST_CASE("topic selection: bad words are refused with what there is") {
  // Oracle: the messages.
  const auto refusal = [](const std::string& word) -> std::string {
    try {
      TopicSelection({word});
    } catch (const InputError& error) {
      return error.what();
    }
    return "taken";
  };
  CHECK_THAT(
      refusal("haptic_forces"),
      Catch::StartsWith("topics: there is no topic 'haptic_forces'; there are all, scene, "));
  CHECK_THAT(refusal("surface=1"), Catch::Contains("every sample of surface counts"));
  for (const char* rate : {"", "0", "-1", "nan", "inf", "1e9", "30Hz"}) {
    CHECK_THAT(refusal(std::string("contacts=") + rate),
               Catch::Contains("must be a number in (0, 10000] Hz"));
  }
}

TEST_CASE("topic selection: a thinned topic keeps each key's first sample of each period") {
  // Oracle: two organs at 250 Hz for a second, kept at 30 Hz: thirty of each, evenly.
  TopicSelection selection({"node_positions=30"});
  std::array<std::vector<std::int64_t>, 2> kept;
  for (int i = 0; i < 250; ++i) {
    for (std::uint32_t organ : {0u, 1u}) {
      NodePositions positions = node_positions(std::uint64_t(i) + 1, 1e-3, 0);
      positions.organ = organ;
      const std::int64_t time_ns = std::int64_t{4'000'000} * i;
      if (selection.takes(raw_sample(bus::kNodePositions, positions, time_ns))) {
        kept[organ].push_back(time_ns);
      }
    }
  }
  CHECK(kept[0].size() == 30);
  CHECK(kept[0] == kept[1]);
  for (std::size_t i = 1; i < kept[0].size(); ++i) {
    CHECK(std::abs(kept[0][i] - kept[0][i - 1] - kNanosecondsPerSecond / 30) <= 4'000'000);
  }
}

}  // namespace palpate::recording
