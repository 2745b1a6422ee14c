#include "studies/contact_loop/contact_loop_command.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Geometry>
#include <ostream>
#include <random>

#include "deformation/contact/contact_solve.h"
#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/geometry/bounding_box.h"
#include "modules/scene/scene_file.h"
#include "modules/scene/scene_reader.h"
#include "palpate/session/contact_line.h"
#include "studies/contact_loop/contact_loop.h"
#include "studies/rigs/poked_organ.h"

namespace palpate::contact_loop {
namespace {

/// Where an organ is pressed: (x, z) [m], on the front of the shipped organs.
const Vec3 kOnLiver(-0.020, 0, 0.013), kOnStomach(0.022, 0, -0.004);

template <class T>
std::vector<T> or_else(const std::vector<T>& given, std::vector<T> usual) {
  return given.empty() ? usual : given;
}

/// The first is the usual one, if the organ is there; the others are drawn where the line along y
/// meets it, the same each time.
std::vector<Vec3> places_on(const geometry::TriangleSurface& surface, const Vec3& first,
                            int count) {
  const auto box = geometry::bounding_box(surface.nodes);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share;
  std::vector<Vec3> places;
  if (rigs::find_front(surface, first.x(), first.z())) places.push_back(first);
  while (std::ssize(places) < count) {
    const double x = box.min().x() + share(random) * box.sizes().x();
    const double z = box.min().z() + share(random) * box.sizes().z();
    if (rigs::find_front(surface, x, z)) places.emplace_back(x, 0, z);
  }
  return places;
}

struct Sum {
  long runs = 0, inside = 0, lost = 0;
  long presses = 0, crossings = 0, put_back = 0;       ///< of tools with points within
  long advances = 0, swallowed = 0, swallowed_on = 0;  ///< of round tools
  ContactTroubles troubles;

  void add(const Tool& tool, const LoopResult& result) {
    ++runs;
    inside += result.inside;
    lost += result.lost;
    troubles += result.troubles;
    presses += tool.within.empty() ? 0 : result.presses;
    crossings += result.crossings;
    put_back += result.put_back;
    advances += tool.is_round() ? result.advances : 0;
    swallowed += result.swallowed;
    swallowed_on += result.swallowed_on;
  }
};

std::vector<LoopCase> loops_of(const std::vector<Tool>& tools, const std::vector<double>& speeds,
                               const std::vector<double>& rates,
                               const std::vector<double>& collision_rates, double loss) {
  std::vector<LoopCase> loops;
  for (const double rate : rates) {
    for (const double collision_rate : collision_rates) {
      for (const Tool& tool : tools) {
        for (const double speed : speeds) {
          loops.push_back({tool, speed, rate, collision_rate, loss});
        }
      }
    }
  }
  return loops;
}

void print_line(const std::string& scene, const Vec3& place, const LoopCase& loop,
                const LoopResult& r, std::ostream& out) {
  const auto* ball = std::get_if<scene::SphereShape>(&loop.tool.shape);
  out << fmt::format(
             "{:<23} {:4.0f} {:4.0f}  {:<7} {:>6} {:7g} {:4g} {:11g} {:9} {:6} {:6} {:11.3f} "
             "{:12.2f} {:7} {:8} {:9} {:11.3f} {:9} {:9} {:8}\n",
             scene, 1e3 * place.x(), 1e3 * place.z(), loop.tool.name,
             ball != nullptr ? fmt::format("{:g}", 1e3 * ball->radius) : "", loop.speed,
             loop.deformation_hz, loop.collision_hz, r.searches, r.inside, r.lost, r.longest_lost,
             1e3 * r.deepest, r.presses, r.advances, r.crossings, 1e3 * r.deepest_tissue,
             r.swallowed, r.troubles.truncated, r.troubles.unsolved)
      << std::flush;
}

}  // namespace

int run_contact_loop(const ContactLoopOptions& options, const std::function<void()>& keep_going,
                     std::ostream& out) {
  const auto folder = data_file("scenes");
  using Files = std::vector<std::filesystem::path>;
  Files files =
      or_else(options.scenes,
              options.quick ? Files{folder / "stomach_probe.yaml"}
                            : Files{folder / "stomach_probe.yaml", folder / "liver_solid.yaml",
                                    folder / "stomach_probe_refined.yaml"});
  using Numbers = std::vector<double>;
  using Names = std::vector<std::string>;
  const Names names =
      or_else(options.tools, options.quick ? Names{"ball", "needle", "mesh"}
                                           : Names{"ball", "needle", "rod", "wire", "box", "blade",
                                                   "mesh", "cone", "grasper"});
  const Numbers radii = or_else(
      options.radii, options.quick ? Numbers{1e-3, 4e-3} : Numbers{5e-4, 1e-3, 2e-3, 4e-3, 8e-3});
  const Numbers speeds =
      or_else(options.speeds,
              options.quick ? Numbers{0.1, 1.0} : Numbers{0.05, 0.1, 0.25, 0.63, 1.26, 2.5});
  const Numbers rates =
      or_else(options.rates, options.quick ? Numbers{100} : Numbers{50, 100, 250});
  std::vector<Tool> tools;
  for (const std::string& name : names) {
    if (name != "ball") tools.push_back(make_tool(name, 0));
    for (const double radius : radii) {
      if (name == "ball") tools.push_back(make_tool(name, radius));
    }
  }
  const Numbers searches = or_else(options.collision_rates, Numbers{250});
  for (auto& file : files) file = scene::scene_file(file);
  out << "scene                   x, z [mm]  tool   r [mm] v [m/s] [Hz] of searches  searches "
         "inside   lost longest [s] deepest [mm] presses advances crossings tissue [mm] swallowed "
         "truncated unsolved\n";
  Sum sum;
  for (const auto& file : files) {
    const scene::Scene scene = scene::load_scene(file);
    const session::Assets assets = session::load_assets(scene);
    const bool is_liver = scene.organs.at(0).name == "liver";
    const auto places =
        places_on(assets.organs.at(0).surface, is_liver ? kOnLiver : kOnStomach, options.places);
    for (const Vec3& place : places) {
      for (const LoopCase& loop : loops_of(tools, speeds, rates, searches, options.loss)) {
        const LoopResult result = run_loop(scene, assets, place, loop, keep_going);
        print_line(file.stem().string(), place, loop, result, out);
        sum.add(loop.tool, result);
      }
    }
  }
  out << fmt::format(
             "{} runs: {} searches inside an organ, {} of them without contact\n"
             "{} presses: {} times the organ was left with a point "
             "within the tool inside, {} of them while a guard acted\n"
             "{} advances under round tools: {} left tissue deeper in one than {:g} mm and did not "
             "say so, {} of them in one that was known to have tissue in it\n",
             sum.runs, sum.inside, sum.lost, sum.presses, sum.crossings, sum.put_back, sum.advances,
             sum.swallowed, 1e3 * deformation::kUnsolvedDepth, sum.swallowed_on)
      << session::contact_line(sum.troubles) << '\n';
  const bool none = sum.lost == 0 && sum.crossings == 0 && sum.swallowed == sum.swallowed_on &&
                    sum.troubles.truncated == 0 && sum.troubles.lost == 0;
  return none ? kExitDone : kExitFailed;
}

}  // namespace palpate::contact_loop
