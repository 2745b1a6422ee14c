// A link that is worse than loopback: laws and node positions late, unevenly late, or lost.
#pragma once

#include "palpate/session/in_process.h"
#include "studies/certify/line.h"
#include "studies/certify/loop.h"

namespace palpate::certify {

struct Disturbance {
  double delay = 0;   ///< of every sample [s]
  double jitter = 0;  ///< at most so much more, at random; samples keep their order [s]
  double loss = 0;    ///< of the samples, at random

  std::string name() const;  ///< "10 ms late, 20 % lost"
};

/// Those a certificate tries: each alone, and all together.
std::vector<Disturbance> disturbances(bool quick);

/// The same loop with it on contact_model and node_positions. A late sample travels with the first
/// one of its topic that is written when it is due. The same every time.
Loop disturbed(Loop loop, const Disturbance& disturbance);

/// First contact, largest step and energy of a press, and the swing of a held contact.
/// @param troubles  gets those of both added
std::vector<Line> disturbance_lines(const Subject& subject, const Disturbance& disturbance,
                                    double push, const KeepGoing& keep_going,
                                    ContactTroubles& troubles);

}  // namespace palpate::certify
