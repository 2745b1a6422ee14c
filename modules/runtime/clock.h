// The one place where modules read a clock.
#pragma once

#include <cstdint>

namespace palpate::runtime {

/// CLOCK_MONOTONIC: the same for every process of a host, never set back [ns].
std::int64_t monotonic_now_ns();

/// What the calling thread itself computed so far, whoever else is busy on the machine [ns].
std::int64_t thread_time_ns();

}  // namespace palpate::runtime
