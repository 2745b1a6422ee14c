#include "studies/stability/verdict.h"

#include <algorithm>
#include <cmath>

#include "modules/core/error.h"

namespace palpate::stability {
namespace {

using Series = std::vector<double>;

std::size_t tenth_of(const Series& series) { return std::max<std::size_t>(1, series.size() / 10); }

double mean(Series::const_iterator begin, std::size_t count) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += *(begin + static_cast<long>(i));
  return sum / static_cast<double>(count);
}

double early(const Series& series) { return mean(series.begin(), tenth_of(series)); }
double late(const Series& series) {
  const std::size_t count = tenth_of(series);
  return mean(series.end() - static_cast<long>(count), count);
}

/// NaN stays.
double largest(const Series& series) {
  double result = 0;
  for (const double value : series) {
    if (!(value <= result)) result = value;
    if (std::isnan(result)) break;
  }
  return result;
}

bool drifts(const Signals& signals, const Tolerance& tolerance) {
  if (!(late(signals.volume_error) <= tolerance.volume_drift)) return true;
  if (tolerance.energy_drift >= kAnything) return false;
  return !(std::abs(late(signals.energy) / early(signals.energy) - 1) <= tolerance.energy_drift);
}

}  // namespace

const char* name_of(State state) {
  switch (state) {
    case State::kStable:
      return "stable";
    case State::kOscillating:
      return "oscillating";
    case State::kDrifting:
      return "drifting";
    case State::kDiverged:
      break;
  }
  return "diverged";
}

bool is_lost(const Signals& signals, const Tolerance& tolerance) {
  return !(signals.energy.back() <= kDivergedGain * tolerance.energy) ||
         !(signals.displacement.back() <= kDivergedDisplacement) ||
         !std::isfinite(signals.volume_error.back());
}

Verdict judge(const Signals& signals, const Tolerance& tolerance) {
  PALPATE_DEMAND(!signals.energy.empty());
  Verdict verdict;
  verdict.energy = largest(signals.energy) / tolerance.energy;
  verdict.volume_error = late(signals.volume_error);
  verdict.inverted = signals.inverted;
  verdict.displacement = largest(signals.displacement);
  if (is_lost(signals, tolerance) || !(verdict.energy <= kDivergedGain) ||
      verdict.inverted > kDivergedInversion) {
    verdict.state = State::kDiverged;
  } else if (!tolerance.may_turn && late(signals.kinetic) > kStill * tolerance.energy &&
             late(signals.turning) > 0) {
    verdict.state = State::kOscillating;
  } else if (drifts(signals, tolerance)) {
    verdict.state = State::kDrifting;
  }
  return verdict;
}

}  // namespace palpate::stability
