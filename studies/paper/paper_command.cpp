#include "studies/paper/paper_command.h"

#include <algorithm>
#include <array>
#include <ostream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "studies/paper/figures.h"
#include "studies/report/measures.h"
#include "studies/report/plot_script.h"

namespace palpate::paper {
namespace {

struct Part {
  const char* name;
  Findings (*make)(const FigureOptions&, report::Progress&);
};
constexpr std::array<Part, 5> kParts{{{"1", make_spring_figure},
                                      {"2", make_squeeze_figure},
                                      {"3", make_volume_figure},
                                      {"4", make_slide_figure},
                                      {"speed", measure_frame_rate}}};

bool wanted(const PaperOptions& options, const std::string& part) {
  return options.only.empty() ||
         std::find(options.only.begin(), options.only.end(), part) != options.only.end();
}

/// @return false if a part failed
bool make_parts(const PaperOptions& options, report::Progress& progress, Findings& findings,
                std::ostream& log) {
  const FigureOptions figures{data_file("scenes"), options.out, options.quick, options.budget};
  bool complete = true;
  for (const Part& part : kParts) {
    if (!wanted(options, part.name)) continue;
    try {
      const Findings found = part.make(figures, progress);
      findings.insert(findings.end(), found.begin(), found.end());
    } catch (const InputError&) {
      throw;
    } catch (const std::runtime_error& error) {
      log << "part " << part.name << " left out: " << error.what() << std::endl;
      complete = false;
    }
  }
  return complete;
}

}  // namespace

std::vector<std::string> paper_parts() {
  std::vector<std::string> names;
  for (const Part& part : kParts) names.emplace_back(part.name);
  return names;
}

int run_paper(const PaperOptions& options, std::ostream& out, std::ostream& log) {
  report::make_out_folder(options.out);
  const StopSignal stop;
  report::Progress progress(log, [&] { return stop.requested(); });
  Findings findings;
  try {
    bool complete = make_parts(options, progress, findings, log);
    write(findings, options.out / "summary.csv");
    print(findings, out);
    progress.begin("drawing");
    try {
      report::draw_figures(data_file("plots/plot_paper.py"), options.out, {}, [&] {
        if (stop.requested()) throw report::Stopped{};
      });
    } catch (const std::runtime_error& error) {
      if (!stop.requested()) log << error.what() << std::endl;
      complete = false;
    }
    if (stop.requested()) throw report::Stopped{};
    out << "in " << options.out.string() << ": the pictures, their CSV files, summary.csv\n";
    return complete ? kExitDone : kExitFailed;
  } catch (const report::Stopped&) {
    log << "stopped; finished files stay in " << options.out.string() << std::endl;
    return kExitStopped;
  }
}

}  // namespace palpate::paper
