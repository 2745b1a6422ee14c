#include "modules/runtime/stolen_time.h"

#include <fstream>
#include <numeric>
#include <sstream>
#include <string>

namespace palpate::runtime {

// man 5 proc: "cpu  user nice system idle iowait irq softirq steal …"; what follows is part of user
// and nice.
CoreTicks core_ticks(std::string_view proc_stat) {
  std::istringstream line{std::string(proc_stat.substr(0, proc_stat.find('\n')))};
  std::string name;
  double ticks[8] = {};
  if (!(line >> name) || name != "cpu") return {};
  for (double& number : ticks) {
    if (!(line >> number)) return {};
  }
  return {ticks[7], std::accumulate(std::begin(ticks), std::end(ticks), 0.0)};
}

CoreTicks core_ticks() {
  std::ifstream file("/proc/stat");
  std::string line;
  std::getline(file, line);
  return core_ticks(line);
}

double stolen_share(const CoreTicks& before, const CoreTicks& after) {
  const double passed = after.all - before.all;
  return passed > 0 ? (after.stolen - before.stolen) / passed : 0;
}

}  // namespace palpate::runtime
