// For a step that is taken again: why, and what rows bring to it. Friction starts from where the
// step before left it, not from what a dropped attempt made of it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "deformation/contact/contact_solve.h"

namespace palpate::deformation {

/// What the rows of a step did not hold, from mild to harsh.
enum class Missed : std::uint8_t {
  kNothing,
  kDeeper,    ///< tissue came deeper into a probe than it was, and no row more can hold it: it has
              ///< one and went round the core, or is on its gentle way out; it counts as not solved
  kDepth,     ///< tissue is in a probe; taken after all, the step counts as not solved
  kCrossing,  ///< a probe's core went through the wall; it is to be taken in halves
};

class StartingImpulses {
 public:
  void keep(std::span<const ContactRow> rows) {
    impulses_.clear();
    for (const ContactRow& row : rows) {
      impulses_.emplace_back(row.normal_impulse, row.tangential_impulse);
    }
  }
  /// To the rows they are of; those that came later keep what they bring.
  void give(std::span<ContactRow> rows) const {
    for (std::size_t r = 0; r < std::min(rows.size(), impulses_.size()); ++r) {
      rows[r].normal_impulse = impulses_[r].first;
      rows[r].tangential_impulse = impulses_[r].second;
    }
  }

 private:
  std::vector<std::pair<double, Vec3>> impulses_;
};

}  // namespace palpate::deformation
