#include "studies/certify/disturbance.h"

#include <catch2/catch.hpp>

#include "modules/bus/memory_bus.h"

using namespace palpate;
using namespace palpate::certify;

namespace {

/// Source times of the laws that arrive, with when they did [ms].
std::vector<std::pair<double, double>> arrivals(const Disturbance& disturbance, int count) {
  std::int64_t now_ns = 0;
  bus::MemoryBus carrier{true};
  carrier.set_clock([&] { return now_ns; });
  const Loop loop = disturbed({}, disturbance);
  const auto tapped = loop.options.tap(carrier);
  auto writer = tapped->writer(bus::kContactModel);
  auto reader = carrier.reader(bus::kContactModel);
  std::vector<std::pair<double, double>> found;
  for (int i = 1; i <= count; ++i) {
    now_ns = i * 4'000'000;
    ContactModel law;
    law.header.source_time_ns = now_ns;
    writer.write(law);
    while (reader.take(law)) {
      found.emplace_back(1e-6 * double(law.header.source_time_ns), 1e-6 * double(now_ns));
    }
  }
  return found;
}

}  // namespace

TEST_CASE("certify disturbance: samples come late, in order, and as many are lost as said") {
  // Oracle: definition. Late by a multiple of the 4 ms between them, rounded up; of 2000 samples
  // with 20 % lost, 1600 with a deviation of 18 arrive: four of them.
  for (const auto& [sent, came] : arrivals({0.01, 0, 0}, 50)) CHECK(came - sent == Approx(12));
  double before = 0, shortest = 1e9, longest = 0;
  for (const auto& [sent, came] : arrivals({0.01, 0.02, 0}, 500)) {
    CHECK(sent > before);
    before = sent;
    shortest = std::min(shortest, came - sent);
    longest = std::max(longest, came - sent);
  }
  CHECK(shortest < 17);
  CHECK(shortest >= 10);
  CHECK(longest > 27);
  CHECK(longest < 35);
  const auto kept = arrivals({0, 0, 0.2}, 2000);
  CHECK(std::abs(double(kept.size()) - 1600) < 72);
  CHECK(kept == arrivals({0, 0, 0.2}, 2000));
}

TEST_CASE("certify disturbance: each says what it is") {
  // Oracle: definition.
  CHECK(Disturbance{0.01, 0.02, 0.2}.name() == "10 ms late, up to 20 ms more, 20 % lost");
  CHECK(disturbances(true).size() < disturbances(false).size());
}
