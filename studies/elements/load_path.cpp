#include "studies/elements/load_path.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace palpate::elements_bench {

LoadPath::LoadPath(const deformation::TaylorHoodElements& solid,
                   deformation::QuasiStaticNewton& solver, deformation::RigidContact* contact,
                   const Setting& setting)
    : solver_(solver), contact_(contact), setting_(setting), state_(solid.rest_state()) {}

bool LoadPath::attempt(double load, const Apply& apply) {
  const auto before = state_;
  apply(load, state_);
  const auto multipliers = contact_ ? contact_->multipliers() : std::vector<double>{};
  const auto report = solver_.solve(state_, {}, {}, setting_.keep_going);
  iterations_ += report.iterations;
  char line[120];
  std::snprintf(line, sizeof line, "load %-9.4g %2d iterations%s", load, report.iterations,
                report.converged ? "" : ", not converged");
  setting_.report(line);
  if (report.converged) {
    load_ = load;
    return true;
  }
  state_ = before;
  if (contact_) contact_->set_multipliers(multipliers);
  return false;
}

bool LoadPath::advance_to(double load, const Apply& apply) {
  double stride = longest_stride_;
  while (load_ < load) {
    const double left = load - load_;
    const double next = left > stride ? load_ + left / std::ceil(left / stride - 1e-9) : load;
    if (attempt(next, apply)) continue;
    stride = std::min(stride, left) / 2;
    if (stride < std::ldexp(longest_stride_, -kMostHalvings)) return false;
  }
  return true;
}

int LoadPath::take_iterations() { return std::exchange(iterations_, 0); }

}  // namespace palpate::elements_bench
