#include "modules/runtime/kept_state.h"

#include <unistd.h>

#include <catch2/catch.hpp>

#include "tests/times.h"

using namespace palpate;
using runtime::KeptMemory;
using runtime::KeptState;

namespace {

/// Remembers numbers.
struct Remembering final : runtime::Stage {
  std::vector<double> numbers;
  runtime::Health cycle(const runtime::Cycle&) override { return {}; }
  void exchange(StateArchive& archive) override { archive(numbers); }
};
/// Of another build.
struct Other final : runtime::Stage {
  std::int32_t number = 0;
  runtime::Health cycle(const runtime::Cycle&) override { return {}; }
  void exchange(StateArchive& archive) override { archive(number); }
};

SessionControl command(std::uint32_t reset_count) {
  SessionControl control;
  control.header.source_time_ns = 1;
  control.reset_count = reset_count;
  return control;
}

/// A process that lives for `seconds` from `begin` [s] and remembers them.
void live(const KeptMemory& memory, double begin, double seconds, std::uint32_t resets = 0) {
  Remembering stage;
  KeptState kept(memory.descriptor(), "scene");
  const auto at = [](double time) { return static_cast<std::int64_t>(time * kSecond); };
  kept.give_back(stage, at(begin));
  for (double time = begin; time <= begin + seconds; time += 0.05) {
    runtime::Cycle now;
    kept.tell(command(resets), now);
    stage.numbers = {time};
    kept.keep(stage, command(resets), at(time));
  }
}

}  // namespace

TEST_CASE("kept state: a successor goes on where its predecessor was a tenth of a second ago") {
  // Oracle: definition.
  const KeptMemory memory;
  Remembering stage;
  CHECK_FALSE(KeptState(memory.descriptor(), "scene").give_back(stage, 0));
  live(memory, 10, 2);
  KeptState kept(memory.descriptor(), "scene");
  const auto age = kept.give_back(stage, 13 * kSecond);
  REQUIRE(age);
  REQUIRE(stage.numbers.size() == 1);
  CHECK(stage.numbers[0] > 12 - KeptState::kEvery - 0.05);
  CHECK(*age == Approx(13 - stage.numbers[0]).margin(1e-6));
  runtime::Cycle now;
  kept.tell(command(0), now);
  CHECK(now.goes_on);
  CHECK_FALSE(now.reset);
  kept.tell(command(0), now);
  CHECK_FALSE(now.goes_on);  // said once
}

TEST_CASE("kept state: of another scene, or where nothing is inherited, nothing is given back") {
  // Oracle: definition.
  const KeptMemory memory;
  live(memory, 10, 2);
  Remembering stage;
  CHECK_FALSE(KeptState(std::nullopt, "scene").give_back(stage, 13 * kSecond));
  CHECK_FALSE(KeptState(100'000, "scene").give_back(stage, 13 * kSecond));  // is not open
  CHECK_FALSE(KeptState(memory.descriptor(), "another").give_back(stage, 13 * kSecond));
  CHECK(stage.numbers.empty());
}

TEST_CASE("kept state: who is killed while it writes leaves what was kept before") {
  // Oracle: by construction: where the next one goes is half overwritten, and nothing tells of it.
  const KeptMemory memory;
  live(memory, 10, 2);
  Remembering before;
  REQUIRE(KeptState(memory.descriptor(), "scene").give_back(before, 13 * kSecond));
  live(memory, 10, 2);
  live(memory, 10, 2);  // the one above was taken, and gone on from for more than a second
  const std::vector<std::uint8_t> torn(16, 0xff);
  int spoilt = 0;
  for (const std::int64_t place : {std::int64_t{4096}, 4096 + (std::int64_t{1} << 36)}) {
    const KeptMemory copy;
    std::vector<std::uint8_t> bytes(256);
    for (const std::int64_t at :
         {std::int64_t{0}, std::int64_t{4096}, 4096 + (std::int64_t{1} << 36)}) {
      const ssize_t got = pread(memory.descriptor(), bytes.data(), bytes.size(), at);
      REQUIRE(got > 0);
      REQUIRE(pwrite(copy.descriptor(), bytes.data(), std::size_t(got), at) == got);
    }
    REQUIRE(pwrite(copy.descriptor(), torn.data(), torn.size(), place) == 16);
    Remembering stage;
    try {
      const auto age = KeptState(copy.descriptor(), "scene").give_back(stage, 13 * kSecond);
      CHECK(age);
      CHECK(stage.numbers == before.numbers);
    } catch (const std::runtime_error&) {
      ++spoilt;
    }
  }
  CHECK(spoilt == 1);  // the one place that the mark tells of
}

TEST_CASE("kept state: who ends of what was kept is followed by one that begins at rest") {
  // Oracle: definition; who goes on for more than kTrusted did not end of it.
  const KeptMemory memory;
  live(memory, 10, 2);
  live(memory, 13, 0.5);  // takes it, and ends soon
  Remembering stage;
  CHECK_FALSE(KeptState(memory.descriptor(), "scene").give_back(stage, 14 * kSecond));
  live(memory, 14, 2);
  CHECK(KeptState(memory.descriptor(), "scene").give_back(stage, 17 * kSecond));
}

TEST_CASE("kept state: what another build kept ends the process, and the next begins at rest") {
  // Oracle: definition; no InputError, whose exit code nobody is started again after.
  const KeptMemory memory;
  live(memory, 10, 2);
  Other other;
  CHECK_THROWS_WITH(KeptState(memory.descriptor(), "scene").give_back(other, 13 * kSecond),
                    Catch::Contains("what its predecessor kept cannot be read: its state is laid "
                                    "out otherwise"));
  CHECK_FALSE(KeptState(memory.descriptor(), "scene").give_back(other, 13 * kSecond));
}

TEST_CASE("kept state: a reset that nobody was there for is made good") {
  // Oracle: definition. Until a command comes there is nothing to know, and nothing is kept.
  const KeptMemory memory;
  live(memory, 10, 2, 3);
  Remembering stage;
  KeptState kept(memory.descriptor(), "scene");
  REQUIRE(kept.give_back(stage, 13 * kSecond));
  runtime::Cycle now;
  kept.tell({}, now);
  CHECK((now.goes_on && !now.reset));
  stage.numbers = {99};
  kept.keep(stage, {}, 15 * kSecond);
  now = {};
  kept.tell(command(4), now);
  CHECK((now.reset && !now.goes_on));
  now = {};
  kept.tell(command(4), now);
  CHECK_FALSE(now.reset);
}
