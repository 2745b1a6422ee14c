// What a process takes of the machine's memory.
#pragma once

#include <sys/types.h>

#include <fstream>
#include <string>

namespace palpate::testing {

/// Resident [kB]; 0: there is no such process.
inline double resident_memory(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) return std::stod(line.substr(6));
  }
  return 0;
}

}  // namespace palpate::testing
