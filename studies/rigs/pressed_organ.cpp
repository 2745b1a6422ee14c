#include "studies/rigs/pressed_organ.h"

#include <algorithm>
#include <cmath>

#include "deformation/organ_messages.h"
#include "modules/messages/cdr.h"
#include "modules/scene/assets.h"
#include "palpate/session/timed_stage.h"
#include "studies/report/measures.h"

namespace palpate::rigs {
namespace {

constexpr double kCheckEvery = 0.1;    // [s]
constexpr double kForceChange = 2e-4;  // of the force
constexpr double kLeastForce = 1e-3;   // [N]; changes are seen as parts of no less
constexpr double kEnergyShare = 1e-6;
constexpr double kLongestSettling = 3;  // [s]
constexpr int kTimes = 100;             // of what is timed: far above the clock's own

scene::Scene at_one_rate(scene::Scene scene) {
  scene.rates.haptics = scene.rates.collision = scene.rates.deformation;
  return scene;
}

session::Assets assets_of(const scene::Scene& scene, const geometry::OrganShape& shape) {
  return {{shape}, scene::load_probe_meshes(scene)};
}

}  // namespace

PressedOrgan::PressedOrgan(const scene::Scene& scene, const geometry::OrganShape& shape,
                           std::vector<Pose> poses)
    : period_(1 / scene.rates.deformation),
      poses_(std::move(poses)),
      session_(at_one_rate(scene), assets_of(scene, shape), timed()) {
  place_probes();
  first_generation_ = generation();
}

session::InProcessOptions PressedOrgan::timed() {
  session::InProcessOptions options;
  options.make = [this](std::string_view module, bus::Bus& bus, const session::MakeStage& usual) {
    auto stage = usual(bus);
    double& time = module == "deformation" ? busy_ : module == "haptics" ? rendering_ : searching_;
    return std::unique_ptr<runtime::Stage>(
        std::make_unique<session::TimedStage>(std::move(stage), report::processor_time, time));
  };
  return options;
}

/// Where they are is said before the first cycle, so that it moves them from there.
void PressedOrgan::place_probes() {
  auto states = session_.bus().writer(bus::kProbeState);
  for (std::uint32_t i = 0; i < poses_.size(); ++i) {
    auto device = std::make_unique<haptics::PlacedDevice>(poses_[i]);
    devices_.push_back(device.get());
    session_.haptics().set_device(i, std::move(device));
    ProbeState state;
    state.probe = i;
    state.pose = poses_[i];
    states.write(state);
  }
}

void PressedOrgan::advance(const std::vector<Pose>& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Vec3 velocity = (poses[i].position - poses_[i].position) / period_;
    devices_[i]->place(poses[i], {velocity, Vec3::Zero()});
  }
  poses_ = poses;
  session_.tick();
  diverged_ |= session_.deformation().report().diverged;
  const NodePositions& organ = session_.node_positions(0);
  volume_error_ = std::max(volume_error_, std::abs(organ.volume / organ.target_volume - 1));
}

void PressedOrgan::move_and_settle(const std::vector<Vec3>& to, double speed,
                                   const std::function<void()>& keep_going) {
  double longest = 0;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    longest = std::max(longest, (to[i] - poses_[i].position).norm());
  }
  const int steps = std::max(1, static_cast<int>(std::ceil(longest / (speed * period_))));
  const std::vector<Pose> from = poses_;
  std::vector<Pose> poses = poses_;
  for (int k = 1; k <= steps; ++k) {
    keep_going();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses[i].position = from[i].position + double(k) / steps * (to[i] - from[i].position);
    }
    advance(poses);
  }
  settle(kLongestSettling, keep_going);
}

void PressedOrgan::settle(double longest, const std::function<void()>& keep_going) {
  const std::vector<Pose> poses = poses_;
  const int steps = std::max(1, static_cast<int>(std::lround(kCheckEvery / period_)));
  std::vector<double> last(poses.size(), -1);
  for (double waited = 0; waited < longest; waited += steps * period_) {
    for (int i = 0; i < steps; ++i) {
      keep_going();
      advance(poses);
    }
    const NodePositions& organ = session_.node_positions(0);
    bool still = organ.kinetic_energy <= kEnergyShare * organ.elastic_energy;
    for (std::uint32_t i = 0; i < poses.size(); ++i) {
      const double now = force(i).norm();
      still &= std::abs(now - last[i]) <= kForceChange * std::max(now, kLeastForce);
      last[i] = now;
    }
    if (still) return;
  }
}

geometry::TriangleSurface PressedOrgan::skin() const {
  geometry::TriangleSurface skin;
  const auto& nodes = model().rest_positions;
  skin.nodes.assign(nodes.begin(),
                    nodes.begin() + static_cast<std::ptrdiff_t>(model().surface_node_count));
  skin.triangles = model().triangles;
  return skin;
}

double PressedOrgan::encoding_of_mesh() const {
  std::vector<std::uint8_t> bytes;
  const auto mesh = deformation::surface_message(session_.world(), 0);
  const double begin = report::processor_time();
  for (int i = 0; i < kTimes; ++i) messages::write_payload(mesh, bytes);
  return (report::processor_time() - begin) / kTimes;
}

double PressedOrgan::encoding() const {
  std::vector<std::uint8_t> bytes;
  const double begin = report::processor_time();
  for (int i = 0; i < kTimes; ++i) {
    messages::write_payload(session_.node_positions(0), bytes);
    for (std::size_t probe = 0; probe < poses_.size(); ++probe) {
      messages::write_payload(session_.contacts(probe), bytes);
      messages::write_payload(session_.contact_model(probe), bytes);
    }
  }
  return (report::processor_time() - begin) / kTimes;
}

Vec3 PressedOrgan::force(std::uint32_t probe) const { return session_.world().force(probe); }

Vec3 PressedOrgan::position(std::size_t node) const { return session_.world().positions(0)[node]; }

Vec3 PressedOrgan::rest_position(std::size_t node) const { return model().rest_positions[node]; }

}  // namespace palpate::rigs
