#include "palpate/session_text.h"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace palpate;
using namespace palpate::launcher;
using Catch::Contains;

namespace {

/// A session of one organ, one probe and two modules, some seconds old.
SessionTally stomach_tally() {
  scene::Scene scene;
  scene.organs.resize(1);
  scene.organs[0].name = "stomach";
  scene.probes.resize(1);
  scene.probes[0].name = "finger";
  SessionTally tally(scene);
  tally.start();
  ModuleStatus haptics;
  haptics.module = "haptics";
  haptics.rate_hz = 999.6;
  haptics.nominal_rate_hz = 1000;
  haptics.cycles = 11'994;
  haptics.overruns = 6;
  haptics.worst_lateness = 2.5e-3;
  haptics.realtime_priority = true;
  haptics.packets_refused = 23;
  haptics.inputs.push_back({"contact_model", 0.002, 0, 3000, 17, 1});
  haptics.probes.push_back({0, 0.5, 0.5, kForceSlewLimited | kForceStaleFade, 0});
  tally.receive(haptics);
  ModuleStatus deformation;
  deformation.module = "deformation";
  deformation.real_time_factor = 0.97;
  deformation.organs.push_back({0, 1.00005, 5e-5, 0, 0, 0});
  deformation.contacts = {3, 2, 1};
  deformation.state = ModuleState::kDegraded;
  deformation.last_error = "slower than real time";
  tally.receive(deformation);
  return tally;
}

}  // namespace

TEST_CASE("status line: one line with time, speed, volume, force, rates and troubles") {
  // Oracle: the numbers given.
  const auto line = status_line(stomach_tally(), 12);
  CHECK(std::count(line.begin(), line.end(), '\n') == 0);
  CHECK_THAT(line, Contains("12.0 s") && Contains("real time 0.97") &&
                       Contains("V/V* stomach 1.000050") && Contains("force finger 0.500 N") &&
                       Contains("haptics 1000 Hz (6 missed)") &&
                       Contains("[slower than real time]"));
}

TEST_CASE("status line: of a module whose process does not run it tells nothing old") {
  // Oracle: the words given.
  const auto line = status_line(stomach_tally(), 12, {"haptics", "recorder"});
  CHECK_THAT(line, Contains("force finger ?") && Contains("haptics away") && !Contains("0.500 N") &&
                       !Contains("missed") && Contains("[slower than real time]"));
}

TEST_CASE("waiting line: names who has not been heard, and what may be why") {
  // Oracle: the words given.
  CHECK(waiting_line({"haptics", "deformation"}, false, {}) == "waiting for haptics, deformation");
  CHECK(waiting_line({"collision"}, true, {7, "it was late"}) ==
        "waiting for collision; only who has keys of the same folder is heard; 7 packets refused, "
        "the last: it was late");
}

TEST_CASE("summary: one screen with what the session was and what failed") {
  // Oracle: the numbers given.
  SessionEnd end{"stomach_probe",
                 12,
                 12.1,
                 {{"haptics", "[haptics] info: bye"}, {"collision", "no more"}},
                 {},
                 false};
  end.failures["collision"] = "killed by signal 9 (Killed)";
  const auto text = summary(stomach_tally(), end);
  CHECK(std::count(text.begin(), text.end(), '\n') <= 24);
  CHECK_THAT(text, Contains("scene stomach_probe: 11.6 s simulated in 12.0 s, "
                            "real-time factor 0.970\n") &&
                       Contains("|V-V*|/V* at most 5.00e-05") &&
                       Contains("force at most 0.500 N   limits that acted: slew, stale") &&
                       Contains("contacts: 3 searches truncated, 2 with a probe inside without "
                                "contact, 1 steps not solved\n"));
  CHECK_THAT(text, Contains("11994 cycles, 99.950 % on time") &&
                       Contains("worst lateness 2.50 ms since its start") &&
                       Contains("real-time priority") && Contains("1 samples refused") &&
                       !Contains("overtaken") && Contains("23 packets from a stranger refused"));
  CHECK_THAT(text, Contains("degraded for a while: deformation: slower than real time") &&
                       Contains("FAILED: collision: killed by signal 9 (Killed)\n"
                                "  it said at last: no more\n") &&
                       !Contains("bye"));
}

TEST_CASE("summary: a recording that ended before its session is told of") {
  // Oracle: the words given.
  SessionEnd end{"stomach_probe", 12, 12.1, {}, {}, false};
  CHECK_THAT(summary(stomach_tally(), end), !Contains("recording"));
  end.recording = "ended 3.1 s into the session";
  CHECK_THAT(summary(stomach_tally(), end), Contains("recording: ended 3.1 s into the session\n"));
}

TEST_CASE("summary: a force says what of it is the mesh's, as it was when it was greatest") {
  // Oracle: the numbers given.
  SessionTally tally = stomach_tally();
  const auto felt = [&](double newtons, double error) {
    const ProbeExtremes probe{0, newtons, newtons, 0, error};
    tally.receive(std::span(&probe, 1));
    return summary(tally, {"stomach_probe", 12, 12.1, {}, {}, false});
  };
  CHECK_THAT(felt(0.8, 0.12),
             Contains("force at most 0.800 N (too large by about 12 %: the mesh)"));
  CHECK_THAT(felt(0.7, 0.3), Contains("0.800 N (too large by about 12 %"));
  CHECK_THAT(felt(0.9, 1), Contains("0.900 N (twice too large, or more: the mesh)"));
}

TEST_CASE("summary: in lockstep speed is simulated over wall time, and nobody is late") {
  // Oracle: the numbers given.
  const auto text = summary(stomach_tally(), {"stomach_probe", 12, 4, {}, {}, true});
  CHECK_THAT(text, Contains("12.0 s simulated in 4.0 s") && Contains("real-time factor 3.000") &&
                       Contains("haptics      11994 cycles\n"));
  CHECK_THAT(text, !Contains("on time") && !Contains("lateness"));
}

TEST_CASE("limit names: all bits have one") {
  // Oracle: the bits of messages.h.
  CHECK(limit_names(kForceNotLimited) == "none");
  CHECK(limit_names(kForceSaturated | kForcePassivity | kForceNotFinite | kForceOutOfValidity) ==
        "saturated, passivity, not finite, out of validity");
}
