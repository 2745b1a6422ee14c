// The stiffness of the hand's law against the organ's own: along a press, the force over one period
// more, ended 20 µm further and 20 µm less far.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>

#include "deformation/models.h"
#include "haptics/local_law.h"
#include "modules/core/error.h"
#include "modules/geometry/primitives.h"
#include "modules/runtime/program.h"
#include "modules/scene/assets.h"
#include "modules/scene/models.h"
#include "modules/scene/scene_reader.h"
#include "studies/certify/law.h"
#include "studies/report/measures.h"
#include "studies/rigs/poked_organ.h"
#include "studies/rigs/pressed_organ.h"
#include "studies/rigs/squeezed_ball.h"

using namespace palpate;

namespace {

void print(const std::string& name, const certify::Subject& subject) {
  std::cout << name << ", " << subject.scene.rates.deformation << " Hz:" << std::flush;
  ContactTroubles troubles;
  const auto points = certify::measure_law(
      subject, [] {}, troubles);
  for (const auto& point : points) {
    std::printf("  %.1f mm %.3g/%.3g", 1e3 * point.depth, point.law, point.organ);
    if (point.organ > 0) std::printf(" = %.2f", point.law / point.organ);
  }
  std::printf(";");
  for (const certify::Line& line : certify::law_lines(points)) {
    const char* const failed = line.verdict == certify::Verdict::kFail ? " failed" : "";
    std::printf("  %.1f %%%s", line.value, failed);
  }
  std::cout << std::endl;
}

certify::Subject on_ball(const char* model, double rate) {
  certify::Subject press;
  scene::Organ organ = rigs::ball_organ();
  organ.model = model;
  organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.03)});
  const bool solid = scene::is_solid(model);
  if (solid) {
    organ.tissue.youngs_modulus = 5e3;
    organ.solid.poisson_ratio = 0.45;
    press.assets.organs = {rigs::filled_ball(2)};
  } else {
    press.assets.organs = {geometry::make_ball(rigs::kBallRadius, 3)};
  }
  press.scene.organs.push_back(organ);
  press.scene.rates.deformation = rate;
  press.scene.probes.push_back({"tip", scene::SphereShape{0.008}, 0.1, scene::ScriptedDevice{}});
  press.place.pose.position = Vec3(0.003, 0.002, rigs::kBallRadius + 0.008);
  return press;
}

/// A shipped organ, where the charts poke it.
certify::Subject on_organ(const std::string& file) {
  certify::Subject press;
  press.scene = scene::load_scene(file);
  press.scene.organs.resize(1);
  press.scene.probes = {{"tip", scene::SphereShape{0.008}, 0.1, scene::ScriptedDevice{}}};
  press.assets.organs = {scene::load_organ(press.scene.organs[0])};
  const bool liver = file.find("liver") != std::string::npos;
  const rigs::PokedPlace place = liver ? rigs::kOnLiver : rigs::kOnStomach;
  const auto& surface = press.assets.organs[0].surface;
  Vec3& touch = press.place.pose.position;
  touch = rigs::poker_at(surface, place, 0);
  press.place.into = (rigs::poker_at(surface, place, 1) - touch).normalized();
  return press;
}

/// What is pressed instead of what the scene says.
struct Instead {
  std::string model;           ///< empty: as the scene says
  std::size_t iterations = 0;  ///< of a step; 0: as the scene says
};

/// Where the scene's probe touches first.
certify::Subject at_first_touch(const std::string& file, const Instead& instead) {
  certify::Subject subject = certify::load_subject(file, [] {});
  scene::Organ& organ = subject.scene.organs[subject.place.organ];
  if (!instead.model.empty()) {
    organ.model = instead.model;
    subject.assets.organs[subject.place.organ] = scene::load_organ(organ);
  }
  if (instead.iterations > 0) organ.iterations = instead.iterations;
  return subject;
}

