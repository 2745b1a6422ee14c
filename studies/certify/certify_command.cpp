#include "studies/certify/certify_command.h"

#include <spdlog/fmt/fmt.h>

#include <chrono>
#include <map>
#include <ostream>
#include <thread>
#include <utility>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/runtime/program.h"
#include "modules/scene/scene_reader.h"
#include "studies/certify/certificate.h"
#include "studies/certify/disturbance.h"
#include "studies/certify/group_store.h"
#include "studies/certify/hands.h"
#include "studies/certify/law.h"
#include "studies/certify/press.h"
#include "studies/certify/release.h"
#include "studies/certify/slide.h"
#include "studies/certify/stability.h"
#include "studies/certify/still_force.h"
#include "studies/certify/tables.h"
#include "studies/certify/timing.h"
#include "studies/report/claims.h"
#include "studies/report/measures.h"
#include "studies/report/plot_script.h"
#include "studies/report/progress.h"

namespace palpate::certify {
namespace {

constexpr double kPressed = 0.3;  // of the force at rest, that the real processes must give
constexpr double kFeltWithin = 60, kPress = 0.5, kHoldFor = 5.1;  // [s]
constexpr double kWallShare = 0.5;  // of the formula's stiffness: well within

constexpr std::chrono::milliseconds kLookAgain{500};

class Certifying {
 public:
  Certifying(const CertifyOptions& options, Subject subject, report::Claims& claims,
             KeepGoing keep_going, std::ostream& out, std::ostream& log)
      : options_(options),
        subject_(std::move(subject)),
        store_(shared_folder(options), told(options, subject_)),
        claims_(claims),
        keep_going_(std::move(keep_going)),
        out_(out),
        log_(log) {}

  /// Where shards leave what they measured.
  static std::filesystem::path shared_folder(const CertifyOptions& options) {
    return options.out / "points";
  }

  void measure() {
    // What the organ holds is needed by the others: a shard waits for whoever measures it.
    const auto alone = group("organ alone", [&] { organ_alone(); });
    while (measure_groups({alone}).elsewhere > 0) {
      keep_going_();
      std::this_thread::sleep_for(kLookAgain);
    }
    std::vector<report::Point> points{group("walls", [&] { walls(); }),
                                      group("pressed", [&] { pressed(); }),
                                      group("slid", [&] { slid(); })};
    for (const Disturbance& d : disturbances(options_.quick)) {
      points.push_back(group("link " + d.name(), [this, d] {
        begin("link: " + d.name());
        add(disturbance_lines(subject_, d, push_, keep_going_, now_.troubles));
      }));
    }
    if (!options_.lockstep) {
      points.push_back(group("real processes", [&] { real_processes(); }));
      points.push_back(group("beside others", [&] { beside_others(); }));
    }
    measure_groups(points);
    contacts();
    certificate_.complete = true;
  }

  const report::Share& share() const { return share_; }

