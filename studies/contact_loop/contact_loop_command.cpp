#include "studies/contact_loop/contact_loop_command.h"

#include <spdlog/fmt/fmt.h>

#include <ostream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/scene/scene_reader.h"
#include "palpate/session/contact_line.h"
#include "studies/contact_loop/contact_loop.h"

namespace palpate::contact_loop {
namespace {

/// Where an organ is pressed: (x, z) [m], on the front of the shipped organs.
const Vec3 kOnLiver(-0.020, 0, 0.013), kOnStomach(0.022, 0, -0.004);

template <class T>
std::vector<T> or_else(const std::vector<T>& given, std::vector<T> usual) {
  return given.empty() ? usual : given;
}

struct Sum {
  long runs = 0, inside = 0, lost = 0;
  long presses = 0, crossings = 0;  ///< of round tools
  ContactTroubles troubles;
};

}  // namespace

int run_contact_loop(const ContactLoopOptions& options, const std::function<bool()>& stop,
                     std::ostream& out) {
  const auto folder = data_file("scenes");
  using Files = std::vector<std::filesystem::path>;
  const Files files =
      or_else(options.scenes,
              options.quick ? Files{folder / "stomach_probe.yaml"}
                            : Files{folder / "stomach_probe.yaml", folder / "liver_solid.yaml",
                                    folder / "stomach_probe_refined.yaml"});
  using Numbers = std::vector<double>;
  using Names = std::vector<std::string>;
  const Names names = or_else(options.tools, options.quick ? Names{"ball", "needle", "mesh"}
                                                           : Names{"ball", "needle", "box", "blade",
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
  out << "scene                   tool   r [mm] v [m/s] [Hz]  searches inside   lost longest [s] "
         "deepest [mm] presses advances crossings truncated unsolved\n";
  Sum sum;
  for (const auto& file : files) {
    const scene::Scene scene = scene::load_scene(file);
    const session::Assets assets = session::load_assets(scene);
    const bool is_liver = scene.organs.at(0).name == "liver";
    for (const double rate : rates) {
      for (const Tool& tool : tools) {
        for (const double speed : speeds) {
          if (stop()) return kExitFailed;
          const LoopResult r =
              run_loop(scene, assets, is_liver ? kOnLiver : kOnStomach, {tool, speed, rate, 250});
          const auto* ball = std::get_if<scene::SphereShape>(&tool.shape);
          out << fmt::format(
                     "{:<23} {:<6} {:>6} {:7g} {:4g} {:9} {:6} {:6} {:11.3f} {:12.2f} {:7} {:8} "
                     "{:9} {:9} {:8}\n",
                     file.stem().string(), tool.name,
                     ball != nullptr ? fmt::format("{:g}", 1e3 * ball->radius) : "", speed, rate,
                     r.searches, r.inside, r.lost, r.longest_lost, 1e3 * r.deepest, r.presses,
                     r.advances, r.crossings, r.troubles.truncated, r.troubles.unsolved)
              << std::flush;
          ++sum.runs;
          sum.inside += r.inside;
          sum.lost += r.lost;
          sum.troubles += r.troubles;
          sum.presses += tool.is_round() ? r.presses : 0;
          sum.crossings += r.crossings;
        }
      }
    }
  }
  out << fmt::format(
             "{} runs: {} searches inside an organ, {} of them without contact\n{} presses of "
             "round tools: {} times the organ was left with a point of the core inside\n",
             sum.runs, sum.inside, sum.lost, sum.presses, sum.crossings)
      << session::contact_line(sum.troubles) << '\n';
  return sum.lost == 0 && sum.crossings == 0 && sum.troubles.truncated == 0 ? kExitDone
                                                                            : kExitFailed;
}

}  // namespace palpate::contact_loop