/// What making and solving the law of a pressed ball costs: 16 rows with friction, the probe in
/// motion, a tick at a time.
void print_cost() {
  const certify::Subject press = on_ball("implicit_volume", 100);
  const auto at_period = [&](int i) { return pose_below(press.place, i * 2e-4 - 1e-3); };
  rigs::PressedOrgan organ(press.scene, press.assets.organs[0], {at_period(0)});
  for (int i = 1; i <= 45; ++i) organ.advance({at_period(i)});  // 8 mm deep at 20 mm/s
  const LocalLaw law = organ.law(0);
  haptics::LawSolver solver;
  solver.take(law);
  std::vector<double> solving, making;
  const auto timed = [](std::vector<double>& times, const auto& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;
    times.push_back(took.count());
  };
  double sum = 0;
  int sweeps = 0;
  for (int i = 0; i < 100'000; ++i) {
    Pose pose = law.anchor;
    pose.position += 3e-4 * Vec3(std::sin(0.03 * i), 0.5 * std::sin(0.011 * i), std::sin(0.02 * i));
    haptics::LawForce found;
    timed(solving, [&] { found = solver.evaluate(pose, 1e-3 * (i % 10)); });
    sum += found.wrench.force.z();
    sweeps = std::max(sweeps, found.sweeps);
  }
  for (int i = 0; i < 1000; ++i) timed(making, [&] { sum += organ.law(0).stiffness(2, 2); });
  std::printf(
      "%zu rows with friction: solved in %.1f us (median), %.1f us (99.9 %%), at most %d "
      "sweeps; made in %.0f us (median, %zu nodes)%s\n",
      law.rows.size(), report::quantile(solving, 0.5), report::quantile(solving, 0.999), sweeps,
      report::quantile(making, 0.5), organ.node_count(), sum == 0 ? " " : "");
  if (organ.lacks_contacts())
    throw std::runtime_error("contacts of the pressed ball were left out");
}

/// What a cycle of deformation takes, law inside, 1 to 6 mm deep at 20 mm/s.
void print_cycle(const certify::Subject& subject) {
  scene::Scene scene = subject.scene;
  scene.organs = {subject.scene.organs[subject.place.organ]};
  const double way = 0.02 / scene.rates.deformation;
  const auto at = [&](int i) { return pose_below(subject.place, i * way); };
  rigs::PressedOrgan organ(scene, subject.assets.organs[subject.place.organ], {at(-1)});
  double before = 0;
  int count = 0;
  for (int i = 0; i * way < 6e-3; ++i) {
    if (i * way < 1e-3) before = organ.busy();
    count += i * way < 1e-3 ? 0 : 1;
    organ.advance({at(i)});
  }
  std::printf("  a cycle of deformation, law inside: %.0f us\n",
              1e6 * (organ.busy() - before) / count);
}

int run(const std::vector<std::string>& scenes, bool at_touch, const Instead& instead) {
  if (at_touch) {
    for (const std::string& scene : scenes) {
      const certify::Subject subject = at_first_touch(scene, instead);
      print(instead.model.empty() ? scene : scene + " as " + instead.model, subject);
      print_cycle(subject);
    }
    return kExitDone;
  }
  print_cost();
  std::cout << "law/organ [N/m] = ratio, by depth of the press\n";
  for (const std::string& scene : scenes) print(scene, on_organ(scene));
  if (!scenes.empty()) return kExitDone;
  for (const double rate : {250.0, 100.0}) {
    for (const auto& row : deformation::model_rows()) {
      if (!scene::is_quadratic(row.word)) print(row.word, on_ball(row.word, rate));
    }
  }
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  runtime::Program program("Stiffness of the hand's law against the organ's own, along a press.",
                           "palpate-bench-law");
  std::vector<std::string> scenes;
  Instead instead;
  bool at_touch = false;
  program.add("SCENE", scenes, "Scenes whose first organ is pressed; none: a ball of each model");
  std::vector<std::string> words;
  for (const auto& row : deformation::model_rows()) words.emplace_back(row.word);
  program.add("--model", instead.model, "With --at-touch: simulate the organ so").one_of(words);
  program.add("--iterations", instead.iterations, "With --at-touch: of its steps, at most");
  program.flag(
      "--at-touch", at_touch,
      "Where each scene's probe touches first, as palpate certify does, and a cycle's cost");
  return program.run(argc, argv, [&] { return run(scenes, at_touch, instead); });
}
