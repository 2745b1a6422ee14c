// Organs as solids, fixed as their scenes fix them, pressed by a sphere at many places.
#include "studies/chart/case_parts.h"
#include "studies/chart/organ_sites.h"
#include "studies/chart/reference_solutions.h"

namespace palpate::chart {
namespace {

constexpr unsigned kSeed = 1;
constexpr double kSphere = 8e-3, kSmallSphere = 4e-3;  // radii [m]

Measurement press_all(const rigs::PokedPlace& organ, double radius, const Setting& setting,
                      const KeepGoing& keep_going) {
  const OrganSites sites(organ, radius);
  std::vector<Measurement> places;
  const int count = setting.places > 0 ? setting.places : kPlaces;
  for (const Site& site : sites.random(static_cast<std::size_t>(count), kSeed)) {
    places.push_back(sites.press(site, setting, keep_going));
  }
  return joined(places);
}

Measurement truth_at(const rigs::PokedPlace& organ, double radius, int place,
                     const KeepGoing& keep_going) {
  const OrganSites sites(organ, radius);
  Measurement truth =
      sites.truth(sites.random(kPlaces, kSeed).at(static_cast<std::size_t>(place)), keep_going);
  for (Sample& sample : truth.samples) sample.place = place;
  return truth;
}

}  // namespace

Measurement truth_on_liver(int place, const KeepGoing& keep_going) {
  return truth_at(rigs::kOnLiver, kSphere, place, keep_going);
}

Measurement truth_on_stomach(int place, const KeepGoing& keep_going) {
  return truth_at(rigs::kOnStomach, kSphere, place, keep_going);
}

Measurement small_truth_on_liver(int place, const KeepGoing& keep_going) {
  return truth_at(rigs::kOnLiver, kSmallSphere, place, keep_going);
}

Measurement small_truth_on_stomach(int place, const KeepGoing& keep_going) {
  return truth_at(rigs::kOnStomach, kSmallSphere, place, keep_going);
}

Measurement measure_liver(const Setting& setting, const KeepGoing& keep_going) {
  return press_all(rigs::kOnLiver, kSphere, setting, keep_going);
}

Measurement measure_stomach(const Setting& setting, const KeepGoing& keep_going) {
  return press_all(rigs::kOnStomach, kSphere, setting, keep_going);
}

Measurement measure_small_liver(const Setting& setting, const KeepGoing& keep_going) {
  return press_all(rigs::kOnLiver, kSmallSphere, setting, keep_going);
}

Measurement measure_small_stomach(const Setting& setting, const KeepGoing& keep_going) {
  return press_all(rigs::kOnStomach, kSmallSphere, setting, keep_going);
}

}  // namespace palpate::chart
