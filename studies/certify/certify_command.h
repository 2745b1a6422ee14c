// What `palpate certify` does.
#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "modules/bus/bus.h"
#include "studies/report/claims.h"

namespace palpate::certify {

/// What `only` may name.
inline const std::vector<std::string> kParts{"law",  "walls",  "press",    "held",  "slide",
                                             "link", "timing", "released", "beside"};

struct CertifyOptions {
  std::filesystem::path scene;
  std::filesystem::path out = "out/certify";
  double depth = 6e-3;    ///< of presses [m]
  double speed = 0.04;    ///< of presses in the mean, of slides [m/s]
  double push = 0;        ///< of held contacts [N]; 0: what the organ holds at the depth
  bool lockstep = false;  ///< without the real processes: the same numbers every time
  bool quick = false;
  std::vector<std::string> only = {};       ///< of kParts; empty: all
  std::optional<report::Shard> shard = {};  ///< measures groups that no other run does; lockstep
  bus::BusOptions bus;  ///< of the real processes; session: a name that nobody else has

  bool wants(const std::string& part) const {
    return only.empty() || std::ranges::find(only, part) != only.end();
  }
};

/// Measures line by line and writes certificate.json, certificate.html, tables and pictures.
/// Stopped, it writes what is done, marked incomplete.
/// @return kExitDone if every line that was measured passed, kExitFailed if one did not, 130 if it
///         was stopped
/// @throws InputError for a scene that cannot be certified
int run_certify(const CertifyOptions& options, const std::function<bool()>& stop, std::ostream& out,
                std::ostream& log);

}  // namespace palpate::certify
