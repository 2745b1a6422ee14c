// Which candidates need not be run to their ends: none that is dropped could have been chosen, nor
// shown a way out where nothing meets the needs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/plan/verdict.h"

namespace palpate::plan {

class Rivals {
 public:
  /// @param truths    outlives this; empty: candidates are judged by a reference, at their end
  /// @param one_rate  candidates of another rate are no rivals: all organs are to have one
  Rivals(const scene::Needs& needs, const std::vector<TrueTouch>& truths, bool one_rate)
      : needs_(needs), truths_(truths), one_rate_(one_rate) {}

  /// Of one that ran to its end.
  void add(const Verdict& verdict, const Course& course);

  /// @returns why the candidate need not be run on: it loads a core far too much; or, after some
  ///          instants, it loads more than one that meets all needs, and much more or with more
  ///          error; or it misses a need for sure and loads more, with more error, than another
  std::string why_stop(const Candidate& candidate, const Course& so_far) const;

 private:
  struct Rival {
    std::string name;
    double rate = 0, load = 0;
    bool meets_all = false;
    std::vector<Errors> errors;  ///< of the first instant, of the first two, …
  };

  std::string why_too_slow(const Course& so_far) const;
  bool misses_for_sure(const Errors& so_far, std::size_t instants) const;

  const scene::Needs& needs_;
  const std::vector<TrueTouch>& truths_;
  bool one_rate_;
  std::vector<Rival> rivals_;
};

}  // namespace palpate::plan
