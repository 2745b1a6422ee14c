#include "modules/bus/tap.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <optional>

#include "modules/bus/memory_bus.h"

namespace palpate::bus {
namespace {

// Writes probe states at x = 1, 2, … through taps, and tells which x arrive.
class Line {
 public:
  Line() : tapped_(bus_), reader_(bus_.reader(kProbeState)) {
    tapped_.set_clock([this] { return now_ns_; });
  }
  TappedBus& bus() { return tapped_; }
  void set_time(std::int64_t now_ns) { now_ns_ = now_ns; }

  std::vector<double> write(int samples) {
    if (!writer_) writer_.emplace(tapped_.writer(kProbeState));
    for (int i = 0; i < samples; ++i) {
      ProbeState state;
      state.header.source_time_ns = 1;
      state.pose.position.x() = ++written_;
      REQUIRE(writer_->write(state));
    }
    std::vector<double> arrived;
    ProbeState state;
    while (reader_.take(state)) arrived.push_back(state.pose.position.x());
    return arrived;
  }
  const ReaderStatistics& statistics() const { return reader_.statistics(); }

 private:
  MemoryBus bus_{true};
  TappedBus tapped_;
  Reader<ProbeState> reader_;
  std::optional<Writer<ProbeState>> writer_;
  double written_ = 0;
  std::int64_t now_ns_ = 0;
};

using Xs = std::vector<double>;

}  // namespace

TEST_CASE("tap: a bus without taps passes everything, and taps of other topics do nothing",
          "[bus]") {
  // Oracle: what was written.
  Line line;
  line.bus().set_tap("contacts", lose_tap([](const Passing&) { return true; }));
  CHECK(line.write(3) == Xs{1, 2, 3});
}

TEST_CASE("tap: recorders see all, and change nothing", "[bus]") {
  // Oracle: counts by hand; 152 bytes are the probe state's size in docs/topics.md.
  Line line;
  std::vector<std::uint64_t> sequences;
  line.bus().set_tap("probe_state", record_tap([&](const Passing& passing) {
                       CHECK(passing.topic.name == "probe_state");
                       CHECK(passing.payload.size() == 152);
                       sequences.push_back(messages::header_of(passing.payload).sequence);
                     }));
  CHECK(line.write(3) == Xs{1, 2, 3});
  CHECK(sequences == std::vector<std::uint64_t>{1, 2, 3});
}

TEST_CASE("tap: a delay of samples hands on what was written so many writes before", "[bus]") {
  // Oracle: a shift register by hand.
  Line line;
  line.bus().set_tap("probe_state", delay_tap(2));
  CHECK(line.write(2).empty());
  CHECK(line.write(1) == Xs{1});
  CHECK(line.write(2) == Xs{2, 3});
}

TEST_CASE("tap: a delay of time holds samples that long", "[bus]") {
  // Oracle: the clock that the test sets.
  Line line;
  line.bus().set_tap("probe_state", time_delay_tap(10));
  CHECK(line.write(2).empty());
  line.set_time(9);
  CHECK(line.write(1).empty());
  line.set_time(10);
  CHECK(line.write(1) == Xs{1, 2});
  line.set_time(19);
  CHECK(line.write(1) == Xs{3});
}

TEST_CASE("tap: what is lost shows as a gap", "[bus]") {
  // Oracle: every second sample is lost; gaps are counted up to the newest taken.
  Line line;
  line.bus().set_tap("probe_state",
                     lose_tap([n = 0](const Passing&) mutable { return n++ % 2 == 1; }));
  CHECK(line.write(5) == Xs{1, 3, 5});
  CHECK(line.statistics().dropped == 2);
}

TEST_CASE("tap: what is repeated arrives so often", "[bus]") {
  // Oracle: counts by hand.
  Line line;
  line.bus().set_tap("probe_state", repeat_tap(3));
  CHECK(line.write(2) == Xs{1, 1, 1, 2, 2, 2});
}

TEST_CASE("tap: a tap for a while leaves alone what is written before and after", "[bus]") {
  // Oracle: the clock that the test sets.
  Line line;
  const auto nothing_travels = lose_tap([](const Passing&) { return true; });
  line.bus().set_tap("probe_state",
                     tap_while([](const Passing& p) { return p.now_ns == 1; }, nothing_travels));
  CHECK(line.write(1) == Xs{1});
  line.set_time(1);
  CHECK(line.write(2).empty());
  line.set_time(2);
  CHECK(line.write(1) == Xs{4});
}

TEST_CASE("tap: a payload cut short is refused by the reader", "[bus]") {
  // Oracle: the reader's own count.
  Line line;
  line.bus().set_tap("probe_state", [](const Passing& passing, const Forward& forward) {
    forward(passing.payload.first(passing.payload.size() - 8));
  });
  CHECK(line.write(2).empty());
  CHECK(line.statistics().rejected == 2);
  CHECK(std::string(line.statistics().last_rejected_field) == "payload");
}

TEST_CASE("tap: a changed message travels, and an invalid one only unchecked", "[bus]") {
  // Oracle: the change made; the field corrupted.
  const auto corrupt = [](ProbeState& state) {
    double& x = state.pose.position.x();
    x = x == 2 ? std::nan("") : 10 * x;
  };
  Line checked;
  checked.bus().set_tap("probe_state", change_tap<ProbeState>(corrupt, true));
  CHECK(checked.write(3) == Xs{10, 30});
  CHECK(checked.statistics().rejected == 0);

  Line unchecked;
  unchecked.bus().set_tap("probe_state", change_tap<ProbeState>(corrupt, false));
  CHECK(unchecked.write(3) == Xs{10, 30});
  CHECK(unchecked.statistics().rejected == 1);
  CHECK(std::string(unchecked.statistics().last_rejected_field) == "position_m");
}

TEST_CASE("tap: each writer has taps of its own", "[bus]") {
  // Oracle: two writers behind a delay of one sample: what the one writes pushes nothing of the
  // other's out.
  MemoryBus memory(true);
  TappedBus bus(memory);
  bus.set_tap("probe_state", delay_tap(1));
  auto first = bus.writer(kProbeState), second = bus.writer(kProbeState);
  auto reader = bus.reader(kProbeState);
  ProbeState state, taken;
  state.probe = 1;
  REQUIRE(first.write(state));
  state.probe = 2;
  REQUIRE(second.write(state));
  CHECK_FALSE(reader.take(taken));
  REQUIRE(first.write(state));
  REQUIRE(reader.take(taken));
  CHECK(taken.probe == 1);
}

}  // namespace palpate::bus
