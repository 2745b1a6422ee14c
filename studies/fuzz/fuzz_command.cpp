#include "studies/fuzz/fuzz_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>
#include <ostream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "studies/fuzz/block_store.h"
#include "studies/fuzz/lockstep.h"
#include "studies/fuzz/minimise.h"
#include "studies/fuzz/scene_files.h"
#include "studies/fuzz/tally.h"
#include "studies/report/progress.h"

namespace palpate::fuzz {
namespace {

/// Minimising a scene runs it a hundred times; more of one kind say no more.
constexpr std::size_t kKeptOfAKind = 3;

/// Leaves a failing scene as simple as can be in out/scene_k.
void keep(const FuzzOptions& options, const ShapeStore& shapes, std::uint64_t number,
          const std::string& kind, const report::KeepGoing& keep_going, std::ostream& log) {
  const auto fails = [&](const RandomScene& scene) {
    const Outcome outcome = run_apart(scene, shapes, keep_going);
    return outcome.ending == Ending::kFailed && outcome.kind() == kind;
  };
  const RandomScene small = minimised(random_scene(options.seed, number), fails);
  const auto file = write_scene(small, shapes, options.out / fmt::format("scene_{}", number));
  log << fmt::format("scene {} failed ({}): {}", number, kind, file.string()) << std::endl;
}

/// One scene with all that is to say of it.
int run_one(const FuzzOptions& options, const ShapeStore& shapes, std::ostream& out,
            std::ostream& log) {
  const std::uint64_t number = *options.only;
  const RandomScene scene = random_scene(options.seed, number);
  out << text_of(scene);
  const Outcome outcome = run_and_compare(scene, shapes);
  Tally tally;
  tally.add(number, outcome);
  tally.print(out);
  out << fmt::format("simulated {:.4g} s; {}\n", outcome.time,
                     outcome.what.empty() ? "ran" : outcome.what);
  if (outcome.ending != Ending::kFailed) return kExitDone;
  keep(options, shapes, number, outcome.kind(), {}, log);
  return kExitFailed;
}

/// Blocks in order; finished ones are read, and those that another shard runs left out.
report::Share run_all(const FuzzOptions& options, const ShapeStore& shapes,
                      report::Progress& progress, Tally& tally, std::ostream& log) {
  const auto folder = options.out / "blocks";
  if (options.again) std::filesystem::remove_all(folder);
  const BlockStore store(folder, options.seed, log);
  report::Claims claims(folder / "claims", options.shard);
  std::map<std::string, std::size_t> kept;
  std::vector<report::Point> points;
  for (std::uint64_t first = 0; first < options.scenes; first += kBlock) {
    const std::size_t count = std::min(kBlock, options.scenes - first);
    const auto read = [&, first, count] {
      std::vector<Outcome> outcomes;
      if (!store.read(first, count, outcomes)) return false;
      for (std::size_t i = 0; i < count; ++i) tally.add(first + i, outcomes[i]);
      return true;
    };
    const auto run = [&, first, count] {
      std::vector<Outcome> outcomes;
      for (std::uint64_t k = first; k < first + count; ++k) {
        const report::KeepGoing keep_going = [&, k] {
          progress.at(double(k), double(options.scenes), "scenes");
          claims.keep();
        };
        outcomes.push_back(run_and_compare(random_scene(options.seed, k), shapes, keep_going));
        const std::string kind = outcomes.back().kind();
        if (outcomes.back().ending != Ending::kFailed || ++kept[kind] > kKeptOfAKind) continue;
        keep(options, shapes, k, kind, keep_going, log);
      }
      store.write(first, outcomes);
    };
    points.push_back({store.key(first, count), read, run});
  }
  return report::measure_points(points, claims);
}

}  // namespace

int run_fuzz(const FuzzOptions& options, std::ostream& out, std::ostream& log) {
  const ShapeStore shapes(data_file("scenes"));
  if (options.only) return run_one(options, shapes, out, log);
  const StopSignal stop;
  report::Progress progress(log, [&] { return stop.requested(); });
  progress.begin(fmt::format("fuzz, seed {}", options.seed));
  Tally tally;
  report::Share share;
  try {
    share = run_all(options, shapes, progress, tally, log);
  } catch (const report::Stopped&) {
    tally.print(out);
    log << "stopped; finished blocks are not run again" << std::endl;
    return kExitStopped;
  }
  tally.print(out);
  if (options.shard) out << report::text_of(share, *options.shard);
  return tally.failed() == 0 ? kExitDone : kExitFailed;
}

}  // namespace palpate::fuzz
