#include "modules/runtime/stolen_time.h"

#include <unistd.h>

#include <fstream>
#include <sstream>
#include <string>

namespace palpate::runtime {

// man 5 proc: "cpu  user nice system idle iowait irq softirq steal …"
double stolen_time(std::string_view proc_stat, double ticks_per_second) {
  std::istringstream line{std::string(proc_stat.substr(0, proc_stat.find('\n')))};
  std::string name;
  double ticks[8] = {};
  if (!(line >> name) || name != "cpu") return 0;
  for (double& number : ticks) {
    if (!(line >> number)) return 0;
  }
  return ticks[7] / ticks_per_second;
}

double stolen_time() {
  std::ifstream file("/proc/stat");
  std::string line;
  std::getline(file, line);
  return stolen_time(line, static_cast<double>(sysconf(_SC_CLK_TCK)));
}

}  // namespace palpate::runtime
