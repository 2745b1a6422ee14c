// What `palpate contact-loop` does.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace palpate::contact_loop {

struct ContactLoopOptions {
  std::vector<std::filesystem::path> scenes;  ///< empty: both stomachs and the solid liver
  std::vector<std::string> tools;             ///< empty: all of them
  std::vector<double> radii;                  ///< of the balls [m]; empty: 0.5 to 8 mm
  std::vector<double> speeds;                 ///< [m/s]; empty: 0.05 to 2.5
  std::vector<double> rates;                  ///< of deformation [Hz]; empty: 50, 100, 250
  std::vector<double> collision_rates;        ///< [Hz]; empty: 250
  double loss = 0;                            ///< LoopCase::loss
  int places = 1;  ///< on an organ's front: the usual one, if it is on it, others at random
  bool quick = false;
};

/// Runs every combination, prints a line for each with what its searches found, and their sum.
/// @param keep_going  asked often; may throw
/// @return kExitDone if no search inside an organ was without contact, as judged and as the session
/// counts them, none left contacts out, no wall was crossed and no advance left tissue in a round
/// tool unsaid; else kExitFailed
/// @throws InputError; what keep_going throws
int run_contact_loop(const ContactLoopOptions& options, const std::function<void()>& keep_going,
                     std::ostream& out);

}  // namespace palpate::contact_loop
