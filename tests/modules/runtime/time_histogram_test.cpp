#include "modules/runtime/time_histogram.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

using palpate::runtime::TimeHistogram;

TEST_CASE("time histogram: a quantile is the sorted sample's, within one bin above") {
  // Oracle: brute force, sorting all samples. A bin is 2^(1/64) wide.
  std::mt19937 random(1);
  std::lognormal_distribution<double> lateness(11, 2);  // around 60 µs, from 1 µs to 100 ms
  TimeHistogram histogram;
  std::vector<double> samples;
  for (int i = 0; i < 20'000; ++i) {
    const double ns = std::max(2000.0, std::floor(lateness(random)));
    samples.push_back(ns);
    histogram.add(static_cast<std::int64_t>(ns));
  }
  std::sort(samples.begin(), samples.end());
  for (const double part : {0.01, 0.5, 0.9, 0.999}) {
    const auto rank = static_cast<std::size_t>(std::ceil(part * 20'000)) - 1;
    const double exact = 1e-9 * samples[rank];
    CHECK(histogram.quantile(part) >= exact * (1 - 1e-12));
    CHECK(histogram.quantile(part) <= exact * std::exp2(1.0 / 64) * (1 + 1e-12));
  }
  CHECK(histogram.count() == 20'000);
}

TEST_CASE("time histogram: holds its ends") {
  // Oracle: the range it documents.
  TimeHistogram histogram;
  CHECK(histogram.quantile(0.5) == 0);
  histogram.add(-5);
  CHECK(histogram.quantile(1) == Approx(1e-6));
  histogram.add(std::int64_t{3600} * 1'000'000'000);
  CHECK(histogram.quantile(1) > 10);
  CHECK(histogram.quantile(1) < 20);
}
