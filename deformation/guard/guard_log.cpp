#include "deformation/guard/guard_log.h"

#include <cstdio>

namespace palpate::deformation {
namespace {

struct Kind {
  bool (*acts)(const AdvanceReport&);
  const char* text;
};

template <Disbelief reason>
bool replaced(const AdvanceReport& report) {
  return report.diverged && report.reason == reason;
}

/// From harsh to mild.
constexpr std::array<Kind, GuardLog::kKinds> kKindsOfGuards{{
    {[](const AdvanceReport& r) { return r.back_to_rest; },
     "an organ diverged again and again: it was put back to its rest state"},
    {replaced<Disbelief::kNotFinite>,
     "an organ diverged (a number not finite): its last good state was restored, at rest"},
    {replaced<Disbelief::kTooFast>,
     "an organ diverged (a node above 100 m/s): its last good state was restored, at rest"},
    {replaced<Disbelief::kTooLarge>,
     "an organ diverged (grown to 5 times its size): its last good state was restored, at rest"},
    {replaced<Disbelief::kTurnedInside>,
     "an organ was turned inside out: its last good state was restored, at rest"},
    {replaced<Disbelief::kCollapsed>,
     "an organ collapsed or folded and did not unfold: its last good state was restored, at rest"},
    {replaced<Disbelief::kEnergyGrew>,
     "an organ diverged (more energy than it was given): its last good state was restored, at "
     "rest"},
    {[](const AdvanceReport& r) { return r.contacts_ignored; },
     "an organ put back to its rest state takes no contacts for a second"},
    {[](const AdvanceReport& r) { return r.pressure_capped; },
     "an organ's pressure met its cap: its target volume gives way"},
    {[](const AdvanceReport& r) { return r.volume_released; },
     "an organ's volume was off by more than 5 %: it is brought back slowly"},
    {[](const AdvanceReport& r) { return r.volume_skipped; },
     "an organ is too flat for its volume to be corrected"},
    {[](const AdvanceReport& r) { return r.tissue_inverted; },
     "tissue is squeezed inside out in places: forces there are not to be believed"},
    {[](const AdvanceReport& r) { return r.contact_refused; },
     "a contact metres away from its tissue was not believed"},
    {[](const AdvanceReport& r) { return r.probe_jumped; },
     "a probe jumped: its contacts were dropped"},
    {[](const AdvanceReport& r) { return r.step_reduced; },
     "an organ held more energy than it was given: its steps are shortened"},
}};

}  // namespace

void GuardLog::reset() {
  counts_.fill({0, -2 * kSameEvent});
  text_[0] = '\0';
}

const char* GuardLog::describe(const AdvanceReport& report, double time) {
  const Kind* harshest = nullptr;
  std::uint64_t events = 0;
  for (std::size_t k = kKinds; k-- > 0;) {
    if (!kKindsOfGuards[k].acts(report)) continue;
    Count& count = counts_[k];
    if (time - count.last_time > kSameEvent) ++count.events;
    count.last_time = time;
    harshest = &kKindsOfGuards[k];
    events = count.events;
  }
  if (harshest == nullptr) return "";
  if (events == 1) return harshest->text;
  std::snprintf(text_.data(), text_.size(), "%s (%llu times)", harshest->text,
                static_cast<unsigned long long>(events));
  return text_.data();
}

}  // namespace palpate::deformation
