// The volume an organ is asked for: filling, breathing, insufflation.
#pragma once

#include <optional>

#include "modules/core/state_archive.h"
#include "modules/scene/scene.h"

namespace palpate::deformation {

/// V*(t)/V₀ of a scene's filling, followed no faster than its largest rate. A jump of V* would be a
/// jump of pressure ~ 1/h², so even a curve that jumps is followed as a ramp. Begins at 1, the rest
/// volume, whatever the curve says at time 0.
class TargetVolume {
 public:
  explicit TargetVolume(scene::Filling filling) : filling_(std::move(filling)) {}

  void reset() {
    ratio_ = 1;
    told_.reset();
  }
  /// Asks for `ratio` from now on, until reset(), whatever the scene says; followed as that is.
  void ask(double ratio) { told_ = ratio; }
  /// Follows from `ratio` on, wherever it was.
  void restart(double ratio) { ratio_ = ratio; }
  /// V*/V₀ at the end of a step of h [s] that ends at `time` [s].
  double follow(double time, double h);

  /// What is asked for, without the limit on the rate.
  static double asked(const scene::Filling& filling, double time);

  void exchange(StateArchive& archive) { archive(ratio_, told_); }

 private:
  scene::Filling filling_;
  double ratio_ = 1;
  std::optional<double> told_;
};

}  // namespace palpate::deformation
