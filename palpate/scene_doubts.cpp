#include "palpate/scene_doubts.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <ostream>

#include "haptics/devices/device.h"
#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/core/units.h"
#include "modules/geometry/bounding_box.h"
#include "modules/scene/key_place.h"
#include "modules/scene/probe_shape.h"
#include "modules/scene/region.h"
#include "modules/trajectories/trajectory_file.h"

namespace palpate::launcher {
namespace {

// From a lymph node to a body; instruments may be as thin as a needle.
constexpr double kSmallestOrgan = 2e-3, kLargestOrgan = 2.0;  // longest side [m]
constexpr double kSmallestTool = 1e-4, kLargestTool = 1.0;
constexpr double kUsualSmallest = 0.02, kUsualLargest = 0.6;
constexpr double kHandReach = 3.0;     // extent of a hand's motion [m]
constexpr double kHandSpeed = 3.0;     // [m/s]
constexpr double kSlowestHand = 1e-4;  // mean speed of a recording that does move [m/s]
constexpr double kLongestLook = 120;   // of a probe's way [s]

std::string length_text(double metres) {
  if (metres >= 1) return fmt::format("{:.3g} m", metres);
  if (metres >= 1e-3) return fmt::format("{:.3g} mm", 1e3 * metres);
  return fmt::format("{:.3g} um", 1e6 * metres);
}

/// The unit in which what is `size` metres long as read in `unit` would have a usual size.
std::string likely_unit(double size, const std::string& unit) {
  const double number = size / metres_per_unit(unit);
  for (const char* other : {"mm", "cm", "m", "um", "in"}) {
    const double length = number * metres_per_unit(other);
    if (other != unit && length >= kUsualSmallest && length <= kUsualLargest) return other;
  }
  return "";
}

/// @throws InputError for a longest side that nothing of its kind has
void check_size(const std::string& owner, const scene::Mesh& mesh, double size, double smallest,
                double largest, UnitIs unit_is = UnitIs::kKey) {
  if (size >= smallest && size <= largest) return;
  const std::string unit = likely_unit(size, mesh.unit);
  std::string said =
      fmt::format("{} is {} long, read in {}; between {} and {} are allowed", owner,
                  length_text(size), mesh.unit, length_text(smallest), length_text(largest));
  if (!unit.empty()) {
    const bool is_key = unit_is == UnitIs::kKey;
    said += fmt::format(". With {}{}{} it would be {}", is_key ? "mesh: {unit: " : "--unit ", unit,
                        is_key ? "}" : "",
                        length_text(size / metres_per_unit(mesh.unit) * metres_per_unit(unit)));
  }
  throw InputError(said);
}

double radius_of(const scene::ProbeShape& shape) {
  if (const auto* sphere = std::get_if<scene::SphereShape>(&shape)) return sphere->radius;
  if (const auto* capsule = std::get_if<scene::CapsuleShape>(&shape)) return capsule->radius;
  return 0;
}

class Doubts {
 public:
  Doubts(const scene::Scene& scene, const std::vector<geometry::TriangleSurface>& skins,
         const trajectories::Progress& progress)
      : scene_(scene), skins_(skins), progress_(progress) {}

  SceneDoubts all() && {
    for (std::size_t i = 0; i < skins_.size(); ++i) organ(scene_.organs[i], skins_[i]);
    for (std::size_t i = 0; i < scene_.probes.size(); ++i) probe(i);
    rates();
    return {std::move(lines_), std::move(motions_)};
  }

 private:
  void rates() {
    const double period = 1 / scene_.rates.deformation;
    if (period < scene_.haptics.stale_after) return;
    say("rates.deformation_hz is {:g}: a force is told every {:g} ms, and after "
        "haptics.stale_after_s, {:g} ms, it fades; raise one of them",
        scene_.rates.deformation, 1e3 * period, 1e3 * scene_.haptics.stale_after);
  }

