// What changes slowly and costs much to tell.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "modules/core/state_archive.h"

namespace palpate::deformation {

/// Numbers of several probes or organs that are found anew now and then, by the world's own time.
class SlowReadings {
 public:
  /// 0 until looked for. @param every  at least so far apart, but for a microsecond [s]
  SlowReadings(std::size_t count, double every) : newest_(count, 0.0), every_(every) {}

  /// Reads all of them if it is time to, or time has begun anew.
  /// @param time  simulated [s]
  void look(double time, const std::function<double(std::size_t)>& read);
  double of(std::size_t index) const { return newest_[index]; }

  /// @throws InputError if it is of another number of them
  void exchange(StateArchive& archive);

 private:
  std::vector<double> newest_;
  double every_;
  double next_ = 0;  ///< simulated [s]
};

}  // namespace palpate::deformation
