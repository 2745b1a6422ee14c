// Programs as a person starts them: `palpate run`, and what joins its session.
#pragma once

#include <sys/wait.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "palpate/child_process.h"
#include "tests/modules/runtime/own_bus.h"
#include "tests/palpate/ball_scene.h"

namespace palpate::testing {

inline std::filesystem::path bin(const std::string& name) {
  return std::filesystem::path(PALPATE_BIN_DIR) / name;
}

/// `arguments` with those that name a session.
inline std::vector<std::string> joined(std::vector<std::string> arguments,
                                       const bus::BusOptions& options) {
  // One process has no bus, and takes no option of one.
  if (std::ranges::find(arguments, "--in-process") != arguments.end()) return arguments;
  arguments.insert(arguments.end(),
                   {"--session", options.session, "--domain", std::to_string(options.domain)});
  return arguments;
}

/// A running program and all it has said.
class Running {
 public:
  Running(const std::filesystem::path& program, const std::vector<std::string>& arguments)
      : child_(std::make_unique<launcher::ChildProcess>(program, arguments)) {}

  bool wait_for_text(const std::string& text) {
    return wait_until([&] {
      listen();
      return said_.find(text) != std::string::npos;
    });
  }
  /// Exit code; −1 if it does not end within the deadline or is killed.
  /// @param meddle  called again and again while it runs, with its process
  int wait_for_end(double deadline = kDeadline, const std::function<void(pid_t)>& meddle = {}) {
    wait_until(
        [&] {
          listen();
          if (meddle) meddle(child_->process_id());
          return child_->ended().has_value();
        },
        deadline);
    listen();
    UNSCOPED_INFO(said_);
    if (!child_->ended() || !WIFEXITED(*child_->ended())) return -1;
    return WEXITSTATUS(*child_->ended());
  }
  launcher::ChildProcess& child() { return *child_; }
  const std::string& said() const { return said_; }
  /// The same, with what came meanwhile.
  const std::string& listened() {
    listen();
    return said_;
  }

 private:
  void listen() {
    for (const auto& line : child_->take_lines()) said_ += line + "\n";
  }

  std::unique_ptr<launcher::ChildProcess> child_;
  std::string said_;
};

/// A running `palpate run`.
class Launched : public Running {
 public:
  Launched(const std::filesystem::path& scene, std::vector<std::string> more,
           const bus::BusOptions& options = own_bus_options())
      : Running(bin("palpate"), arguments(scene, std::move(more), options)), options_(options) {}
  Launched(const BallScene& scene, std::vector<std::string> more,
           const bus::BusOptions& options = own_bus_options())
      : Launched(scene.file(), std::move(more), options) {}

  /// Processes whose command line names this session, by their program.
  std::map<std::string, pid_t> processes() const {
    std::map<std::string, pid_t> found;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      std::ifstream stream(entry.path() / "cmdline", std::ios::binary);
      const std::string line{std::istreambuf_iterator<char>(stream), {}};
      if (line.find(options_.session + '\0') == std::string::npos) continue;
      const std::string program = std::filesystem::path(line.substr(0, line.find('\0'))).filename();
      found[program] = std::stoi(entry.path().filename().string());
    }
    return found;
  }
  const bus::BusOptions& options() const { return options_; }

 private:
  static std::vector<std::string> arguments(const std::filesystem::path& scene,
                                            std::vector<std::string> more,
                                            const bus::BusOptions& options) {
    more.insert(more.begin(), {"run", scene.string(), "--headless"});
    return joined(std::move(more), options);
  }

  bus::BusOptions options_;
};

}  // namespace palpate::testing
