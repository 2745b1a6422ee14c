#include "bench/fuzz/lockstep.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "bench/fuzz/insults.h"
#include "collision/contact_finder.h"
#include "collision/contact_margin.h"
#include "deformation/deformation_world.h"
#include "haptics/device.h"
#include "haptics/haptic_renderer.h"
#include "modules/core/error.h"
#include "modules/core/units.h"

namespace palpate::fuzz {
namespace {

constexpr double kNodeSteps = 4e5;  // that a scene may cost
constexpr double kFarthest = 1000;  // [m]

/// Of a node's step, over one of springs; measured, to one digit.
double cost_of(scene::Model model) {
  if (model == scene::Model::kQuadraticElements) return 3000;
  if (model >= scene::Model::kCorotational) return 100;
  if (model == scene::Model::kXpbdTetrahedra) return 10;
  return model == scene::Model::kElementVolume ? 5 : 1;
}

/// A failure found in a message.
struct Failure {
  std::string what;
};

struct Clock {
  std::int64_t period_ns, next_ns = 0;
  explicit Clock(double rate_hz) : period_ns(ns_from_seconds(1 / rate_hz)) {}
  bool take(std::int64_t now_ns) {
    if (now_ns < next_ns) return false;
    next_ns += period_ns;
    return true;
  }
};

struct ProbeRun {
  std::unique_ptr<haptics::Device> device;
  haptics::HapticRenderer renderer;
  ProbeState sent, known;  ///< by haptics; to the others, who refuse what cannot be
  Pose searched;
  bool was_searched = false;
  Contacts contacts;
  ContactModel model;
  HapticForce force;
};

struct OrganRun {
  NodePositions nodes;
  std::vector<float> last;
  std::vector<Vec3> seen;
  double away = 0;  ///< largest way from rest when last looked at [m]
};

std::vector<geometry::OrganShape> shapes_in_world(const RandomScene& scene,
                                                  const ShapeStore& store) {
  std::vector<geometry::OrganShape> shapes;
  for (std::size_t i = 0; i < scene.organ_shapes.size(); ++i) {
    const scene::Organ& organ = scene.scene.organs[i];
    shapes.push_back(store.shape(scene.organ_shapes[i], organ.model));
    for (auto* nodes : {&shapes[i].surface.nodes, &shapes[i].inner_nodes}) {
      for (Vec3& node : *nodes) node = organ.pose.to_world(node);
    }
  }
  return shapes;
}

std::vector<std::vector<geometry::Triangle>> triangles_of(
    const std::vector<geometry::OrganShape>& shapes) {
  std::vector<std::vector<geometry::Triangle>> triangles;
  for (const auto& shape : shapes) triangles.push_back(shape.surface.triangles);
  return triangles;
}

std::vector<collision::ProbeGeometry> probe_geometry(const RandomScene& scene,
                                                     const ShapeStore& store) {
  std::vector<collision::ProbeGeometry> geometry;
  for (std::size_t i = 0; i < scene.scene.probes.size(); ++i) {
    const auto& shape = scene.scene.probes[i].shape;
    geometry.push_back({shape, {}});
    if (!std::holds_alternative<scene::MeshShape>(shape)) continue;
    geometry.back().mesh = store.shape(scene.probe_shapes[i], scene::Model::kMassSpring).surface;
  }
  return geometry;
}

class Lockstep {
 public:
  Lockstep(const RandomScene& scene, std::vector<geometry::OrganShape> shapes,
           const ShapeStore& store, Outcome& outcome)
      : scene_(scene),
        outcome_(outcome),
        insults_(scene.insults),
        finder_(triangles_of(shapes), probe_geometry(scene, store)),
        world_(scene.scene, std::move(shapes)),
        organs_(world_.organ_count()) {
    std::vector<std::string> warnings;
    const scene::Scene& s = scene.scene;
    for (const auto& probe : s.probes) {
      probes_.push_back({haptics::make_device(probe.device, warnings),
                         haptics::HapticRenderer(s.haptics, 1 / s.rates.haptics),
                         {},
                         {},
                         {},
                         false,
                         {},
                         {},
                         {}});
    }
    publish_nodes({});
  }

