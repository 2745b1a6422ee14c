#include "modules/bus/clock_offset.h"

#include <cmath>
#include <limits>

namespace palpate::bus {
namespace {

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

}  // namespace

bool ClockOffset::contradicts(const Interval& interval) const {
  const Estimate known = at(interval.at_ns);
  return std::abs(seconds(interval.middle_ns - known.offset_ns)) > interval.half + known.error;
}

void ClockOffset::add(const RoundTrip& trip) {
  const std::int64_t least = trip.sent_here - trip.received_there;
  const std::int64_t most = trip.received_here - trip.sent_there;
  if (most < least || trip.received_here < trip.sent_here) return;
  const Interval interval{trip.sent_here + (trip.received_here - trip.sent_here) / 2,
                          least + (most - least) / 2, seconds(most - least) / 2};
  if (known() && contradicts(interval)) {
    if (++contradictions_ < kJumpAfter) return;
    best_.clear();
    ++jumps_;
  }
  contradictions_ = 0;
  if (best_.empty() || interval.at_ns / kBlock > best_.back().at_ns / kBlock) {
    best_.push_back(interval);
    if (best_.size() > kBlocks) best_.pop_front();
  } else if (interval.half < best_.back().half) {
    best_.back() = interval;
  }
}

// From the two blocks whose line is known best: how far its slope can be off is the sum of the half
// widths over the time between.
double ClockOffset::drift() const {
  if (best_.size() < 2) return 0;
  double least = kMostDrift, slope = 0;
  const Interval& newest = best_.back();
  for (const Interval& old : best_) {
    const double time = seconds(newest.at_ns - old.at_ns);
    if (time <= 0) continue;
    const double uncertain = (newest.half + old.half) / time;
    if (uncertain >= least) continue;
    least = uncertain;
    slope = seconds(newest.middle_ns - old.middle_ns) / time;
  }
  return slope;
}

ClockOffset::Estimate ClockOffset::at(std::int64_t now_ns) const {
  Estimate estimate{0, std::numeric_limits<double>::infinity()};
  const double slope = drift();
  for (const Interval& interval : best_) {
    const double age = seconds(now_ns - interval.at_ns);
    const double error = interval.half + kMostDrift * std::abs(age);
    if (error >= estimate.error) continue;
    estimate = {interval.middle_ns + static_cast<std::int64_t>(1e9 * slope * age), error};
  }
  return estimate;
}

}  // namespace palpate::bus
