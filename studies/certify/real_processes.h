// The lines of a certificate that are of the real processes over loopback DDS: times, a held
// contact, who lets go.
#pragma once

#include <iosfwd>

#include "studies/certify/certify_command.h"
#include "studies/certify/line.h"
#include "studies/certify/subject.h"

namespace palpate::certify {

/// One session of them.
struct RealRun {
  const CertifyOptions& options;
  const Subject& subject;
  double push = 0;  ///< of a held contact [N]
  const KeepGoing& keep_going;
  std::function<void(const std::vector<Line>&)> add;  ///< gets lines as they are measured
  std::ostream& log;
};

/// Timing, held over DDS, released, as far as they are wanted.
/// @returns the troubles of contacts of all its processes
ContactTroubles measure_real_processes(const RealRun& run);

/// The same times, a session of their own with pictures and something else that wants to run.
ContactTroubles measure_beside_others(const RealRun& run);

}  // namespace palpate::certify