  void run() {
    Clock haptics(scene_.scene.rates.haptics), collision(scene_.scene.rates.collision),
        deformation(scene_.scene.rates.deformation);
    for (std::int64_t now = 0; seconds_from_ns(now) < scene_.scene.duration && cost_ < kNodeSteps;
         now = haptics.next_ns) {
      time_ = outcome_.time = seconds_from_ns(now);
      haptics.take(now);
      take_insults();
      for (std::uint32_t i = 0; i < probes_.size(); ++i) tick(i);
      if (collision.take(now)) search();
      if (deformation.take(now)) advance();
    }
  }

 private:
  void count(Guard guard, bool acted = true) {
    outcome_.guards[static_cast<std::size_t>(guard)] += acted;
  }

  /// Those due by now go to the messages of this tick; of slower modules, to the next ones.
  void take_insults() {
    for (const TimedInsult& insult : insults_) {
      if (insult.time <= time_) pending_.push_back(insult);
    }
    std::erase_if(insults_, [&](const TimedInsult& insult) { return insult.time <= time_; });
  }

  template <class Message>
  bool passes(std::uint32_t probe, Message& message) {
    for (const TimedInsult& timed : pending_) {
      if (timed.probe == probe) spoil(timed.insult, message);
    }
    const bool refused = refusal(message) != nullptr;
    count(Guard::kMessageRefused, refused);
    return !refused;
  }

  void tick(std::uint32_t i) {
    ProbeRun& probe = probes_[i];
    haptics::DeviceSample sample = probe.device->read(time_);
    for (const TimedInsult& timed : pending_) {
      if (timed.probe != i || timed.insult != Insult::kDeviceNotANumber) continue;
      sample.pose.position.x() = sample.twist.linear.y() = std::nan("");
    }
    probe.renderer.tick(time_, sample, probe.force);
    const scene::Haptics& limits = scene_.scene.haptics;
    if (refusal(probe.force) != nullptr) throw Failure{"force not finite: haptic force"};
    if (probe.force.force.norm() > limits.max_force * (1 + 1e-9)) {
      throw Failure{fmt::format("force above limit: {} N", probe.force.force.norm())};
    }
    probe.sent.probe = i;
    probe.sent.pose = sample.pose;
    probe.sent.twist = sample.twist;
    ProbeState message = probe.sent;
    if (!passes(i, message)) return;
    probe.known = message;
    known_ |= std::uint64_t{1} << i;
  }

  bool is_known(std::uint32_t i) const { return (known_ >> i & 1) != 0; }

  void search() {
    for (std::size_t i = 0; i < organs_.size(); ++i) finder_.update_organ(i, organs_[i].seen);
    for (std::uint32_t i = 0; i < probes_.size(); ++i) {
      if (!is_known(i)) continue;
      ProbeRun& probe = probes_[i];
      const Pose& pose = probe.known.pose;
      const collision::ProbeMotion motion{probe.was_searched ? probe.searched : pose, pose};
      const double speed = probe.known.twist.linear.norm();
      finder_.find(i, motion, collision::contact_margin(scene_.scene.rates, speed), probe.contacts);
      probe.contacts.probe = i;
      probe.contacts.probe_pose = pose;
      probe.searched = pose;
      probe.was_searched = true;
      if (refusal(probe.contacts) != nullptr) count(Guard::kMessageRefused);
      Contacts message = probe.contacts;
      if (passes(i, message)) world_.set_contacts(message);
    }
  }

  void advance() {
    for (std::uint32_t i = 0; i < probes_.size(); ++i) {
      if (is_known(i)) world_.set_probe(probes_[i].known);
    }
    const double period = 1 / scene_.scene.rates.deformation;
    for (std::size_t i = 0; i < organs_.size(); ++i) {
      cost_ += double(world_.substeps(i, period)) * double(organs_[i].seen.size()) *
               cost_of(scene_.scene.organs[i].model);
    }
    const deformation::AdvanceReport report = world_.advance(period);
    count_guards(report);
    publish_nodes(report);
    for (std::uint32_t i = 0; i < probes_.size(); ++i) publish_model(i);
    pending_.clear();
  }

  void publish_model(std::uint32_t i) {
    ProbeRun& probe = probes_[i];
    world_.write_contact_model(i, probe.model);
    if (const char* field = refusal(probe.model)) {
      throw Failure{fmt::format("contact model not sound ({}): of probe {}", field, i)};
    }
    ContactModel message = probe.model;
    if (passes(i, message)) probe.renderer.update_model(message, time_);
    count(Guard::kModelRefused, probe.renderer.refused_models() > 0);
  }

