#include "deformation/organ_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "deformation/models.h"
#include "modules/core/error.h"
#include "modules/scene/key_place.h"

namespace palpate::deformation {
namespace {

/// Pairs are looked for within this part of the mean edge, so that a search lasts some steps.
constexpr double kReachOfEdge = 0.5;
/// What was looked for within more than so many times what is wanted now is looked for anew: all
/// pairs within it are looked at in every step.
constexpr double kMostReach = 4;
/// Tries of a step, each with pairs looked for further around.
constexpr int kMostTries = 3;

std::vector<std::vector<geometry::Triangle>> triangles_of(
    const std::vector<SimulatedOrgan*>& organs) {
  std::vector<std::vector<geometry::Triangle>> triangles;
  for (const SimulatedOrgan* organ : organs) triangles.push_back(organ->model().triangles);
  return triangles;
}

std::span<const Vec3> surface_of(const SimulatedOrgan& organ) {
  return std::span(organ.state().positions).first(organ.model().surface_node_count);
}

using Surfaces = std::vector<std::span<const Vec3>>;

Surfaces spans_of(const std::vector<std::vector<Vec3>>& surfaces) {
  return {surfaces.begin(), surfaces.end()};
}

/// How far all surfaces have come together, node for node.
Vec3 mean_way(const Surfaces& from, const Surfaces& to) {
  Vec3 sum = Vec3::Zero();
  std::size_t count = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    for (std::size_t k = 0; k < from[i].size(); ++k) sum += to[i][k] - from[i][k];
    count += from[i].size();
  }
  return sum / static_cast<double>(std::max<std::size_t>(count, 1));
}

/// How far the farthest node goes beside that.
double farthest_way(const Surfaces& from, const Surfaces& to) {
  const Vec3 together = mean_way(from, to);
  double farthest = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    farthest = std::max(farthest, farthest_travel(from[i], to[i], together));
  }
  return farthest;
}

}  // namespace

OrganContacts::OrganContacts(const scene::Scene& scene, std::vector<SimulatedOrgan*> organs)
    : friction_(scene.contacts.friction),
      organs_(std::move(organs)),
      features_(triangles_of(organs_), {scene.contacts.organs, scene.contacts.self}),
      start_(organs_.size()),
      asked_(organs_.size()),
      end_(organs_.size()),
      travel_(organs_.size()),
      touched_(organs_.size()),
      volumes_(organs_.size()) {
  const scene::Misfit misfit = scene::misfit_of_contacts(scene);
  if (!misfit.none()) {
    throw scene::error_at(scene, misfit.key, "key '" + misfit.key + "' " + misfit.why);
  }
  least_reach_ = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    const OrganModel& model = organs_[i]->model();
    const auto nodes = surface_of(*organs_[i]);
    const geometry::TriangleSurface rest{{nodes.begin(), nodes.end()}, model.triangles};
    least_reach_ = std::min(least_reach_, kReachOfEdge * geometry::mean_edge_length(rest));
    touched_[i].body = &model;
    const bool keeps_volume = row_of(scene.organs[i].model).volume == VolumeKeeping::kExactly;
    if (keeps_volume && !model.is_solid()) touched_[i].volume = &volumes_[i];
  }
  begin_step();
  refuse_crossed_rest(scene);
}

void OrganContacts::refuse_crossed_rest(const scene::Scene& scene) {
  search(kLeastRestDistance);
  auto touching = features_.first_crossing();
  if (!touching && !features_.pairs().empty()) touching = features_.pairs()[0].pair.surfaces;
  reset();
  if (!touching) return;
  const auto& [a, b] = *touching;
  std::ostringstream message;
  const std::string key = std::string("contacts.") + (a == b ? "self" : "organs");
  message << "key '" << key << "': ";
  if (a == b) {
    message << "organ '" << scene.organs[a].name << "' passes through itself or touches itself";
  } else {
    message << "organs '" << scene.organs[a].name << "' and '" << scene.organs[b].name
            << "' cross or touch";
  }
  message << " at rest, where they must be " << kLeastRestDistance << " m apart at least";
  throw scene::error_at(scene, key, message.str());
}

void OrganContacts::reset() {
  last_.clear();
  reach_ = 0;
}

/// Pairs are found again where they were looked for.
void OrganContacts::exchange(StateArchive& archive) {
  archive(last_, reach_);
  if (!(reach_ > 0)) return;
  std::vector<std::vector<Vec3>> searched(organs_.size());
  std::vector<std::span<const Vec3>> positions;
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    searched[i].assign(features_.positions(i).begin(), features_.positions(i).end());
    archive(searched[i]);
    if (searched[i].size() != organs_[i]->model().surface_node_count) {
      throw InputError("its state is of another mesh");
    }
    positions.emplace_back(searched[i]);
  }
  if (archive.reads()) features_.search(positions, reach_);
}

