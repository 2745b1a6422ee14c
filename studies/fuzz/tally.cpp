#include "studies/fuzz/tally.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <ostream>

namespace palpate::fuzz {
namespace {

constexpr std::size_t kListed = 10;  // failing scenes of a kind

bool replaces(Guard guard) { return guard <= Guard::kBackToRest; }

}  // namespace

void Tally::add(std::uint64_t number, const Outcome& outcome) {
  ++scenes_;
  refused_ += outcome.ending == Ending::kRefused;
  const bool fine = outcome.unguarded == Unguarded::kFine;
  bool any = false, replaced = false;
  for (std::size_t g = 0; g < kGuardCount; ++g) {
    if (outcome.guards[g] == 0) continue;
    any = true;
    replaced |= replaces(static_cast<Guard>(g));
    ++guards_[g];
    fine_[g] += fine;
  }
  guarded_ += any;
  const bool tried = outcome.unguarded != Unguarded::kNotTried;
  state_guarded_ += tried;
  state_fine_ += fine;
  replaced_ += tried && replaced;
  replaced_fine_ += fine && replaced;
  if (outcome.ending != Ending::kFailed) return;
  ++failed_;
  failures_[outcome.kind()].push_back(number);
}

void Tally::print(std::ostream& out) const {
  out << fmt::format("{} scenes: {} ran, {} refused with a message, {} failed unguarded\n", scenes_,
                     scenes_ - refused_ - failed_, refused_, failed_);
  out << fmt::format("guards acted in {} scenes:\n", guarded_);
  for (std::size_t g = 0; g < kGuardCount; ++g) {
    out << fmt::format("  {:<17} {}", kGuardNames[g], guards_[g]);
    if (acts_on_state(static_cast<Guard>(g))) {
      out << fmt::format(", of which {} end well without guards", fine_[g]);
    }
    out << '\n';
  }
  out << fmt::format(
      "without guards end well: {} of {} scenes in which a guard acted on an organ, {} of {} in "
      "which one replaced its state\n",
      state_fine_, state_guarded_, replaced_fine_, replaced_);
  for (const auto& [kind, numbers] : failures_) {
    const auto listed = std::ptrdiff_t(std::min(numbers.size(), kListed));
    out << fmt::format("FAILED {}: {} scenes, k = {}\n", kind, numbers.size(),
                       fmt::join(numbers.begin(), numbers.begin() + listed, ", "));
  }
}

}  // namespace palpate::fuzz
