#include "modules/bus/clock_exchange.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <deque>

namespace palpate::bus {
namespace {

constexpr std::int64_t kPerMs = 1'000'000;

/// Two processes of two hosts, and the way between them.
class Conversation {
 public:
  explicit Conversation(std::int64_t ahead_ns) : ahead_ns_(ahead_ns) {}

  /// Each speaks every 50 ms; what it says is heard `way_ns` later.
  void go_on(int rounds, std::int64_t way_ns) {
    for (int i = 0; i < rounds; ++i, now_ns_ += 50 * kPerMs) {
      ClockExchange ours = here_.speak(now_ns_), theirs = there_.speak(now_ns_ + ahead_ns_);
      ours.header.source_time_ns = now_ns_;
      theirs.header.source_time_ns = now_ns_ + ahead_ns_;
      if (const auto* known = here_.hear(theirs, now_ns_ + way_ns)) of_there_ = known;
      if (const auto* known = there_.hear(ours, now_ns_ + way_ns + ahead_ns_)) of_here_ = known;
    }
  }
  std::int64_t now_ns() const { return now_ns_; }
  const ClockOffset* of_there() const { return of_there_; }
  const ClockOffset* of_here() const { return of_here_; }
  ClockConversation& here() { return here_; }

 private:
  std::int64_t ahead_ns_, now_ns_ = 1'000 * kPerMs;
  ClockConversation here_{1}, there_{2};
  const ClockOffset *of_there_ = nullptr, *of_here_ = nullptr;
};

}  // namespace

TEST_CASE("clock exchange: both sides find the other's clock, each its own way", "[bus]") {
  // Oracle: 100,000 s; the ways are alike, so the middle is exact.
  constexpr std::int64_t kAhead = 100'000'000'000'000;
  Conversation talk(kAhead);
  talk.go_on(1, 3 * kPerMs);
  CHECK(talk.of_there() == nullptr);  // nobody has been answered yet
  talk.go_on(9, 3 * kPerMs);
  REQUIRE(talk.of_there() != nullptr);
  REQUIRE(talk.of_here() != nullptr);
  CHECK(talk.of_there()->at(talk.now_ns()).offset_ns == -kAhead);
  CHECK(talk.of_here()->at(talk.now_ns() + kAhead).offset_ns == kAhead);
  CHECK(talk.of_there()->at(talk.now_ns()).error < 0.0045);
}

TEST_CASE("clock exchange: own words, and words heard twice or late, say nothing", "[bus]") {
  // Oracle: the rule.
  ClockConversation one(7);
  ClockExchange said;
  said.process = 7;
  said.header.source_time_ns = 5;
  CHECK(one.hear(said, 10) == nullptr);
  CHECK(one.speak(20).echoes.empty());

  said.process = 8;
  one.hear(said, 10);
  said.header.source_time_ns = 4;
  one.hear(said, 11);
  REQUIRE(one.speak(20).echoes.size() == 1);
  CHECK(one.speak(20).echoes[0].sent_ns == 5);
  CHECK(one.speak(20).echoes[0].received_ns == 10);
}

TEST_CASE("clock exchange: who is silent is not answered any more", "[bus]") {
  // Oracle: kSilence.
  Conversation talk(0);
  talk.go_on(5, kPerMs);
  const std::int64_t last = talk.now_ns();
  CHECK(talk.here().speak(last).echoes.size() == 1);
  CHECK(talk.here().speak(last + ClockConversation::kSilence + kPerMs).echoes.empty());
}

}  // namespace palpate::bus
