// Whoever falls silent while a hand presses lets go of it: the driver or a process that is killed,
// a session that pauses, is at fault or is reset. Of haptics itself it is the driver's own guard
// that lets go.
#pragma once

#include <string>

#include "studies/certify/line.h"
#include "studies/certify/processes.h"

namespace palpate::certify {

struct Release {
  std::string who;   ///< "driver killed", "paused"
  double took = 0;   ///< from the last word that gave a force to the last one that was not zero [s]
  double step = 0;   ///< largest change of the force in a tick, until it was back [N]
  bool came = true;  ///< it had pressed, and was let go
  bool back = true;  ///< started again, it pressed again within 20 s
};

/// One after the other, `times` times each, on a started session.
std::vector<Release> measure_releases(Processes& processes, double pressed, int times,
                                      const std::function<void(const Release&)>& told);

std::vector<Line> release_lines(const std::vector<Release>& releases, const scene::Scene& scene);

}  // namespace palpate::certify
