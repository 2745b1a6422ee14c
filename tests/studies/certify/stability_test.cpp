#include "studies/certify/stability.h"

#include <catch2/catch.hpp>
#include <iostream>

#include "studies/certify/hands.h"
#include "tests/studies/certify/subjects.h"

using namespace palpate;
using namespace palpate::testing;
using namespace palpate::certify;

TEST_CASE("certify stability: a wall is stable to the formula's stiffness, softened also beyond") {
  // Oracle: analytic, b/(T/2 + t_d) at least: what is stiffer is softened to that. 5 %: the
  // bisection's 2 %, and a vibration counts as bounded when it has lost less than 2 % in five
  // seconds.
  for (const double transport : {0.0, 2e-3}) {
    Subject subject = wall_subject();
    subject.device.transport_delay = transport;
    const double formula = formula_stiffness(subject);
    CHECK(formula == Approx(0.2 / (5e-4 + 2 * transport)));
    const auto found = critical_stiffness(subject, kGoOn);
    REQUIRE(found.has_value());
    std::cout << "certify stability: formula " << formula << " N/m, found " << *found << " N/m\n";
    CHECK(*found > 0.95 * formula);
  }
}

TEST_CASE("certify stability: a scene that claims a damping which the device lacks fails") {
  // Oracle: the formula: 2 N·s/m would hold 4000 N/m, the device's 0.2 and the 1 of contact damping
  // 2400. At the border, ω = √(K/m) = 150 rad/s, the latter's velocity, a mean over 4 ms held for
  // 1, is 2.5 ms old: 0.92 of it damp, which holds 2240.
  Subject subject = wall_subject();
  subject.scene.haptics.device_damping = 2;
  const Line line = critical_line(subject, kGoOn);
  INFO(text_of(line));
  CHECK(line.verdict == Verdict::kFail);
  CHECK(line.value == Approx(2240).epsilon(0.05));
  CHECK(stiff_wall_line(subject, kGoOn).verdict == Verdict::kFail);
  CHECK(stiff_wall_line(wall_subject(), kGoOn).verdict == Verdict::kPass);
}

TEST_CASE("certify stability: a device that is calmed comes to rest, one that is not swings") {
  // Oracle: analytic, a swing decays as exp(−b t/2m): 2 N·s/m and 0.1 kg leave e⁻²⁰ of it after two
  // seconds, 0.2 N·s/m and 1 kg 0.8 of it. 0.48 N hold 80 N/m at 6 mm.
  Subject subject = wall_subject();
  subject.device.encoder_step = 0;
  const Loop wall = loop_on_wall(subject.scene, 80);
  subject.device.damping = 2;
  const auto calm = hold(wall, subject, 0.48, kGoOn);
  CHECK(calm.back().depth == Approx(subject.depth).epsilon(0.01));
  CHECK_FALSE(any_failed(held_lines("g", calm)));
  subject.device.damping = 0.2;
  subject.device.mass = 1;
  CHECK(held_lines("g", hold(wall, subject, 0.48, kGoOn)).front().verdict == Verdict::kFail);

  // A device that nothing pushes rests, too: that judges nothing.
  std::vector<Tick> alone = calm;
  for (Tick& tick : alone) tick.motor = 1e-4;
  for (const Line& line : held_lines("g", alone)) {
    CHECK(line.verdict == Verdict::kNotMeasured);
    CHECK(line.note.find("nothing to judge") == 0);
  }
}

TEST_CASE("certify stability: with nobody to calm it a pushed device rests on stomach and liver") {
  // Oracle: what docs/certify.md asks of a held contact: 0.1 mm after two seconds, and in the
  // fifth.
  struct Pushed {
    const char* scene;
    double push;
  };
  for (const auto& [scene, push] :
       {Pushed{"stomach_probe.yaml", 0.15}, {"liver_solid.yaml", 0.2}}) {
    const Subject subject =
        load_subject(std::filesystem::path(PALPATE_SOURCE_DIR) / "scenes" / scene, kGoOn);
    const auto ticks = hold(loop_on_organ(subject), subject, push, kGoOn);
    REQUIRE_FALSE(ticks.empty());
    CHECK(ticks.back().force == Approx(push).epsilon(0.2));  // encoder steps make it sway
    for (const Line& line : held_lines("g", ticks)) {
      INFO(scene << ' ' << text_of(line));
      CHECK(line.verdict == Verdict::kPass);
    }
  }
}
