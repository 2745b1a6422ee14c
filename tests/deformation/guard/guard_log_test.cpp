#include "deformation/guard/guard_log.h"

#include <catch2/catch.hpp>
#include <set>
#include <vector>

namespace palpate::deformation {
namespace {

AdvanceReport replaced(Violation reason) {
  AdvanceReport report;
  report.diverged = report.step_reduced = true;
  report.reason = reason;
  return report;
}

TEST_CASE("guard log: nothing acted, nothing is noted") {
  // Oracle: definition.
  GuardLog log;
  CHECK(log.note({}, 0).code == GuardCode::kNone);
}

TEST_CASE("guard log: every guard has a code of its own, and every code a guard") {
  // Oracle: the members of AdvanceReport, and counting.
  std::vector<AdvanceReport> reports;
  for (int reason = 1; reason <= static_cast<int>(Violation::kCollapsed); ++reason) {
    reports.push_back(replaced(static_cast<Violation>(reason)));
  }
  for (const auto flag :
       {&AdvanceReport::back_to_rest, &AdvanceReport::step_reduced, &AdvanceReport::pressure_capped,
        &AdvanceReport::volume_released, &AdvanceReport::volume_skipped,
        &AdvanceReport::contacts_suspended, &AdvanceReport::tissue_inverted,
        &AdvanceReport::contact_refused, &AdvanceReport::probe_jumped,
        &AdvanceReport::organ_motion_cut, &AdvanceReport::organ_contacts_unsolved,
        &AdvanceReport::law_bounded, &AdvanceReport::mesh_coarser}) {
    reports.emplace_back();
    reports.back().*flag = true;
  }
  reports.emplace_back().contacts_unsolved = 2;
  std::set<GuardCode> codes;
  for (const auto& report : reports) codes.insert(GuardLog().note(report, 0).code);
  CHECK(codes.count(GuardCode::kNone) == 0);
  CHECK(codes.size() == reports.size());
  CHECK(codes.size() == kGuardCodes);
}

TEST_CASE("guard log: the harshest guard counts, and how often it acted") {
  // Oracle: definition; two advances within a second are one event.
  GuardLog log;
  auto report = replaced(Violation::kTooFast);
  report.probe_jumped = true;
  const auto times_at = [&](double time) {
    const GuardEvent event = log.note(report, time);
    CHECK(event.code == GuardCode::kTooFast);
    return event.times;
  };
  CHECK(times_at(1.0) == 1);
  CHECK(times_at(1.5) == 1);
  CHECK(times_at(3.0) == 2);
  CHECK(times_at(5.0) == 3);
  AdvanceReport jumped;
  jumped.probe_jumped = true;
  const GuardEvent mild = log.note(jumped, 7.0);
  CHECK(mild.code == GuardCode::kProbeJumped);
  CHECK(mild.times == 4);
  log.reset();
  CHECK(times_at(7.0) == 1);
}

}  // namespace
}  // namespace palpate::deformation
