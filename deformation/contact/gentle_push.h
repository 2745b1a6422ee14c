// How an organ's penetration is undone that was not seen coming: gently, not in one step.
#pragma once

#include <cstdint>
#include <span>

#include "deformation/contact/contact_solve.h"
#include "deformation/model/organ_state.h"

namespace palpate::deformation {

/// One probe's push out of one organ. All rows together push as one motion would, along their mean
/// normal. Velocities come to it within kRise: tissue that swings is not stopped at a blow. Where
/// the probe itself moves on, tissue goes along; a probe that comes and goes, as encoders' steps
/// make it, does not bring tissue in anew.
class GentlePush {
 public:
  static constexpr double kSeenDepth = 1e-3;  ///< what is found deeper was not seen coming [m]
  static constexpr double kRise = 0.03;       ///< to the speed of the push [s]
  static constexpr double kEnd = 0.2;         ///< its speed falls with the depth over this [s]
  static constexpr double kDepth = 5e-6;      ///< at which it is over [m],
  static constexpr double kTime = 2;          ///< or, under a hand that moves, after this [s]

  GentlePush() = default;
  explicit GentlePush(std::uint32_t organ) : organ_(organ) {}

  /// Bounds how fast the rows push.
  /// @param rows    of the organ, at the beginning of a sub-step of h [s]
  /// @param inside  the probe's core is, there and then
  /// @returns false, with the rows as they are, if it is over
  bool soften(const OrganState& state, double h, bool inside, std::span<ContactRow> rows);

  std::uint32_t organ() const { return organ_; }
  /// Whether the probe's core was inside at the start of a sub-step since the push began.
  bool core_was_inside() const { return core_was_inside_; }

  void exchange(StateArchive& archive) { archive(organ_, time_, approach_, core_was_inside_); }

 private:
  std::uint32_t organ_ = 0;
  double time_ = 0;      ///< since the first contact [s]
  double approach_ = 0;  ///< of its tissue, at most: as in the first kEnd, then less [m/s]
  bool core_was_inside_ = false;
};

/// Of the deepest row, else 0 [m].
double deepest_of(std::span<const ContactRow> rows);

}  // namespace palpate::deformation
