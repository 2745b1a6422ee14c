#include "studies/chart/sweep.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "deformation/models.h"
#include "modules/scene/models.h"
#include "modules/scene/schema.h"
#include "studies/chart/reference_solutions.h"
#include "studies/report/pace.h"

namespace palpate::chart {
namespace {

bool is_slow(const std::string& model) { return deformation::row_of(model).step_cost >= 1000; }

bool wanted(const Case& of, const Setting& setting, Extent extent) {
  const int finest = extent == Extent::kQuick ? 0 : extent == Extent::kUsual ? 1 : 2;
  if (setting.level > std::min(finest, of.level_count - 1)) return false;
  if (extent == Extent::kFull || !is_slow(setting.model)) return true;
  // What takes longer than all other models together is left to --full.
  const std::string name = of.name;
  if (name == "indent" && (extent == Extent::kQuick || setting.level > 0)) return false;
  return setting.rate < 101;
}

std::vector<double> rates_of(Extent extent) {
  if (extent == Extent::kQuick) return {100};
  if (extent == Extent::kUsual) return {50, 250};
  return {50, 100, 250, 1000};
}

/// Beside the model's own count: fewer and more.
std::vector<std::size_t> iterations_of(const std::string& model) {
  const std::size_t own = scene::format_of(model).iterations;
  if (own == 0) return {};
  return own == 1 ? std::vector<std::size_t>{2, 4, 8} : std::vector<std::size_t>{5, 10, 80};
}

/// Usually on one mesh of one case, where all else is the model's own.
bool sweeps_iterations(const Case& of, const Setting& setting, Extent extent) {
  if (extent == Extent::kFull) return true;
  return extent == Extent::kUsual && std::string(of.name) == "ball" && setting.level == 0 &&
         setting.rate < 51;
}

bool is_wanted(const std::vector<std::string>& models, const std::string& model) {
  return std::find(models.begin(), models.end(), model) != models.end();
}

/// One thing to measure, and where its result goes.
struct Job {
  std::string name;
  Case of;
  std::string key;
  double weight = 1;
  std::function<Measurement()> measure;
  Measurement* result = nullptr;
};

report::Share run(std::vector<Job>& jobs, const PointStore& store, report::Claims& claims,
                  const std::function<void(const Outlook&)>& begin) {
  double left = 0;
  for (const Job& job : jobs) {
    if (!store.read(job.of, job.key, *job.result)) left += job.weight;
  }
  report::Pace pace;
  std::vector<report::Point> points;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const Job& job = jobs[i];
    points.push_back({store.point_key(job.of, job.key),
                      [&] { return store.read(job.of, job.key, *job.result); },
                      [&, i] {
                        begin({job.name, static_cast<int>(i), static_cast<int>(jobs.size()),
                               pace.seconds_for(left)});
                        pace.begin();
                        store.write(job.of, job.key, job.measure());
                        pace.finish(job.weight);
                        left -= job.weight;
                      }});
  }
  return report::measure_points(points, claims);
}

}  // namespace

// Steps per second grow with the rate, and cost per step with nodes: eight times per level, more
// for direct solvers; fitted to the usual chart, good to a factor of two or three.
double weight_of(const Setting& setting) {
  const scene::ModelFormat& format = scene::format_of(setting.model);
  const bool springs = !format.is_solid() && format.iterations == 0;
  const bool implicit = format.iterations > 1 || is_slow(setting.model);
  const double model = is_slow(setting.model) ? 12 : springs ? 0.3 : 1;
  const double growth = is_slow(setting.model) ? 20 : 7;
  return model * std::pow(growth, setting.level) * (implicit ? setting.rate / 100 : 1);
}

/// Under a small sphere it is the mesh that counts, not the step; models that can be fine there
/// are.
std::vector<Setting> settings_under_sphere(const Case& of, Extent extent) {
  constexpr double kRate = 100;  // [Hz]
  // Under the smaller sphere only meshes that are small there are worth the time.
  const bool every =
      extent == Extent::kFull || std::string(of.name).find("4mm") == std::string::npos;
  const int levels = extent == Extent::kFull ? of.level_count : 2;
  std::vector<Setting> settings;
  for (const std::string& model : model_hierarchy()) {
    const auto& format = scene::format_of(model);
    for (int level = 0; level < levels && every; ++level) {
      // Solids that are fine all over take longer than all else.
      const bool dear = is_slow(model) || (format.is_solid() && level > 0);
      if (extent != Extent::kFull && dear) continue;
      settings.push_back({model, level, kRate});
    }
    if (model != "nodal_pressure" && model != "quadratic_pressure") continue;
    for (const Small small : {Small::kAtPlaces, Small::kFollowing}) {
      for (int level = 0; level < kSmallLevels; ++level) {
        settings.push_back({model, level, kRate, 0, small});
      }
    }
  }
  return settings;
}

std::vector<Setting> settings_of(const Case& of, Extent extent) {
  std::vector<Setting> settings;
  if (of.reference == Reference::kOwn && extent == Extent::kQuick)
    return settings;  // references take minutes
  if (of.has_truth()) return settings_under_sphere(of, extent);
  for (const std::string& model : model_hierarchy()) {
    for (int level = 0; level < of.level_count; ++level) {
      for (const double rate : rates_of(extent)) {
        Setting setting{model, level, rate};
        if (!wanted(of, setting, extent)) continue;
        settings.push_back(setting);
        if (!sweeps_iterations(of, setting, extent)) continue;
        for (const std::size_t count : iterations_of(model)) {
          setting.iterations = count;
          settings.push_back(setting);
        }
      }
    }
  }
  return settings;
}

SweepResult sweep(const std::vector<Case>& of, Extent extent,
                  const std::vector<std::string>& models, const PointStore& store,
                  report::Claims& claims, const std::function<void(const Outlook&)>& begin,
                  const KeepGoing& keep_going) {
  SweepResult result;
  for (const Case& each : of) {
    for (const Setting& setting : settings_of(each, extent)) {
      if (!is_wanted(models, setting.model)) continue;
      result.points.push_back({each, setting, {}});
      if (each.truth_count > 1 && each.truth_count < kPlaces) {
        result.points.back().setting.places = each.truth_count;
      }
    }
    if (each.reference != Reference::kTable && extent != Extent::kQuick) {
      result.references.push_back(
          {each, std::vector<Measurement>(static_cast<std::size_t>(reference_count(each)))});
    }
  }
  constexpr double kReferenceWeight = 100;
  std::vector<Job> jobs;
  for (ReferenceSolution& reference : result.references) {
    for (int k = 0; k < reference_count(reference.of); ++k) {
      const char* what = reference.of.has_truth() ? "truth" : "reference, level";
      jobs.push_back({fmt::format("{}: {} {}", reference.of.name, what, k), reference.of,
                      reference_key(k), kReferenceWeight,
                      [&, k] { return solve_reference(reference.of, k, keep_going); },
                      &reference.solved[static_cast<std::size_t>(k)]});
    }
  }
  for (Point& point : result.points) {
    jobs.push_back({fmt::format("{}: {}", point.of.name, point.setting.name()), point.of,
                    point.setting.key(), weight_of(point.setting),
                    [&] { return measure(point.of, point.setting, keep_going); },
                    &point.measurement});
  }
  result.share = run(jobs, store, claims, begin);
  if (claims.shard()) return result;
  for (Point& point : result.points) {
    for (const ReferenceSolution& reference : result.references) {
      if (std::string(reference.of.name) == point.of.name) {
        refer(whole_reference(reference.of, reference.solved), point.measurement);
      }
    }
  }
  return result;
}

}  // namespace palpate::chart