  void publish_nodes(const deformation::AdvanceReport& report) {
    for (std::size_t i = 0; i < organs_.size(); ++i) {
      OrganRun& organ = organs_[i];
      organ.last = organ.nodes.positions;
      world_.write_node_positions(i, organ.nodes);
      if (const char* field = refusal(organ.nodes)) {
        throw Failure{
            fmt::format("node positions not sound ({}): of organ {}, energies {} J and {} J", field,
                        i, organ.nodes.kinetic_energy, organ.nodes.elastic_energy)};
      }
      const auto& xyz = organ.nodes.positions;
      organ.seen.resize(xyz.size() / 3);
      for (std::size_t n = 0; n < organ.seen.size(); ++n) {
        organ.seen[n] = Eigen::Map<const Eigen::Vector3f>(&xyz[3 * n]).cast<double>();
      }
      look(i, report.diverged);
    }
  }

  /// Far nodes, fast ones, and an organ that is back at rest without a word.
  void look(std::size_t index, bool replaced) {
    OrganRun& organ = organs_[index];
    const auto& rest = world_.topology(index).rest_positions;
    double fastest = 0, farthest = 0, away = 0;
    for (std::size_t n = 0; n < organ.seen.size(); ++n) {
      const auto at = [n](const std::vector<float>& xyz) -> Vec3 {
        return Eigen::Map<const Eigen::Vector3f>(&xyz[3 * n]).cast<double>();
      };
      farthest = std::max(farthest, organ.seen[n].norm());
      away = std::max(away, (organ.seen[n] - at(rest)).norm());
      if (!organ.last.empty()) fastest = std::max(fastest, (organ.seen[n] - at(organ.last)).norm());
    }
    const double size = scene_.organ_shapes[index].size.maxCoeff();
    const double way = deformation::kMaxNodeSpeed / scene_.scene.rates.deformation + 0.1 * size;
    if (farthest > kFarthest) throw Failure{fmt::format("node far away: {} m", farthest)};
    if (!replaced && fastest > way) {
      throw Failure{fmt::format("node too fast: {} m in a period of {} s", fastest,
                                1 / scene_.scene.rates.deformation)};
    }
    if (!replaced && away == 0 && organ.away > 0.01 * size) throw Failure{"silent reset: organ"};
    organ.away = away;
  }

  void count_guards(const deformation::AdvanceReport& r) {
    if (r.diverged) count(static_cast<Guard>(static_cast<int>(r.reason) - 1));
    count(Guard::kBackToRest, r.back_to_rest);
    count(Guard::kStepReduced, r.step_reduced);
    count(Guard::kPressureCapped, r.pressure_capped);
    count(Guard::kVolumeReleased, r.volume_released);
    count(Guard::kVolumeSkipped, r.volume_skipped);
    count(Guard::kContactsIgnored, r.contacts_ignored);
    count(Guard::kTissueInverted, r.tissue_inverted);
    count(Guard::kProbeJumped, r.probe_jumped);
  }

  const RandomScene& scene_;
  Outcome& outcome_;
  std::vector<TimedInsult> insults_, pending_;
  collision::ContactFinder finder_;
  deformation::DeformationWorld world_;
  std::vector<OrganRun> organs_;
  std::vector<ProbeRun> probes_;
  std::uint64_t known_ = 0;  ///< bit i: a pose of probe i has come
  double time_ = 0, cost_ = 0;
};

}  // namespace

Outcome run_lockstep(const RandomScene& scene, const ShapeStore& shapes) {
  Outcome outcome;
  bool runs = false;
  try {
    Lockstep lockstep(scene, shapes_in_world(scene, shapes), shapes, outcome);
    runs = true;
    lockstep.run();
  } catch (const Failure& failure) {
    outcome.ending = Ending::kFailed;
    outcome.what = failure.what;
  } catch (const InputError& error) {
    outcome.ending = runs ? Ending::kFailed : Ending::kRefused;
    outcome.what = (runs ? "input error while running: " : "") + std::string(error.what());
  } catch (const std::exception& error) {
    outcome.ending = Ending::kFailed;
    outcome.what = fmt::format("exception: {}", error.what());
  }
  return outcome;
}

}  // namespace palpate::fuzz