  /// @return whether all passed
  bool write() {
    certificate_.lines.insert(certificate_.lines.end(), now_.lines.begin(), now_.lines.end());
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
  /// What its results depend on.
  static std::string told(const CertifyOptions& options, const Subject& subject) {
    std::string text = fmt::format("{} {} depth {} speed {} {} quick {}", runtime::version_text(),
                                   scene::scene_digest(subject.scene), options.depth, options.speed,
                                   options.lockstep, options.quick);
    for (const auto& organ : subject.assets.organs) {
      for (const Vec3& node : organ.surface.nodes) {
        for (const double x : node) text += fmt::format(" {}", x);
      }
    }
    return fmt::format("{:016x}", std::hash<std::string>{}(text));
  }

  /// Lines that belong together, as one point. They are of the certificate once they are read.
  report::Point group(const std::string& name, std::function<void()> measure) {
    const auto read = [this, name] {
      const auto here = measured_.find(name);
      GroupResult result;
      const bool is_here = here != measured_.end();
      if (is_here) result = here->second;
      if (!is_here && !store_.read(name, result)) return false;
      take(result, is_here);
      return true;
    };
    return {store_.key(name), read, [this, name, measure = std::move(measure)] {
              now_ = {};
              measure();
              if (options_.shard) store_.write(name, now_);
              measured_[name] = std::exchange(now_, {});
            }};
  }

  void take(const GroupResult& result, bool printed) {
    if (result.push > 0) push_ = result.push;
    troubles_ += result.troubles;
    for (const Line& line : result.lines) {
      if (!printed) out_ << text_of(line) << std::endl;
      certificate_.lines.push_back(line);
    }
  }

  report::Share measure_groups(const std::vector<report::Point>& points) {
    const report::Share share = report::measure_points(points, claims_);
    share_.measured += share.measured;
    share_.stored += share.stored;
    share_.elsewhere = share.elsewhere;
    return share;
  }

  void organ_alone() {
    begin("law");
    const auto law = measure_law(subject_, keep_going_, now_.troubles);
    write_law(law, options_.out);
    add(law_lines(law));
    begin("force");
    const auto forces =
        measure_still_force(loop_on_organ(subject_, &now_.troubles), subject_, keep_going_);
    write_still_force(forces, options_.out);
    add({still_force_line(forces)});
    now_.push = forces.empty() ? 0 : std::max(0.0, forces.back().organ);
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
    const Loop loop = loop_on_organ(subject_, &now_.troubles);
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
    if (!path.empty()) ticks = slide(loop_on_organ(subject_, &now_.troubles), path, keep_going_);
    write_slide(ticks, options_.out);
    add({slide_line(ticks)});
  }

  void contacts() {
    const auto line = [&](const char* name, std::uint64_t count) {
      add({at_most("contacts", {name, static_cast<double>(count), 0, "", "none may be", ""})});
    };  // write() takes what stands in now_
    line("searches truncated", troubles_.truncated);
    line("searches with the probe inside without contact", troubles_.lost);
    line("steps not solved", troubles_.unsolved);
  }

  void real_processes() {
    begin("timing");
    certificate_.machine = report::machine_name();
    Processes processes(subject_, options_.bus, options_.out, keep_going_);
    measure_alone(processes);
    now_.troubles += processes.contact_troubles();
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
    now_.troubles += processes.contact_troubles();
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
      now_.lines.push_back(line);
    }
  }
  long count(Verdict verdict) const {
    return std::count_if(certificate_.lines.begin(), certificate_.lines.end(),
                         [&](const Line& line) { return line.verdict == verdict; });
  }

  const CertifyOptions& options_;
  Subject subject_;
  GroupStore store_;
  report::Claims& claims_;
  KeepGoing keep_going_;
  std::ostream& out_;
  std::ostream& log_;
  Certificate certificate_;
  GroupResult now_;                              ///< of the group that is measured
  std::map<std::string, GroupResult> measured_;  ///< here
  report::Share share_;
  ContactTroubles troubles_;  ///< of all sessions, the real processes' too
  double push_ = 0;           ///< what the organ holds at the depth of presses [N]
};

}  // namespace

int run_certify(const CertifyOptions& options, const std::function<bool()>& stop, std::ostream& out,
                std::ostream& log) {
  if (options.shard && !options.lockstep) {
    throw InputError("--shard needs --lockstep: times are of one machine");
  }
  report::Claims claims(Certifying::shared_folder(options) / "claims", options.shard);
  const KeepGoing keep_going = [&] {
    if (stop()) throw report::Stopped{};
    claims.keep();
  };
  Subject subject = load_subject(options.scene, keep_going);
  subject.depth = options.depth;
  subject.speed = options.speed;
  report::make_out_folder(options.out);
  Certifying certifying(options, std::move(subject), claims, keep_going, out, log);
  try {
    certifying.measure();
  } catch (const report::Stopped&) {
    if (!options.shard) certifying.write();
    return report::kExitStopped;
  }
  if (options.shard) {
    out << report::text_of(certifying.share(), *options.shard);
    return kExitDone;
  }
  return certifying.write() ? kExitDone : kExitFailed;
}

}  // namespace palpate::certify
