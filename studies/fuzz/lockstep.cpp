#include "studies/fuzz/lockstep.h"

#include <spdlog/fmt/fmt.h>

#include "deformation/models.h"
#include "modules/bus/tap.h"
#include "modules/core/error.h"
#include "palpate/session/in_process.h"
#include "studies/fuzz/faults.h"
#include "studies/fuzz/organ_watch.h"
#include "studies/fuzz/scene_shapes.h"

namespace palpate::fuzz {
namespace {

constexpr double kNodeSteps = 4e5;  // that a scene may cost

double moving_mass(const deformation::Body& body) {
  double sum = 0;
  for (std::size_t i = 0; i < body.node_count(); ++i) {
    if (body.inverse_masses[i] > 0) sum += body.masses[i];
  }
  return sum;
}

class Lockstep {
 public:
  Lockstep(const RandomScene& scene, const ShapeStore& store, deformation::Guarding guarding,
           Outcome& outcome)
      : scene_(scene),
        outcome_(outcome),
        guarding_(guarding),
        session_(scene.scene, assets_of(scene, store), options()) {
    for (std::uint32_t i = 0; i < scene.scene.probes.size(); ++i) {
      session_.haptics().set_device(i, faulty_device(scene, i));
    }
    for (std::size_t i = 0; i < scene.scene.organs.size(); ++i) {
      organs_.emplace_back(session_.surface(i), scene.organ_shapes[i].size.maxCoeff(),
                           moving_mass(session_.world().model(i)), period());
    }
  }

  void run() {
    while (session_.time() < scene_.scene.duration && cost_ < kNodeSteps) {
      outcome_.time = session_.time();
      session_.tick();
      look_at_messages();
      look_at_forces();
      if (advanced_ != session_.world().time()) look_at_organs();
      look_at_contacts();
    }
    if (guarding_ == deformation::Guarding::kOn) return;
    for (const OrganWatch& organ : organs_) organ.look_last();
  }

 private:
  double period() const { return 1 / scene_.scene.rates.deformation; }

  session::InProcessOptions options() {
    session::InProcessOptions options;
    options.guarding = guarding_;
    options.tap = [this](bus::Bus& carrier) {
      auto tapped = std::make_unique<bus::TappedBus>(carrier);
      tap_faults(scene_, *tapped);
      bus_ = tapped.get();
      return tapped;
    };
    return options;
  }

  void count(Guard guard, bool acted = true) {
    outcome_.guards[static_cast<std::size_t>(guard)] += acted;
  }

  /// A probe state may tell of a device's fault, contacts of the organ's they were found on; what
  /// the other messages tell is ours to keep sound.
  void look_at_messages() {
    std::uint64_t refused = 0;
    for (const bus::Input* input : bus_->inputs()) refused += input->statistics().rejected;
    for (const bus::Output* output : bus_->outputs()) {
      const auto& [times, field] = output->statistics();
      const std::string_view topic = output->topic().name;
      if (times > 0 && topic != bus::kProbeState.name && topic != bus::kContacts.name) {
        throw Failure{fmt::format("{} not sound ({}): refused by its writer", topic, field)};
      }
      refused += times;
    }
    count(Guard::kMessageRefused, refused > refused_);
    refused_ = refused;
  }

  void look_at_forces() {
    for (std::size_t i = 0; i < scene_.scene.probes.size(); ++i) {
      const HapticForce& force = session_.haptic_force(i);
      if (force.force.norm() > scene_.scene.haptics.max_force * (1 + 1e-9)) {
        throw Failure{fmt::format("force above limit: {} N", force.force.norm())};
      }
      count(Guard::kForceNotFinite, (force.limits & kForceNotFinite) != 0);
    }
  }

  void look_at_contacts() {
    const ContactTroubles now = session_.contact_troubles();
    count(Guard::kContactsTruncated, now.truncated > troubles_.truncated);
    count(Guard::kContactsLost, now.lost > troubles_.lost);
    count(Guard::kContactsUnsolved, now.unsolved > troubles_.unsolved);
    troubles_ = now;
  }

  void look_at_organs() {
    advanced_ = session_.world().time();
    const deformation::AdvanceReport& report = session_.deformation().report();
    count_guards(report);
    for (std::size_t i = 0; i < organs_.size(); ++i) {
      const NodePositions& nodes = session_.node_positions(i);
      organs_[i].look(nodes, report.diverged);
      cost_ += double(session_.world().substeps(i, period())) * double(nodes.positions.size() / 3) *
               deformation::row_of(scene_.scene.organs[i].model).step_cost;
    }
  }

  void count_guards(const deformation::AdvanceReport& r) {
    if (r.diverged) count(static_cast<Guard>(static_cast<int>(r.reason) - 1));
    count(Guard::kBackToRest, r.back_to_rest);
    count(Guard::kStepReduced, r.step_reduced);
    count(Guard::kPressureCapped, r.pressure_capped);
    count(Guard::kVolumeReleased, r.volume_released);
    count(Guard::kVolumeSkipped, r.volume_skipped);
    count(Guard::kContactsSuspended, r.contacts_suspended);
    count(Guard::kTissueInverted, r.tissue_inverted);
    count(Guard::kMessageRefused, r.contact_refused);
    count(Guard::kProbeJumped, r.probe_jumped);
  }

  const RandomScene& scene_;
  Outcome& outcome_;
  deformation::Guarding guarding_;
  const bus::TappedBus* bus_ = nullptr;  ///< the session's
  session::InProcess session_;
  std::vector<OrganWatch> organs_;
  std::uint64_t refused_ = 0;       ///< messages so far
  ContactTroubles troubles_;        ///< so far
  double advanced_ = 0, cost_ = 0;  ///< simulated [s], in steps of nodes of springs
};

}  // namespace

Outcome run_lockstep(const RandomScene& scene, const ShapeStore& shapes,
                     deformation::Guarding guarding) {
  Outcome outcome;
  bool runs = false;
  try {
    Lockstep lockstep(scene, shapes, guarding, outcome);
    runs = true;
    lockstep.run();
  } catch (const Failure& failure) {
    outcome.ending = Ending::kFailed;
    outcome.what = failure.what;
  } catch (const InputError& error) {
    outcome.ending = runs ? Ending::kFailed : Ending::kRefused;
    outcome.what = (runs ? "input error while running: " : "") + std::string(error.what());
  } catch (const Interrupted&) {
    throw;  // no fault of the scene
  } catch (const std::exception& error) {
    outcome.ending = Ending::kFailed;
    outcome.what = fmt::format("exception: {}", error.what());
  }
  return outcome;
}

}  // namespace palpate::fuzz
