#include "studies/certify/certify_command.h"

#include <spdlog/fmt/fmt.h>

#include <ostream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "studies/certify/certificate.h"
#include "studies/certify/disturbance.h"
#include "studies/certify/hands.h"
#include "studies/certify/law.h"
#include "studies/certify/press.h"
#include "studies/certify/release.h"
#include "studies/certify/slide.h"
#include "studies/certify/stability.h"
#include "studies/certify/still_force.h"
#include "studies/certify/tables.h"
#include "studies/certify/timing.h"
#include "studies/report/measures.h"
#include "studies/report/plot_script.h"
#include "studies/report/progress.h"

namespace palpate::certify {
namespace {

constexpr double kPressed = 0.3;  // of the force at rest, that the real processes must give
constexpr double kFeltWithin = 60, kPress = 0.5, kHoldFor = 5.1;  // [s]
constexpr double kWallShare = 0.5;  // of the formula's stiffness: well within

class Certifying {
 public:
  Certifying(const CertifyOptions& options, Subject subject, KeepGoing keep_going,
             std::ostream& out, std::ostream& log)
      : options_(options),
        subject_(std::move(subject)),
        keep_going_(std::move(keep_going)),
        out_(out),
        log_(log) {}

  void measure() {
    organ_alone();
    walls();
    pressed();
    slid();
    for (const Disturbance& d : disturbances(options_.quick)) {
      begin("link: " + d.name());
      add(disturbance_lines(subject_, d, push_, keep_going_, troubles_));
    }
    if (!options_.lockstep) {
      real_processes();
      beside_others();
    }
    contacts();
    certificate_.complete = true;
  }

  /// @return whether all passed
  bool write() {
    write_json(certificate_, subject_, options_.out);
    try {
      report::draw_figures(data_file("plots/plot_certify.py"), options_.out);
    } catch (const std::runtime_error& error) {
      log_ << error.what() << std::endl;
    }
    write_page(certificate_, subject_, options_.out);
    out_ << fmt::format(
        "{}: {} lines, {} failed, {} not measured; in {}: certificate.html, "
        "certificate.json\n",
        certificate_.complete ? subject_.scene.name + " certified" : "incomplete",
        certificate_.lines.size(), count(Verdict::kFail), count(Verdict::kNotMeasured),
        options_.out.string());
    return certificate_.passed();
  }

 private:
  void organ_alone() {
    begin("law");
    const auto law = measure_law(subject_, keep_going_, troubles_);
    write_law(law, options_.out);
    add(law_lines(law));
    begin("force");
    const auto forces =
        measure_still_force(loop_on_organ(subject_, &troubles_), subject_, keep_going_);
    write_still_force(forces, options_.out);
    add({still_force_line(forces)});
    push_ = forces.empty() ? 0 : std::max(0.0, forces.back().organ);
  }

  void walls() {
    begin("stability");
    Subject late = subject_;
    late.device.transport_delay += 1e-3;
    add({critical_line(subject_, keep_going_), critical_line(late, keep_going_)});
    const double formula = formula_stiffness(subject_);
    add({stiff_wall_line(subject_, keep_going_),
         energy_line("energy", "of a press and release, on a lossless wall",
                     press_and_release(loop_on_wall(subject_.scene, kWallShare * formula), subject_,
                                       keep_going_),
                     subject_)});
  }

  void pressed() {
    begin("press");
    const Loop loop = loop_on_organ(subject_, &troubles_);
    const auto press = press_and_release(loop, subject_, keep_going_);
    write_ticks(press, options_.out / "press.csv");
    add({energy_line("energy", "of a press and release, on the organ", press, subject_),
         first_contact_line("steps", "first contact", press),
         largest_step_line("steps", "largest of a press", press)});
    begin("held");
    const auto held = hold(loop, subject_, push_, keep_going_);
    write_ticks(held, options_.out / "held.csv");
    add({swing_line("stability", "swing of a held contact", held),
         limit_cycle_line("stability", held)});
  }

  void slid() {
    begin("sliding");
    const auto path = slide_path(subject_, options_.quick ? 1 : 0);
    std::vector<SlideTick> ticks;
    if (!path.empty()) ticks = slide(loop_on_organ(subject_, &troubles_), path, keep_going_);
    write_slide(ticks, options_.out);
    add({slide_line(ticks)});
  }

  void contacts() {
    const auto line = [&](const char* name, std::uint64_t count) {
      add({at_most("contacts", {name, static_cast<double>(count), 0, "", "none may be", ""})});
    };
    line("searches truncated", troubles_.truncated);
    line("searches with the probe inside without contact", troubles_.lost);
    line("steps not solved", troubles_.unsolved);
  }

