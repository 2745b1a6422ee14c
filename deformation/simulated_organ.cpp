#include "deformation/simulated_organ.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "deformation/models.h"
#include "modules/geometry/triangle_surface.h"

namespace palpate::deformation {
namespace {

/// Of what stretches the wall of a ball of this volume by its own length, E t/R.
double pressure_cap(const scene::Tissue& tissue, double rest_volume) {
  const double radius = std::cbrt(3 * rest_volume / (4 * std::numbers::pi));
  return std::max(kLeastPressureCap,
                  kPressureCapOfWall * tissue.youngs_modulus * tissue.wall_thickness / radius);
}

/// Advances between two shortenings for the first to show.
constexpr int kAdvancesToShow = 4;

}  // namespace

SimulatedOrgan::SimulatedOrgan(const scene::Organ& organ, std::unique_ptr<const OrganModel> model,
                               std::unique_ptr<OrganDynamics> dynamics, Guarding guarding,
                               ChunkRunner* runner)
    : model_(std::move(model)),
      dynamics_(std::move(dynamics)),
      target_volume_(organ.filling),
      knows_energy_(row_of(organ.model).knows_energy),
      runner_(runner),
      detector_(std::make_unique<DivergenceDetector>(*model_, knows_energy_, runner)),
      guarding_(guarding),
      holds_volume_(row_of(organ.model).has_volume_constraint),
      pressure_limit_(holds_volume_ ? pressure_cap(organ.tissue, model_->rest_volume)
                                    : std::numeric_limits<double>::infinity()) {
  reset();
}

double SimulatedOrgan::volume() const {
  const VolumeGradient* const found = dynamics_->volume_at(state_.positions);
  return found != nullptr ? found->volume
                          : geometry::enclosed_volume(state_.positions, model_->triangles);
}

int SimulatedOrgan::substeps(double period) const {
  const int needed = std::max(1, static_cast<int>(std::ceil(period / dynamics_->largest_step())));
  return needed << halvings_;
}

void SimulatedOrgan::put(const OrganState& state) {
  state_ = state;
  release_volume();
  detector_->begin(state_, dynamics_->elastic_energy(state_));
  advances_ = kThoroughCheckEvery;
  folded_ = false;
  collapsed_time_ = 0;
}

void SimulatedOrgan::reset() {
  target_volume_.reset();
  state_ = last_good_ = rest_state(*model_);
  detector_->begin(state_, dynamics_->elastic_energy(state_));
  halvings_ = failures_ = advances_ = 0;
  folded_ = false;
  collapsed_time_ = suspension_time_ = gentle_time_ = 0;
  quiet_time_ = kQuietTime;
}

void SimulatedOrgan::exchange(StateArchive& archive) {
  archive.same(model_->node_count());
  archive(target_volume_, *detector_, state_, last_good_, halvings_, failures_, suspension_time_,
          gentle_time_, quiet_time_, folded_, collapsed_time_, advances_);
  for (const OrganState* state : {&state_, &last_good_}) {
    const bool fits = state->positions.size() == model_->node_count() &&
                      state->velocities.size() == model_->node_count();
    if (!fits) throw InputError("its state is of another mesh");
  }
}

void SimulatedOrgan::change_mesh(std::unique_ptr<const OrganModel> model,
                                 std::unique_ptr<OrganDynamics> dynamics, const Carry& carry,
                                 const std::function<void(OrganState&)>& seat) {
  state_ = carry(state_);
  seat(state_);
  last_good_ = carry(last_good_);
  auto detector = std::make_unique<DivergenceDetector>(*model, knows_energy_, runner_);
  detector->take_over(*detector_, state_);
  detector_ = std::move(detector);
  dynamics_ = std::move(dynamics);
  model_ = std::move(model);
}

void SimulatedOrgan::step(double time, double h, std::span<ContactRow> rows,
                          AdvanceReport& report) {
  const double target_before = begin_step(time, h, rows);
  const StepReport stepped = dynamics_->step(h, rows, state_);
  end_step(h, rows, target_before, stepped, report);
}

bool SimulatedOrgan::step(double time, double h, std::vector<ContactRow>& rows,
                          const Revise& revise, bool last_resort, AdvanceReport& report) {
  if (!revise) {
    step(time, h, std::span(rows), report);
    return true;
  }
  start_ = state_;
  started_.keep(rows);
  const TargetVolume target_start = target_volume_;
  const double target_before = begin_step(time, h, rows);
  const double target = state_.target_volume;
  double aim = target;
  const int unsolved_before = report.contacts_unsolved;
  bool is_held = true;
  StepReport stepped = dynamics_->step(h, rows, state_);
  for (int revision = 0;; ++revision) {
    const Missed missed = revise(start_, state_);
    if (missed == Missed::kNothing) break;
    is_held = revision < kMostRevisions && missed != Missed::kDeeper;
    if (!is_held && (last_resort || missed != Missed::kCrossing)) break;
    aim += missed_volume(target, stepped);
    state_ = start_;
    started_.give(rows);
    if (!is_held) {
      target_volume_ = target_start;
      return false;
    }
    state_.target_volume = aim;
    state_.pressure_limit = pressure_limit_;
    push_gently(h, rows);
    stepped = dynamics_->step(h, rows, state_);
  }
  state_.target_volume = target;
  end_step(h, rows, target_before, stepped, report);
  if (!is_held) report.contacts_unsolved = unsolved_before + 1;
  return true;
}

double SimulatedOrgan::begin_step(double time, double h, std::span<ContactRow> rows) {
  const double target_before = state_.target_volume;
  state_.target_volume = model_->rest_volume * target_volume_.follow(time, h);
  state_.pressure_limit = pressure_limit_;
  push_gently(h, rows);
  return target_before;
}

/// What the linearised constraint missed V* by: a step that is taken again aims as much beside it.
double SimulatedOrgan::missed_volume(double asked, const StepReport& stepped) const {
  if (!holds_volume_ || stepped.volume_skipped || stepped.pressure_capped) return 0;
  const double volume = geometry::enclosed_volume(state_.positions, model_->triangles);
  const double most = kMaxVolumeError * model_->rest_volume;
  return std::isfinite(volume) ? std::clamp(asked - volume, -most, most) : 0;
}

void SimulatedOrgan::push_gently(double h, std::span<ContactRow> rows) const {
  if (gentle_time_ <= 0) return;
  for (ContactRow& row : rows) row.gap = std::max(row.gap, -kGentleSpeed * h);
}

void SimulatedOrgan::end_step(double h, std::span<const ContactRow> rows, double target_before,
                              const StepReport& stepped, AdvanceReport& report) {
  detector_->add_work(h, rows, state_.target_volume - target_before, state_);
  report.contacts_unsolved += std::ranges::any_of(rows, [&](const ContactRow& row) {
    return excess_depth(*model_, row, h, state_.velocities) > kUnsolvedDepth;
  });
  if (stepped.volume_skipped) {
    report.volume_skipped = true;
    advances_ = kThoroughCheckEvery;
  }
  const bool collapsed = (stepped.volume_skipped || folded_) && rows.empty();
  collapsed_time_ = collapsed ? collapsed_time_ + h : 0;
  if (!stepped.pressure_capped) return;
  report.pressure_capped = true;
  release_volume();
  advances_ = kThoroughCheckEvery;
}

void SimulatedOrgan::keep(Mark& mark) const {
  mark.state = state_;
  mark.target_volume = target_volume_;
  mark.energy = detector_->ledger();
  mark.collapsed_time = collapsed_time_;
  mark.advances = advances_;
}

void SimulatedOrgan::go_back(const Mark& mark) {
  state_ = mark.state;
  target_volume_ = mark.target_volume;
  detector_->put_back(mark.energy);
  collapsed_time_ = mark.collapsed_time;
  advances_ = mark.advances;
}

void SimulatedOrgan::correct_step(double h, std::span<const Vec3> surface, double volume_impulse,
                                  std::span<const ContactRow> rows) {
  for (std::size_t i = 0; i < surface.size(); ++i) {
    state_.velocities[i] += (surface[i] - state_.positions[i]) / h;
    state_.positions[i] = surface[i];
  }
  state_.pressure -= volume_impulse / h;
  detector_->add_work(0, rows, 0, state_);
}

bool SimulatedOrgan::finish(double period, AdvanceReport& report) {
  if (guarding_ == Guarding::kOff) return true;
  const bool thorough = ++advances_ >= kThoroughCheckEvery;
  Violation seen = thorough ? detector_->check_thoroughly(state_, period, *dynamics_)
                            : detector_->check(state_, period, *dynamics_);
  if (collapsed_time_ > kCollapsedTime) seen = Violation::kCollapsed;
  if (seen != Violation::kNone) {
    recover(seen, report);
    return false;
  }
  if (detector_->suspicious() && quiet_time_ >= kAdvancesToShow * period) shorten_steps();
  lengthen_steps(period);
  report.step_reduced |= halvings_ > 0;
  report.contacts_suspended |= contacts_suspended();
  if (!thorough) return true;
  advances_ = 0;
  const bool far = holds_volume_ && volume_is_far();
  if (far) release_volume();
  report.volume_released |= far;
  const bool inverted =
      model_->is_solid() && inverted_tetrahedra(model_->mesh(), state_.positions) > 0;
  report.tissue_inverted |= inverted;
  folded_ = inverted && !has_rest_volume();
  if (!detector_->suspicious() && !far && !folded_ && collapsed_time_ == 0) last_good_ = state_;
  return true;
}

void SimulatedOrgan::release_volume() {
  const double volume = geometry::enclosed_volume(state_.positions, model_->triangles);
  if (!std::isfinite(volume)) return;
  target_volume_.restart(volume / model_->rest_volume);
  state_.target_volume = volume;
}

bool SimulatedOrgan::volume_is_far() const {
  const double volume = geometry::enclosed_volume(state_.positions, model_->triangles);
  return std::abs(volume - state_.target_volume) > kMaxVolumeError * model_->rest_volume;
}

bool SimulatedOrgan::has_rest_volume() const {
  const double volume = geometry::enclosed_volume(state_.positions, model_->triangles);
  return std::abs(volume / model_->rest_volume - 1) <= kMaxVolumeError;
}

void SimulatedOrgan::recover(Violation reason, AdvanceReport& report) {
  report.diverged = report.step_reduced = true;
  report.reason = reason;
  gentle_time_ = kQuietTime;
  if (++failures_ > kMostFailures) {
    report.back_to_rest = true;
    last_good_ = rest_state(*model_);
    suspension_time_ = kQuietTime;
    gentle_time_ += kQuietTime;
  }
  put(last_good_);
  std::fill(state_.velocities.begin(), state_.velocities.end(), Vec3::Zero());
  state_.pressure = last_good_.pressure;
  shorten_steps();
}

void SimulatedOrgan::shorten_steps() {
  halvings_ = std::min(halvings_ + 1, kMostHalvings);
  quiet_time_ = 0;
}

void SimulatedOrgan::lengthen_steps(double period) {
  suspension_time_ -= period;
  gentle_time_ -= period;
  quiet_time_ += period;
  if (halvings_ == 0 || quiet_time_ < kQuietTime) return;
  --halvings_;
  failures_ = std::max(failures_ - 1, 0);
  quiet_time_ = 0;
}

}  // namespace palpate::deformation
