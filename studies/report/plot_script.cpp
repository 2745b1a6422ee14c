#include "studies/report/plot_script.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate::report {
namespace {

constexpr useconds_t kAskEvery = 20'000;  // [µs]

}  // namespace

int run_program(const std::vector<std::string>& words, const KeepGoing& keep_going) {
  std::vector<char*> arguments;
  for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t process = 0;
  if (posix_spawnp(&process, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0) {
    return -1;
  }
  int status = 0;
  pid_t waited = 0;
  while ((waited = waitpid(process, &status, WNOHANG)) == 0) {
    try {
      if (keep_going) keep_going();
    } catch (...) {
      kill(process, SIGTERM);
      waitpid(process, &status, 0);
      throw;
    }
    usleep(kAskEvery);
  }
  return waited == process && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

namespace {

/// The first python3 that has matplotlib; empty if none has.
std::string find_python(const KeepGoing& keep_going) {
  constexpr const char* kHasMatplotlib =
      "import importlib.util, sys; sys.exit(importlib.util.find_spec('matplotlib') is None)";
  for (const std::string python : {"python3", "/usr/bin/python3"}) {
    if (run_program({python, "-c", kHasMatplotlib}, keep_going) == 0) return python;
  }
  return {};
}

}  // namespace

void draw_figures(const std::filesystem::path& script, const std::filesystem::path& folder,
                  const std::vector<std::string>& words, const KeepGoing& keep_going) {
  const std::string python = find_python(keep_going);
  if (python.empty()) {
    throw std::runtime_error(
        "no pictures: python3 with matplotlib is missing (Debian: apt install "
        "python3-matplotlib); the CSV files in " +
        folder.string() + " stay");
  }
  std::vector<std::string> command{python, script.string(), folder.string()};
  command.insert(command.end(), words.begin(), words.end());
  if (run_program(command, keep_going) != 0) {
    throw std::runtime_error("no pictures: " + script.string() + " failed; the CSV files in " +
                             folder.string() + " stay");
  }
}

}  // namespace palpate::report
