#include "modules/runtime/silence_watch.h"

#include <algorithm>
#include <limits>

#include "modules/core/units.h"

namespace palpate::runtime {
namespace {
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min() / 2;
}

SilenceWatch::SilenceWatch(std::size_t sources, double limit)
    : newest_ns_(sources, kNever), limit_ns_(ns_from_seconds(limit)) {}

void SilenceWatch::heard(std::size_t source, std::int64_t source_time_ns) {
  if (source < newest_ns_.size()) {
    newest_ns_[source] = std::max(newest_ns_[source], source_time_ns);
  }
}

bool SilenceWatch::silent(std::size_t source, std::int64_t now_ns) const {
  return now_ns - newest_ns_[source] > limit_ns_;
}

bool SilenceWatch::any_silent(std::int64_t now_ns) const {
  return std::any_of(newest_ns_.begin(), newest_ns_.end(),
                     [&](std::int64_t newest_ns) { return now_ns - newest_ns > limit_ns_; });
}

}  // namespace palpate::runtime
