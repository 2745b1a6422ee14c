// What the host of a virtual machine took from it: time in which it wanted to run and could not.
#pragma once

#include <string_view>

namespace palpate::runtime {

/// Of all cores since they began, in ticks of the kernel.
struct CoreTicks {
  double stolen = 0;
  double all = 0;  ///< idle ones too
};

/// Zeros if `proc_stat`, the text of /proc/stat, does not tell.
CoreTicks core_ticks(std::string_view proc_stat);
/// The same of this machine, now.
CoreTicks core_ticks();
/// Share of the cores' time between the two that was stolen [0 … 1]; 0 if none passed.
double stolen_share(const CoreTicks& before, const CoreTicks& after);

}  // namespace palpate::runtime
