#include "studies/fuzz/lockstep.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "collision/contact_finder.h"
#include "collision/contact_margin.h"
#include "deformation/organ_messages.h"
#include "deformation/world.h"
#include "haptics/device.h"
#include "haptics/haptic_renderer.h"
#include "modules/core/error.h"
#include "modules/core/units.h"
#include "studies/fuzz/faults.h"
#include "studies/fuzz/organ_watch.h"
#include "studies/fuzz/scene_shapes.h"

namespace palpate::fuzz {
namespace {

constexpr double kNodeSteps = 4e5;  // that a scene may cost

/// Of a node's step, over one of springs; measured, to one digit.
double cost_of(scene::Model model) {
  if (model == scene::Model::kQuadraticElements) return 3000;
  if (model >= scene::Model::kCorotational) return 100;
  if (model == scene::Model::kXpbdTetrahedra) return 10;
  return model == scene::Model::kElementVolume ? 5 : 1;
}

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

class Lockstep {
 public:
  Lockstep(const RandomScene& scene, std::vector<geometry::OrganShape> shapes,
           const ShapeStore& store, deformation::Guarding guarding, Outcome& outcome)
      : scene_(scene),
        outcome_(outcome),
        faults_(scene.faults),
        finder_(triangles_of(shapes), probe_geometry(scene, store)),
        world_(scene.scene, std::move(shapes), nullptr, guarding),
        guarding_(guarding) {
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
    for (std::size_t i = 0; i < world_.organ_count(); ++i) {
      organs_.emplace_back(world_, i, scene.organ_shapes[i].size.maxCoeff(), period());
    }
  }

  void run() {
    Clock haptics(scene_.scene.rates.haptics), collision(scene_.scene.rates.collision),
        deformation(scene_.scene.rates.deformation);
    for (std::int64_t now = 0; seconds_from_ns(now) < scene_.scene.duration && cost_ < kNodeSteps;
         now = haptics.next_ns) {
      time_ = outcome_.time = seconds_from_ns(now);
      haptics.take(now);
      take_faults();
      for (std::uint32_t i = 0; i < probes_.size(); ++i) tick(i);
      if (collision.take(now)) search();
      if (deformation.take(now)) advance();
    }
    if (guarding_ == deformation::Guarding::kOn) return;
    for (const OrganWatch& organ : organs_) organ.look_last();
  }

 private:
  double period() const { return 1 / scene_.scene.rates.deformation; }

  void count(Guard guard, bool acted = true) {
    outcome_.guards[static_cast<std::size_t>(guard)] += acted;
  }

  /// Those due by now go to the messages of this tick; of slower modules, to the next ones.
  void take_faults() {
    for (const TimedFault& fault : faults_) {
      if (fault.time <= time_) pending_.push_back(fault);
    }
    std::erase_if(faults_, [&](const TimedFault& fault) { return fault.time <= time_; });
  }

  template <class Message>
  bool passes(std::uint32_t probe, Message& message) {
    for (const TimedFault& timed : pending_) {
      if (timed.probe == probe) corrupt(timed.fault, message);
    }
    const bool refused = refusal(message) != nullptr;
    count(Guard::kMessageRefused, refused);
    return !refused;
  }

  void tick(std::uint32_t i) {
    ProbeRun& probe = probes_[i];
    haptics::DeviceSample sample = probe.device->read(time_);
    for (const TimedFault& timed : pending_) {
      if (timed.probe != i || timed.fault != Fault::kDeviceNotANumber) continue;
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
    for (std::size_t i = 0; i < organs_.size(); ++i) finder_.update_organ(i, organs_[i].seen());
    for (std::uint32_t i = 0; i < probes_.size(); ++i) {
      if (!is_known(i)) continue;
      ProbeRun& probe = probes_[i];
      const Pose& pose = probe.known.pose;
      const collision::ProbeMotion motion{probe.was_searched ? probe.searched : pose, pose};
      const double speed = probe.known.twist.linear.norm();
      finder_.find(i, motion, collision::contact_margin(scene_.scene.rates, speed),
                   kMaxContactsPerProbe, probe.contacts);
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
      if (is_known(i)) world_.set_probe(probes_[i].known.probe, probes_[i].known.pose);
    }
    for (std::size_t i = 0; i < organs_.size(); ++i) {
      cost_ += double(world_.substeps(i, period())) * double(organs_[i].seen().size()) *
               cost_of(scene_.scene.organs[i].model);
    }
    const deformation::AdvanceReport report = world_.advance(period());
    count_guards(report);
    for (OrganWatch& organ : organs_) organ.look(report.diverged);
    for (std::uint32_t i = 0; i < probes_.size(); ++i) publish_model(i);
    pending_.clear();
  }

  void publish_model(std::uint32_t i) {
    ProbeRun& probe = probes_[i];
    probe.model = deformation::contact_model_message(world_, i);
    if (const char* field = refusal(probe.model)) {
      throw Failure{fmt::format("contact model not sound ({}): of probe {}", field, i)};
    }
    ContactModel message = probe.model;
    if (passes(i, message)) probe.renderer.update_law(message, time_);
    count(Guard::kModelRefused, probe.renderer.refused_laws() > 0);
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
    count(Guard::kMessageRefused, r.contact_refused);
    count(Guard::kProbeJumped, r.probe_jumped);
  }

  const RandomScene& scene_;
  Outcome& outcome_;
  std::vector<TimedFault> faults_, pending_;
  collision::ContactFinder finder_;
  deformation::DeformationWorld world_;
  deformation::Guarding guarding_;
  std::vector<OrganWatch> organs_;
  std::vector<ProbeRun> probes_;
  std::uint64_t known_ = 0;  ///< bit i: a pose of probe i has come
  double time_ = 0, cost_ = 0;
};

}  // namespace

Outcome run_lockstep(const RandomScene& scene, const ShapeStore& shapes,
                     deformation::Guarding guarding) {
  Outcome outcome;
  bool runs = false;
  try {
    Lockstep lockstep(scene, shapes_in_world(scene, shapes), shapes, guarding, outcome);
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
