#include "studies/chart/cases.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "modules/core/error.h"
#include "studies/chart/case_parts.h"
#include "studies/chart/reference_solutions.h"
#include "studies/report/measures.h"

namespace palpate::chart {
namespace {

using Measure = Measurement (*)(const Setting&, const KeepGoing&);
using SolveReference = Measurement (*)(int level, const KeepGoing&);

struct Entry {
  Case description;
  Measure measure;
  SolveReference reference = nullptr;
};

const std::array<Entry, 12>& entries() {
  static constexpr std::array<Entry, 12> kEntries{{
      {{"ball", 3, Reference::kTable}, measure_ball},
      {{"block", 3, Reference::kTable}, measure_block},
      {{"truthcube", 3, Reference::kTable}, measure_truth_cube},
      {{"indent", 3, Reference::kPartly}, measure_indent, press_block},
      {{"vibration", 3, Reference::kTable}, measure_vibration},
      {{"squeeze", 3, Reference::kOwn}, measure_squeeze, squeeze_in_small_steps},
      {{"beam", 3, Reference::kOwn}, measure_beam, bend_beam},
      {{"liver", 3, Reference::kOwn, kPlaces}, measure_liver, truth_on_liver},
      {{"stomach", 3, Reference::kOwn, kPlaces}, measure_stomach, truth_on_stomach},
      {{"liver_4mm", 3, Reference::kOwn, kPlaces}, measure_small_liver, small_truth_on_liver},
      {{"stomach_4mm", 3, Reference::kOwn, kPlaces}, measure_small_stomach, small_truth_on_stomach},
      {{"slide", 2, Reference::kOwn, 1}, measure_slide, truth_of_slide},
  }};
  return kEntries;
}

bool is_same_load(const Sample& a, const Sample& b) {
  return std::abs(a.load - b.load) < 1e-9 && a.place == b.place;
}

double bar_of(const Sample& sample) {
  return std::isnan(sample.reference_force_bar) ? 0 : sample.reference_force_bar;
}

/// Of |force / reference − 1|: both the difference and what it is a part of are known to the bar.
Known relative_error(const Sample& sample) {
  const double error = std::abs(sample.force / sample.reference_force - 1);
  return {error, bar_of(sample) / std::abs(sample.reference_force) * (1 + error)};
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

int reference_count(const Case& of) {
  if (of.reference == Reference::kTable) return 0;
  return of.has_truth() ? of.truth_count : kReferenceLevels;
}

Measurement solve_reference(const Case& of, int number, const KeepGoing& keep_going) {
  for (const Entry& entry : entries()) {
    if (std::string(entry.description.name) == of.name && entry.reference != nullptr) {
      return entry.reference(number, keep_going);
    }
  }
  throw InputError(fmt::format("case '{}' has no reference of its own", of.name));
}

Measurement whole_reference(const Case& of, const std::vector<Measurement>& solved) {
  Measurement whole = solved.back();
  if (of.has_truth()) {
    whole.samples.clear();
    for (const Measurement& part : solved) {
      whole.samples.insert(whole.samples.end(), part.samples.begin(), part.samples.end());
    }
    return whole;
  }
  for (Sample& sample : whole.samples) {
    for (const Sample& coarser : solved.front().samples) {
      if (!is_same_load(sample, coarser)) continue;
      sample.force_bar = std::abs(sample.force - coarser.force);
    }
  }
  return whole;
}

void refer(const Measurement& reference, Measurement& measurement) {
  const auto fill = [](double answer, double& unknown) {
    if (std::isnan(unknown)) unknown = answer;
  };
  for (Sample& sample : measurement.samples) {
    for (const Sample& answer : reference.samples) {
      if (!is_same_load(answer, sample)) continue;
      if (std::isnan(sample.reference_force)) sample.reference_force_bar = answer.force_bar;
      fill(answer.force, sample.reference_force);
      fill(answer.shape, sample.reference_shape);
      sample.reference_profile = answer.profile;
    }
  }
}

Known force_error_with_bar(const Measurement& m) {
  if (m.is_course) {
    const double scale = root_mean_square(m, [](const Sample& s) { return s.reference_force; });
    const double off =
        root_mean_square(m, [](const Sample& s) { return s.force - s.reference_force; });
    const double bar = root_mean_square(m, bar_of);
    return {off / scale, bar / scale * (1 + off / scale)};
  }
  const auto known = [](double of_sample, const Sample& s) {
    return std::isnan(s.reference_force) ? kUnknown : of_sample;
  };
  const auto part = [&](double Known::*member) {
    return root_mean_square(m,
                            [&](const Sample& s) { return known(relative_error(s).*member, s); });
  };
  const double bar = part(&Known::bar);
  return {part(&Known::value), std::isnan(bar) ? 0 : bar};
}

// Each error lies between itself less its bar and itself plus that, so a quantile lies between
// those of the one and of the other.
Known force_quantile(const Measurement& measurement, double part) {
  std::vector<double> values, least, most;
  for (const Sample& sample : measurement.samples) {
    const auto [error, bar] = relative_error(sample);
    if (std::isnan(error)) continue;
    values.push_back(error);
    least.push_back(std::max(0.0, error - bar));
    most.push_back(error + bar);
  }
  if (values.empty()) return {};
  const double value = report::quantile(values, part);
  return {value,
          std::max(value - report::quantile(least, part), report::quantile(most, part) - value)};
}

double ripple(const Measurement& measurement) {
  if (!measurement.is_course) return kUnknown;
  double least = std::numeric_limits<double>::infinity(), most = -least, sum = 0;
  for (const Sample& sample : measurement.samples) {
    const double ratio = sample.force / sample.reference_force;
    least = std::min(least, ratio);
    most = std::max(most, ratio);
    sum += ratio;
  }
  return (most - least) / (sum / static_cast<double>(measurement.samples.size()));
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