void OrganContacts::begin_step() {
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    const auto surface = surface_of(*organs_[i]);
    start_[i].assign(surface.begin(), surface.end());
  }
}

void OrganContacts::search(double reach) {
  features_.search(spans_of(start_), reach);
  reach_ = reach;
}

bool OrganContacts::are_crossed() {
  begin_step();
  search(0);
  reset();
  return features_.first_crossing().has_value();
}

/// How far the surfaces are, at either end of the step, from where pairs were looked for and what
/// they have come together since, and `spare` more: no pair comes nearer by that.
/// @returns whether no pair that may meet is missing
bool OrganContacts::measure_travel(double spare) {
  if (reach_ == 0) return false;
  Surfaces searched;
  for (std::size_t i = 0; i < organs_.size(); ++i) searched.push_back(features_.positions(i));
  const Vec3 to_start = mean_way(searched, spans_of(start_));
  together_ = mean_way(searched, spans_of(asked_));
  double farthest = 0;
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    travel_[i] = spare + std::max(farthest_travel(searched[i], start_[i], to_start),
                                  farthest_travel(searched[i], asked_[i], together_));
    farthest = std::max(farthest, travel_[i]);
  }
  return 2 * (farthest + kRestGap) <= reach_;
}

void OrganContacts::collect_pairs() {
  pairs_.clear();
  for (const collision::NearPair& near : features_.pairs()) {
    const auto& [a, b] = near.pair.surfaces;
    if (near.distance > travel_[a] + travel_[b] + 2 * kRestGap) continue;
    StepPair step{near.pair, {}, {}};
    for (std::size_t k = 0; k < step.start.size(); ++k) {
      step.start[k] = start_[near.pair.surface_of(k)][near.pair.nodes[k]];
    }
    step.separation = collision::separation_of(near.pair.is_edges, step.start);
    pairs_.push_back(step);
  }
}

double OrganContacts::rest_gap(const StepPair& step) const {
  const auto& pair = step.pair;
  if (pair.surfaces[0] != pair.surfaces[1]) return kRestGap;
  const auto& rest = organs_[pair.surfaces[0]]->model().rest_positions;
  collision::FourPoints x;
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = rest[pair.nodes[k]];
  return std::min(kRestGap, collision::separation_of(pair.is_edges, x).distance / 2);
}

/// Rows of the pairs that are, or come, within twice their rest gap.
void OrganContacts::make_rows(double h) {
  rows_.clear();
  for (const StepPair& step : pairs_) {
    if (step.separation.distance == 0) continue;
    double coming = 0;
    for (std::size_t k = 0; k < step.start.size(); ++k) {
      const double sign = k < step.pair.first_count() ? -1 : 1;
      const TouchedOrgan& organ = touched_[step.pair.surface_of(k)];
      coming += sign * step.separation.weights[k] *
                step.separation.direction.dot(organ.velocities[step.pair.nodes[k]]);
    }
    if (step.separation.distance + h * std::min(coming, 0.0) > 2 * kRestGap) continue;
    rows_.push_back(row_between(step, rest_gap(step), friction_, h));
  }
  keep_each_once(rows_);
  organ_rows_ = rows_.size();
}

void OrganContacts::append_probe_rows(double h) {
  for (std::uint32_t i = 0; i < probe_rows_.size(); ++i) {
    for (const ContactRow& contact : probe_rows_[i]) rows_.push_back(row_of_probe(i, contact, h));
  }
}

void OrganContacts::start_from_last() {
  auto last = last_.begin();
  for (OrganContactRow& row : rows_) {
    const ContactKey key = key_of(row);
    while (last != last_.end() && last->key < key) ++last;
    if (last == last_.end()) return;
    if (last->key != key) continue;
    row.normal_impulse = last->normal_impulse;
    row.tangential_impulse = last->tangential_impulse;
  }
}

