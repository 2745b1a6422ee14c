// Which settings of which models are measured in which case.
#pragma once

#include <functional>
#include <vector>

#include "studies/chart/point_store.h"
#include "studies/report/claims.h"

namespace palpate::chart {

enum class Extent { kQuick, kUsual, kFull };

/// All settings of a case, cheap ones first.
std::vector<Setting> settings_of(const Case& of, Extent extent);

/// How long a point takes in all, up to a factor common to all: to tell how much is left.
double weight_of(const Setting& setting);

struct Point {
  Case of;
  Setting setting;
  Measurement measurement;
};

/// A reference of our own: on its meshes, coarse to fine, or the parts of a truth.
struct ReferenceSolution {
  Case of;
  std::vector<Measurement> solved;
};

struct SweepResult {
  std::vector<Point> points;
  std::vector<ReferenceSolution> references;
  report::Share share;
};

/// What is about to be measured.
struct Outlook {
  std::string job;
  int done = 0, total = 0;
  double seconds_left = kUnknown;  ///< as this run has gone so far
};

/// Measures what is not in the store yet, reference solutions first.
/// @param claims  of a shard: what other runs measure is left out, and what is measured is not
///                referred to references, which may not be there yet
/// @param begin  told of each job before it is done
/// @throws what a measurement throws; finished points stay in the store
SweepResult sweep(const std::vector<Case>& of, Extent extent,
                  const std::vector<std::string>& models, const PointStore& store,
                  report::Claims& claims, const std::function<void(const Outlook&)>& begin,
                  const KeepGoing& keep_going);

}  // namespace palpate::chart
