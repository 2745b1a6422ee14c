// What many random scenes came to.
#pragma once

#include <iosfwd>
#include <map>
#include <vector>

#include "studies/fuzz/outcome.h"

namespace palpate::fuzz {

class Tally {
 public:
  void add(std::uint64_t number, const Outcome& outcome);
  void print(std::ostream& out) const;

  std::uint64_t failed() const { return failed_; }

 private:
  std::uint64_t scenes_ = 0, refused_ = 0, failed_ = 0;
  std::uint64_t guarded_ = 0;                                   ///< scenes in which any guard acted
  std::uint64_t state_guarded_ = 0, replaced_ = 0;              ///< of the state; by replacing it
  std::uint64_t state_fine_ = 0, replaced_fine_ = 0;            ///< of those, fine without any
  std::array<std::uint64_t, kGuardCount> guards_{};             ///< scenes in which each acted
  std::array<std::uint64_t, kGuardCount> fine_{};               ///< of those, fine without any
  std::map<std::string, std::vector<std::uint64_t>> failures_;  ///< scenes of each kind
};

}  // namespace palpate::fuzz
