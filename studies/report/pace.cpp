#include "studies/report/pace.h"

#include <cmath>
#include <limits>

#include "studies/report/measures.h"

namespace palpate::report {

std::string text_of_time_left(double seconds) {
  if (std::isnan(seconds)) return {};
  constexpr double kInSeconds = 90;
  if (seconds > kInSeconds) return text_of("; about %.0f min left", std::ceil(seconds / 60));
  return text_of("; about %.0f s left", std::ceil(seconds));
}

void Pace::finish(double weight) {
  seconds_ += std::chrono::duration<double>(Clock::now() - start_).count();
  weight_ += weight;
}

double Pace::seconds_for(double weight) const {
  return weight_ > 0 ? seconds_ / weight_ * weight : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace palpate::report
