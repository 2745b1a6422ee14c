#include "modules/runtime/time_histogram.h"

#include <algorithm>
#include <cmath>

namespace palpate::runtime {
namespace {
constexpr double kFirstEdgeNs = 1000;  // everything up to 1 µs is in bin 0
}

void TimeHistogram::add(std::int64_t time_ns) {
  const double octaves = std::log2(std::max(1.0, static_cast<double>(time_ns) / kFirstEdgeNs));
  const int bin = static_cast<int>(std::ceil(octaves * kBinsPerOctave));
  ++bins_[static_cast<std::size_t>(std::min(bin, kBins - 1))];
  ++count_;
}

double TimeHistogram::upper_edge(int bin) {
  return 1e-9 * kFirstEdgeNs * std::exp2(static_cast<double>(bin) / kBinsPerOctave);
}

double TimeHistogram::quantile(double part) const {
  if (count_ == 0) return 0;
  const auto wanted = static_cast<std::uint64_t>(std::ceil(part * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    seen += bins_[static_cast<std::size_t>(bin)];
    if (seen >= std::max<std::uint64_t>(wanted, 1)) return upper_edge(bin);
  }
  return upper_edge(kBins - 1);
}

}  // namespace palpate::runtime
