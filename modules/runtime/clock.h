// The clocks that modules read.
#pragma once

#include <cstdint>

#include "modules/bus/clock_ns.h"

namespace palpate::runtime {

inline std::int64_t monotonic_now_ns() { return bus::monotonic_ns(); }

/// What the calling thread itself computed so far, whoever else is busy on the machine [ns].
std::int64_t thread_time_ns();

}  // namespace palpate::runtime
