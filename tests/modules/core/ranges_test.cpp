#include "modules/core/ranges.h"

#include <catch2/catch.hpp>
#include <random>

using namespace palpate;

namespace {

/// Chunks from the last to the first.
class Backwards : public ChunkRunner {
 public:
  void run(std::size_t count, ChunkBody body) override {
    while (count > 0) body(--count);
  }
};

}  // namespace

TEST_CASE("ranges: every thing is met once") {
  // Oracle: counted, for counts about the ends of ranges.
  for (const std::size_t count : {0ul, 1ul, 1023ul, 1024ul, 1025ul, 5000ul}) {
    std::vector<int> met(count, 0);
    Ranges().each(count, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) ++met[i];
    });
    CHECK(std::ranges::all_of(met, [](int times) { return times == 1; }));
  }
}

TEST_CASE("ranges: a sum has the same bits in whatever order ranges are done") {
  // Oracle: itself, one after the other; numbers whose sum depends on the order.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<double> numbers(10'000);
  for (double& number : numbers) number = any(random);
  const auto sums = [&](ChunkRunner* runner) {
    return Ranges(runner).sums(numbers.size(), [&](std::size_t first, std::size_t last) {
      Ranges::Sums part{};
      for (std::size_t i = first; i < last; ++i) part[0] += numbers[i], part[1] += 1;
      return part;
    });
  };
  Backwards backwards;
  CHECK(sums(&backwards) == sums(nullptr));
  CHECK(sums(nullptr)[1] == 10'000);
  double plain = 0;
  for (const double number : numbers) plain += number;
  CHECK(sums(nullptr)[0] == Approx(plain).epsilon(1e-12));
}