  void real_processes() {
    begin("timing");
    certificate_.machine = report::machine_name();
    Processes processes(subject_, options_.bus, options_.out, keep_going_);
    measure_alone(processes);
    troubles_ += processes.contact_troubles();
  }

  void measure_alone(Processes& processes) {
    const double pressed = kPressed * push_;
    const bool ready = processes.start();
    processes.hold(pressing_hand());
    const auto feels = [&](const Heard& heard) { return heard.force.force.norm() > pressed; };
    if (!ready || !processes.wait(feels, kFeltWithin)) {
      add({not_measured("timing", "the real processes", "they did not press within a minute")});
      return;
    }
    const auto timing = measure_timing(processes, options_.quick ? 10 : 60);
    write_timing(timing, options_.out);
    add(timing_lines("timing", timing, 1 / subject_.scene.rates.haptics));
    hold_over_dds(processes);
    release(processes, pressed);
  }

  /// The same times, a session of their own with pictures and something else that wants to run.
  void beside_others() {
    const std::string group = "timing with pictures and a CPU hog";
    begin(group);
    if (!std::filesystem::exists(program_folder() / "palpate-visualizer")) {
      add({not_measured(group, "the real processes", "no visualizer is installed")});
      return;
    }
    bus::BusOptions bus = options_.bus;
    bus.session += "_beside";
    Processes processes(subject_, bus, options_.out, keep_going_, Beside::kPicturesAndHog);
    measure_beside(processes, group);
    troubles_ += processes.contact_troubles();
  }

  void measure_beside(Processes& processes, const std::string& group) {
    const bool ready = processes.start();
    processes.hold(pressing_hand());
    const auto feels = [&](const Heard& heard) {
      const auto pictures = heard.modules.find("visualizer");
      return heard.force.force.norm() > kPressed * push_ && pictures != heard.modules.end() &&
             pictures->second.state >= ModuleState::kRunning;
    };
    if (!ready || !processes.wait(feels, kFeltWithin)) {
      add({not_measured(group, "the real processes", "they did not press within a minute")});
      return;
    }
    add(timing_lines(group, measure_timing(processes, options_.quick ? 10 : 60),
                     1 / subject_.scene.rates.haptics));
  }

  scene::EmulatedDevice pressing_hand() const {
    const Vec3 deep = pose_below(subject_.place, subject_.depth).position;
    return firm_hand(subject_.device, subject_.place, {{deep, kPress}});
  }

  void hold_over_dds(Processes& processes) {
    begin("held over DDS");
    processes.hold(pushing_hand(subject_.device, subject_.place, push_));
    processes.wait([](const Heard&) { return false; }, kHoldFor);
    const auto& held = processes.heard().held;
    add({swing_line("over DDS", "swing of a held contact", held),
         limit_cycle_line("over DDS", held)});
  }

  void release(Processes& processes, double pressed) {
    begin("released");
    processes.hold(pressing_hand());
    const auto told = [&](const Release& r) {
      log_ << fmt::format("  {}: let go after {:.1f} ms{}", r.who, 1e3 * r.took,
                          r.back ? "" : ", did not press again")
           << std::endl;
    };
    add(release_lines(measure_releases(processes, pressed, options_.quick ? 2 : 10, told),
                      subject_.scene));
  }

  void begin(const std::string& what) { log_ << what << " …" << std::endl; }
  void add(const std::vector<Line>& lines) {
    for (const Line& line : lines) {
      out_ << text_of(line) << std::endl;
      certificate_.lines.push_back(line);
    }
  }
  long count(Verdict verdict) const {
    return std::count_if(certificate_.lines.begin(), certificate_.lines.end(),
                         [&](const Line& line) { return line.verdict == verdict; });
  }

  const CertifyOptions& options_;
  Subject subject_;
  KeepGoing keep_going_;
  std::ostream& out_;
  std::ostream& log_;
  Certificate certificate_;
  ContactTroubles troubles_;  ///< of all sessions, the real processes' too
  double push_ = 0;           ///< what the organ holds at the depth of presses [N]
};

}  // namespace

int run_certify(const CertifyOptions& options, const std::function<bool()>& stop, std::ostream& out,
                std::ostream& log) {
  const KeepGoing keep_going = [&] {
    if (stop()) throw report::Stopped{};
  };
  Subject subject = load_subject(options.scene, keep_going);
  subject.depth = options.depth;
  subject.speed = options.speed;
  report::make_out_folder(options.out);
  Certifying certifying(options, std::move(subject), keep_going, out, log);
  try {
    certifying.measure();
  } catch (const report::Stopped&) {
    certifying.write();
    return report::kExitStopped;
  }
  return certifying.write() ? kExitDone : kExitFailed;
}

}  // namespace palpate::certify
