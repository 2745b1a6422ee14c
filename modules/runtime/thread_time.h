// What a thread itself computed, whoever else is busy on the machine.
#pragma once

#include <cstdint>

namespace palpate::runtime {

/// Processor time of the calling thread so far [ns].
std::int64_t thread_time_ns();

}  // namespace palpate::runtime
