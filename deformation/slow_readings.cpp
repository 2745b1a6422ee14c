#include "deformation/slow_readings.h"

namespace palpate::deformation {

void SlowReadings::look(double time, const std::function<double(std::size_t)>& read) {
  constexpr double kRounding = 1e-6;  // of times that are sums of periods [s]
  const bool began_anew = time + every_ + kRounding < next_;
  if (time + kRounding < next_ && !began_anew) return;
  for (std::size_t i = 0; i < newest_.size(); ++i) newest_[i] = read(i);
  next_ = time + every_;
}

void SlowReadings::exchange(StateArchive& archive) {
  archive.same(newest_.size());
  for (double& reading : newest_) archive(reading);
  archive(next_);
}

}  // namespace palpate::deformation
