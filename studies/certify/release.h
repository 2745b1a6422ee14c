// Who dies while a hand presses lets go of it: the driver, or a process that is killed. Of haptics
// itself it is the driver's own guard that does.
#pragma once

#include "studies/certify/line.h"
#include "studies/certify/processes.h"

namespace palpate::certify {

struct Release {
  std::string who;   ///< "driver", "deformation", "collision"
  double took = 0;   ///< from its last word to the last force that was not zero [s]
  double step = 0;   ///< largest change of the force in a tick, until it was back [N]
  bool came = true;  ///< it had pressed, and was let go
  bool back = true;  ///< started again, it pressed again within 20 s
};

/// One after the other, `times` times each, on a started session.
std::vector<Release> measure_releases(Processes& processes, double pressed, int times,
                                      const std::function<void(const Release&)>& told);

std::vector<Line> release_lines(const std::vector<Release>& releases, const scene::Scene& scene);

}  // namespace palpate::certify
