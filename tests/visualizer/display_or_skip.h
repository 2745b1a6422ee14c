// Tests that draw need Xvfb; where it is absent they say so.
#pragma once

#include <cstdlib>
#include <iostream>

namespace palpate::visualizer::testing {

inline bool xvfb_or_skip() {
  if (std::system("command -v Xvfb > /dev/null") == 0) return true;
  std::cout << "SKIPPED: Xvfb is not installed\n";
  return false;
}

}  // namespace palpate::visualizer::testing