/// Velocities over the step, contacts, and where they lead.
OrganContactReport OrganContacts::solve(double h) {
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    TouchedOrgan& organ = touched_[i];
    organ.volume_impulse = 0;
    organ.velocities.resize(organ.body->node_count(), Vec3::Zero());
    for (std::size_t k = 0; k < start_[i].size(); ++k) {
      organ.velocities[k] = (asked_[i][k] - start_[i][k]) / h;
    }
  }
  make_rows(h);
  end_ = asked_;
  if (rows_.empty()) return {};
  start_from_last();
  append_probe_rows(h);
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    if (touched_[i].volume != nullptr) {
      evaluate_volume(*touched_[i].body, organs_[i]->state().positions, volumes_[i]);
    }
  }
  const OrganContactReport report = solve_organ_contacts(rows_, touched_);
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    for (std::size_t k = 0; k < start_[i].size(); ++k) {
      const Vec3 asked = (asked_[i][k] - start_[i][k]) / h;
      end_[i][k] += h * (touched_[i].velocities[k] - asked);
    }
  }
  return report;
}

Confinement OrganContacts::try_step(double h, double step, double spare,
                                    OrganContactReport& solved) {
  const double wanted = std::max(least_reach_, 4 * (step + spare + kRestGap));
  // What was looked for in a hurry may be all there is: organs at rest would never look anew.
  if (!measure_travel(spare) || reach_ > kMostReach * wanted) {
    search(wanted);
    if (!measure_travel(spare)) return Confinement::kIncomplete;
  }
  collect_pairs();
  solved = solve(h);
  std::vector<MovingSurface> surfaces;
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    surfaces.push_back(
        {touched_[i].body, features_.positions(i), start_[i], end_[i], together_, travel_[i]});
  }
  return confine_motion(pairs_, surfaces);
}

void OrganContacts::end_step(double h, std::span<const std::span<ContactRow>> probe_rows,
                             AdvanceReport& report) {
  probe_rows_ = probe_rows;
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    const auto surface = surface_of(*organs_[i]);
    asked_[i].assign(surface.begin(), surface.end());
  }
  const double step = farthest_way(spans_of(start_), spans_of(asked_));
  if (!std::isfinite(step)) return reset();  // the organ's own guard replaces its state
  OrganContactReport solved;
  Confinement confined = Confinement::kIncomplete;
  double spare = kRestGap + step / 2;
  for (int k = 0; k < kMostTries && confined == Confinement::kIncomplete; ++k, spare *= 4) {
    confined = try_step(h, step, spare, solved);
  }
  if (confined == Confinement::kIncomplete) {
    end_ = start_;
    confined = Confinement::kHeld;
  }
  if (confined == Confinement::kHeld) {
    rows_.clear();
    organ_rows_ = 0;
    for (TouchedOrgan& organ : touched_) organ.volume_impulse = 0;
  }
  report.organ_motion_cut |= confined == Confinement::kHeld;
  report.organ_contacts_unsolved |= !solved.converged;
  remember();
  hand_over(h);
}

std::size_t OrganContacts::count(std::size_t organ) const {
  return static_cast<std::size_t>(
      std::count_if(last_.begin(), last_.end(), [&](const Remembered& contact) {
        return contact.key[0] == organ || contact.key[4] == organ;
      }));
}

void OrganContacts::remember() {
  last_.clear();
  for (std::size_t r = 0; r < organ_rows_; ++r) {
    const OrganContactRow& row = rows_[r];
    if (row.normal_impulse <= 0) continue;
    last_.push_back({key_of(row), row.normal_impulse, row.tangential_impulse});
  }
}

/// What acts on one organ, each other surface as a probe.
void OrganContacts::append_halves(std::uint32_t organ) {
  halves_.clear();
  for (std::size_t r = 0; r < organ_rows_; ++r) {
    const OrganContactRow& row = rows_[r];
    for (std::size_t side = 0; side < 2 && row.normal_impulse > 0; ++side) {
      if (row.places[side].organ == organ) halves_.push_back(seen_from(row, side, touched_));
    }
  }
}

/// Gives organs and probes what changed.
void OrganContacts::hand_over(double h) {
  std::size_t r = organ_rows_;
  for (std::uint32_t i = 0; i < organs_.size(); ++i) {
    append_halves(i);
    for (std::size_t k = 0; r < rows_.size() && k < probe_rows_[i].size(); ++k, ++r) {
      ContactRow& contact = probe_rows_[i][k];
      ContactRow change = contact;
      take_impulses(rows_[r], contact);
      change.normal_impulse = contact.normal_impulse - change.normal_impulse;
      change.tangential_impulse = contact.tangential_impulse - change.tangential_impulse;
      halves_.push_back(change);
    }
    if (end_[i] == asked_[i]) continue;
    organs_[i]->correct_step(h, end_[i], touched_[i].volume_impulse, halves_);
  }
}

}  // namespace palpate::deformation
