#include "studies/chart/cases.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "modules/core/error.h"
#include "studies/chart/case_parts.h"
#include "studies/chart/reference_solutions.h"

namespace palpate::chart {
namespace {

using Measure = Measurement (*)(const Setting&, const KeepGoing&);
using SolveReference = Measurement (*)(int level, const KeepGoing&);

struct Entry {
  Case description;
  Measure measure;
  SolveReference reference = nullptr;
};

const std::array<Entry, 9>& entries() {
  static constexpr std::array<Entry, 9> kEntries{{
      {{"ball", "compression", "growth of the equator", 3, false, Reference::kTable}, measure_ball},
      {{"block", "compression", "bulge of a face", 3, false, Reference::kTable}, measure_block},
      {{"truthcube", "compression", "", 3, false, Reference::kTable}, measure_truth_cube},
      {{"indent", "depth [m]", "", 3, false, Reference::kPartly}, measure_indent, press_block},
      {{"vibration", "exact frequency [Hz]", "", 3, true, Reference::kTable}, measure_vibration},
      {{"squeeze", "time [s]", "", 3, true, Reference::kOwn},
       measure_squeeze,
       squeeze_in_small_steps},
      {{"beam", "gravity [m/s2]", "sag of the tip", 3, false, Reference::kOwn},
       measure_beam,
       bend_beam},
      {{"liver", "depth [m]", "displacement 20 mm beside", 3, false, Reference::kOwn},
       measure_liver,
       press_liver},
      {{"stomach", "depth [m]", "displacement 20 mm beside", 3, false, Reference::kOwn},
       measure_stomach,
       press_stomach},
  }};
  return kEntries;
}

/// √ mean of squares of what is known.
template <class Value>
double root_mean_square(const Measurement& measurement, Value value) {
  double sum = 0;
  int count = 0;
  for (const Sample& sample : measurement.samples) {
    const double x = value(sample);
    if (std::isnan(x)) continue;
    sum += x * x;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : kUnknown;
}

}  // namespace

const std::vector<Case>& cases() {
  static const std::vector<Case> kCases = [] {
    std::vector<Case> all;
    for (const Entry& entry : entries()) all.push_back(entry.description);
    return all;
  }();
  return kCases;
}

const Case& find_case(const std::string& name) {
  std::vector<std::string> names;
  for (const Case& candidate : cases()) {
    if (name == candidate.name) return candidate;
    names.emplace_back(candidate.name);
  }
  throw InputError(fmt::format("case '{}': must be one of {}", name, fmt::join(names, ", ")));
}

Measurement measure(const Case& of, const Setting& setting, const KeepGoing& keep_going) {
  for (const Entry& entry : entries()) {
    if (std::string(entry.description.name) == of.name) {
      return entry.measure(setting, keep_going);
    }
  }
  throw InputError(fmt::format("case '{}' is not there", of.name));
}

Measurement solve_reference(const Case& of, int level, const KeepGoing& keep_going) {
  for (const Entry& entry : entries()) {
    if (std::string(entry.description.name) == of.name && entry.reference != nullptr) {
      return entry.reference(level, keep_going);
    }
  }
  throw InputError(fmt::format("case '{}' has no reference of its own", of.name));
}

void refer(const Measurement& reference, Measurement& measurement) {
  const auto fill = [](double answer, double& unknown) {
    if (std::isnan(unknown)) unknown = answer;
  };
  for (Sample& sample : measurement.samples) {
    for (const Sample& answer : reference.samples) {
      if (std::abs(answer.load - sample.load) > 1e-9) continue;
      fill(answer.force, sample.reference_force);
      fill(answer.shape, sample.reference_shape);
      sample.reference_profile = answer.profile;
    }
  }
}

double force_error(const Measurement& measurement) {
  if (measurement.is_course) {
    const double scale =
        root_mean_square(measurement, [](const Sample& s) { return s.reference_force; });
    const double off =
        root_mean_square(measurement, [](const Sample& s) { return s.force - s.reference_force; });
    return off / scale;
  }
  return root_mean_square(measurement,
                          [](const Sample& s) { return s.force / s.reference_force - 1; });
}

double contact_radius_error(const Measurement& measurement) {
  return root_mean_square(measurement, [](const Sample& s) {
    return s.contact_radius / s.reference_contact_radius - 1;
  });
}

double profile_error(const Measurement& measurement) {
  double sum = 0;
  int count = 0;
  for (const Sample& sample : measurement.samples) {
    for (std::size_t i = 0; i < sample.profile.size(); ++i) {
      const double off = sample.profile[i] - sample.reference_profile[i];
      if (std::isnan(off)) continue;
      sum += off * off;
      ++count;
    }
  }
  return count > 0 ? std::sqrt(sum / count) : kUnknown;
}

double shape_error(const Measurement& measurement) {
  return root_mean_square(measurement, [](const Sample& s) { return s.shape - s.reference_shape; });
}

double field_error(const Measurement& measurement) {
  return root_mean_square(measurement, [](const Sample& s) { return s.field_error; });
}

}  // namespace palpate::chart
