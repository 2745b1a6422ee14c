// The stiffness of the hand's law against the organ's own: along a press, the force over one period
// more, ended a little further and a little less far; of the law as the haptic loop evaluates it.
#pragma once

#include "studies/certify/line.h"
#include "studies/certify/subject.h"

namespace palpate::certify {

struct LawStiffness {
  double depth = 0;           ///< of the press [m]
  double law = 0, organ = 0;  ///< along the press [N/m]
};

/// At depths of 1/12 to 4/3 of the subject's, from first touch, at 20 mm/s. The organ is pressed
/// anew for each.
/// @param troubles  gets those of all presses added
std::vector<LawStiffness> measure_law(const Subject& subject, const KeepGoing& keep_going,
                                      ContactTroubles& troubles);

/// In the median and at worst, of |law − organ|/|organ|; infinite where the organ's own is 0.
std::vector<Line> law_lines(const std::vector<LawStiffness>& stiffness);

}  // namespace palpate::certify