  void organ(const scene::Organ& organ, const geometry::TriangleSurface& skin) {
    const std::string owner = "organ '" + organ.name + "'";
    const double size = geometry::bounding_box(skin.nodes).sizes().maxCoeff();
    check_organ_size(owner, organ.mesh, size);
    if (size < kUsualSmallest / 2 || size > 2 * kUsualLargest) {
      say("{} is {} long, read in {}: is its mesh in another unit?", owner, length_text(size),
          organ.mesh.unit);
    }
    std::size_t fixed = 0;
    for (std::size_t k = 0; k < organ.fixed.size(); ++k) {
      const auto caught = static_cast<std::size_t>(
          std::count_if(skin.nodes.begin(), skin.nodes.end(),
                        [&](const Vec3& node) { return scene::contains(organ.fixed[k], node); }));
      if (caught == 0) {
        const auto box = geometry::bounding_box(skin.nodes);
        say("{}: fixed[{}] holds no node of its surface, which lies in [{:.3f}, {:.3f}, {:.3f}] to "
            "[{:.3f}, {:.3f}, {:.3f}] m",
            owner, k, box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(),
            box.max().z());
      }
      fixed += caught;
    }
    if (fixed >= skin.nodes.size()) {
      say("{}: all of its surface is fixed; nothing of it can move", owner);
    }
    const bool held = !organ.fixed.empty() || scene_.probes.size() > 1 || scene_.organs.size() > 1;
    if (!held) {
      say("{}: nothing holds it, so the probe pushes it away; fix its back: fixed: [{{box: …}}]",
          owner);
    }
  }

  /// Deformation loads no probe's mesh, and a plane touches everywhere (decision 15).
  void followed(const std::string& owner, const scene::Probe& probe) {
    const bool plane = std::holds_alternative<scene::PlaneShape>(probe.shape);
    if (!plane && scene::mesh_of(probe.shape) == nullptr) return;
    for (const scene::Organ& organ : scene_.organs) {
      if (!organ.solid.refine.follow) continue;
      say("{} is a {}, under which organ '{}' does not refine: solid.refine.follow knows round and "
          "flat shapes; name the place in solid.refine.near",
          owner, plane ? "plane" : "mesh", organ.name);
    }
  }

  void probe(std::size_t index) {
    const scene::Probe& probe = scene_.probes[index];
    const std::string owner = "probe '" + probe.name + "'";
    if (const scene::Mesh* mesh = scene::mesh_of(probe.shape)) {
      const auto surface = scene::load_probe_mesh(probe);
      const double size = geometry::bounding_box(surface.nodes).sizes().maxCoeff();
      check_size(owner, *mesh, size, kSmallestTool, kLargestTool);
      fineness(owner, surface.nodes.size());
    }
    constexpr double kThickestInstrument = 0.1;
    if (radius_of(probe.shape) > kThickestInstrument) {
      say("{} has a radius of {}; is radius_m in metres?", owner,
          length_text(radius_of(probe.shape)));
    }
    followed(owner, probe);
    motions_.push_back(motion_of(scene_, index, skins_, lines_, progress_));
    const collision::Approach& approach = motions_.back().approach;
    if (approach.begins_inside) {
      say("{} begins inside an organ: the nearest wall will push it out; begin outside", owner);
    }
    motion(owner, probe, approach);
  }

  /// What a search costs where a tool of a mesh touches goes with both (docs/contact.md).
  void fineness(const std::string& owner, std::size_t nodes) {
    constexpr std::size_t kMostInTime = 1'000'000;
    for (std::size_t i = 0; i < skins_.size(); ++i) {
      if (nodes * skins_[i].nodes.size() <= kMostInTime) continue;
      say("{} has a mesh of {} nodes, organ '{}' of {}: where they touch, searches take longer "
          "than "
          "real time allows; give it fewer (palpate mesh --nodes) or run in lockstep",
          owner, nodes, scene_.organs[i].name, skins_[i].nodes.size());
    }
  }

  void motion(const std::string& owner, const scene::Probe& probe,
              const collision::Approach& approach) {
    const bool recorded = std::holds_alternative<scene::TrajectoryDevice>(probe.device);
    const bool scripted = std::holds_alternative<scene::ScriptedDevice>(probe.device);
    if (!recorded && !scripted) return;
    if (const auto doubt = doubt_about_extent(owner, approach.extent); !doubt.empty()) {
      say("{} {}", doubt, recorded ? "Then say length_unit: mm" : "They must be metres");
    }
    if (approach.fastest > kHandSpeed) {
      say("{} moves at up to {:.3g} m/s, faster than a hand: are positions in millimetres, or "
          "times too short?{}",
          owner, approach.fastest, recorded ? " See keys length_unit and time_unit" : "");
    } else if (recorded && approach.extent > 0 && approach.duration >= kLongestLook &&
               approach.extent / approach.duration < kSlowestHand && !names_time_unit()) {
      say("{} moves over {} in the first {:g} s: are its times in milliseconds? Then say "
          "time_unit: ms",
          owner, length_text(approach.extent), approach.duration);
    }
    if (!approach.touches_at && !approach.begins_inside) {
      say("{} touches nothing in the first {:g} s: its origin comes no nearer than {} to a "
          "surface, at {:.2f} s",
          owner, approach.duration, length_text(approach.nearest), approach.nearest_at);
    }
  }

