// What the host of a virtual machine took from it: time in which it wanted to run and could not.
#pragma once

#include <string_view>

namespace palpate::runtime {

/// Of all cores since they began [s]; 0 if `proc_stat`, the text of /proc/stat, does not tell.
/// @param ticks_per_second  of its numbers
double stolen_time(std::string_view proc_stat, double ticks_per_second);
/// The same of this machine, now.
double stolen_time();

}  // namespace palpate::runtime
