// A program as somebody types it, in a process of its own, to its end.
#pragma once

#include <sys/wait.h>

#include <string>
#include <vector>

#include "palpate/child_process.h"
#include "tests/modules/runtime/own_bus.h"

namespace palpate::testing {

struct Outcome {
  int code = -1;  ///< -1: it did not end, or was killed
  std::string said;
};

inline Outcome type(const std::string& program, const std::vector<std::string>& arguments) {
  launcher::ChildProcess child(std::filesystem::path(PALPATE_BIN_DIR) / program, arguments);
  Outcome outcome;
  const auto listen = [&] {
    for (const auto& line : child.take_lines()) outcome.said += line + "\n";
  };
  wait_until([&] {
    listen();
    return child.ended().has_value();
  });
  listen();
  if (child.ended() && WIFEXITED(*child.ended())) outcome.code = WEXITSTATUS(*child.ended());
  return outcome;
}

}  // namespace palpate::testing
