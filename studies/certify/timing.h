// Times of the real processes: the loop's period, what it misses, and from a pose to its force.
#pragma once

#include "studies/certify/line.h"
#include "studies/certify/processes.h"

namespace palpate::certify {

struct Timing {
  std::vector<double> periods, latencies;  ///< [s]
  std::uint64_t cycles = 0, overruns = 0;  ///< of haptics
  bool realtime = false;                   ///< haptics was granted SCHED_FIFO
  double factor = 0;                       ///< real-time factor of deformation at the end
  double stolen = 0;                       ///< by the host of the machine, of its cores' time
};

/// Of a started session, whose hand presses.
Timing measure_timing(Processes& processes, double seconds);

/// @param group   of the lines
/// @param period  T of the scene [s]
std::vector<Line> timing_lines(const std::string& group, const Timing& timing, double period);

}  // namespace palpate::certify
