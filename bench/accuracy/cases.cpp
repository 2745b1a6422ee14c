#include "bench/accuracy/cases.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "bench/accuracy/case_parts.h"
#include "modules/core/error.h"

namespace palpate::accuracy {
namespace {

using Measure = Measurement (*)(const Setting&, const Source&, const KeepGoing&);

struct Entry {
  Case description;
  Measure measure;
};

const std::array<Entry, 8>& entries() {
  static constexpr std::array<Entry, 8> kEntries{{
      {{"ball", "compression", "growth of the equator", 3, false, false}, measure_ball},
      {{"block", "compression", "bulge of a face", 3, false, false}, measure_block},
      {{"truthcube", "compression", "", 3, false, false}, measure_truth_cube},
      {{"indent", "depth [m]", "", 3, false, false}, measure_indent},
      {{"vibration", "exact frequency [Hz]", "", 3, true, false}, measure_vibration},
      {{"beam", "gravity [m/s2]", "sag of the tip", 3, false, true}, measure_beam},
      {{"liver", "depth [m]", "displacement 20 mm beside", 3, false, true}, measure_liver},
      {{"stomach", "depth [m]", "displacement 20 mm beside", 3, false, true}, measure_stomach},
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

Measurement measure(const Case& of, const Setting& setting, const Source& source,
                    const KeepGoing& keep_going) {
  for (const Entry& entry : entries()) {
    if (std::string(entry.description.name) == of.name) {
      return entry.measure(setting, source, keep_going);
    }
  }
  throw InputError(fmt::format("case '{}' is not there", of.name));
}

double force_error(const Measurement& measurement) {
  return root_mean_square(measurement,
                          [](const Sample& s) { return s.force / s.reference_force - 1; });
}

double shape_error(const Measurement& measurement) {
  return root_mean_square(measurement, [](const Sample& s) { return s.shape - s.reference_shape; });
}

double field_error(const Measurement& measurement) {
  return root_mean_square(measurement, [](const Sample& s) { return s.field_error; });
}

}  // namespace palpate::accuracy