  /// As reading a recording does that has hardly a pose a second.
  bool names_time_unit() const {
    return std::ranges::any_of(lines_, [](const std::string& line) {
      return line.find("time_unit: ") != std::string::npos;
    });
  }

  template <class... Values>
  void say(fmt::format_string<Values...> text, Values&&... values) {
    lines_.push_back(fmt::format(text, std::forward<Values>(values)...));
  }

  const scene::Scene& scene_;
  const std::vector<geometry::TriangleSurface>& skins_;
  const trajectories::Progress& progress_;
  std::vector<std::string> lines_;
  std::vector<ProbeMotion> motions_;
};

double duration_of(const scene::Scene& scene) {
  return scene.duration > 0 ? std::min(scene.duration, kLongestLook) : kLongestLook;
}

}  // namespace

ProbeMotion motion_of(const scene::Scene& scene, std::size_t index,
                      const std::vector<geometry::TriangleSurface>& skins,
                      std::vector<std::string>& warnings, const trajectories::Progress& progress) {
  const scene::Probe& probe = scene.probes[index];
  ProbeMotion motion;
  std::unique_ptr<haptics::Device> device;
  if (const auto* recorded = std::get_if<scene::TrajectoryDevice>(&probe.device)) {
    auto poses = trajectories::read_trajectory(*recorded, warnings, progress);
    motion.recording = trajectories::facts_of(poses);
    device = haptics::make_player(*recorded, std::move(poses));
  } else {
    device = haptics::make_device(probe.device, scene.haptics, warnings);
  }
  motion.approach = collision::approach_of(
      scene::form_of(probe.shape, scene::load_probe_mesh(probe)), skins,
      [&](double time) { return device->read(time).pose; }, duration_of(scene));
  return motion;
}

std::string doubt_about_extent(const std::string& owner, double extent) {
  if (!(extent > kHandReach)) return "";
  return fmt::format("{} moves over {}: are its positions in millimetres?", owner,
                     length_text(extent));
}

void check_organ_size(const std::string& owner, const scene::Mesh& mesh, double size, UnitIs said) {
  check_size(owner, mesh, size, kSmallestOrgan, kLargestOrgan, said);
}

SceneDoubts doubts_about(const scene::Scene& scene,
                         const std::vector<geometry::TriangleSurface>& skins,
                         const trajectories::Progress& progress) {
  return Doubts(scene, skins, progress).all();
}

trajectories::Progress progress_on(std::ostream& log) {
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kLineEvery{2};
  return [&log, next = Clock::now() + kLineEvery](double part, std::size_t poses) mutable {
    if (stop_requested()) throw Interrupted("stopped while a recording was read");
    if (Clock::now() < next) return;
    next = Clock::now() + kLineEvery;
    log << fmt::format("recording: {} poses, {:.0f} % of the file", poses, 100 * part) << std::endl;
  };
}

scene::Resampling resampling_on(std::ostream& log) {
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kFirstLine{1}, kLineEvery{2};
  return [&log, next = Clock::now() + kFirstLine](const std::string& owner, double part) mutable {
    if (Clock::now() < next) return;
    next = Clock::now() + kLineEvery;
    log << fmt::format("{}: resampling: {:.0f} %", owner, 100 * part) << std::endl;
  };
}

std::vector<geometry::TriangleSurface> load_skins(const scene::Scene& scene,
                                                  const scene::Resampling& resampling) {
  std::vector<geometry::TriangleSurface> skins;
  for (std::size_t i = 0; i < scene.organs.size(); ++i) {
    skins.push_back(scene::with_organ(
        scene, i, [&](const auto& organ) { return scene::load_skin(organ, resampling); }));
  }
  return skins;
}

}  // namespace palpate::launcher
