#include "studies/certify/certify_command.h"

#include <spdlog/fmt/fmt.h>

#include <chrono>
#include <map>
#include <optional>
#include <ostream>
#include <thread>
#include <utility>

#include "modules/core/error.h"
#include "modules/runtime/program.h"
#include "modules/scene/scene_file.h"
#include "modules/scene/scene_reader.h"
#include "studies/certify/certificate.h"
#include "studies/certify/disturbance.h"
#include "studies/certify/group_store.h"
#include "studies/certify/law.h"
#include "studies/certify/press.h"
#include "studies/certify/real_processes.h"
#include "studies/certify/slide.h"
#include "studies/certify/stability.h"
#include "studies/certify/still_force.h"
#include "studies/certify/tables.h"
#include "studies/report/claims.h"
#include "studies/report/measures.h"
#include "studies/report/progress.h"

namespace palpate::certify {
namespace {

constexpr double kWallShare = 0.5;  // of the formula's stiffness: well within

constexpr std::chrono::milliseconds kLookAgain{500};

class Certifying {
 public:
  Certifying(const CertifyOptions& options, Subject subject, report::Claims& claims,
             KeepGoing keep_going, std::ostream& out, std::ostream& log)
      : options_(options),
        subject_(std::move(subject)),
        store_(shared_folder(options), told(options, subject_), log),
        claims_(claims),
        keep_going_(std::move(keep_going)),
        out_(out),
        log_(log) {
    certificate_.scope = scope_of(options);
  }

  /// Where shards leave what they measured.
  static std::filesystem::path shared_folder(const CertifyOptions& options) {
    return options.out / "points";
  }

  void measure() {
    // What the organ holds is needed by the others: a shard waits for whoever measures it.
    push_ = options_.push;
    if (push_ == 0 || options_.wants("law")) {
      const auto alone = group("organ alone", [&] { organ_alone(); });
      while (measure_groups({alone}).elsewhere > 0) {
        keep_going_();
        std::this_thread::sleep_for(kLookAgain);
      }
    }
    std::vector<report::Point> points;
    const auto add_group = [&](const char* word, const std::string& name,
                               std::function<void()> measure) {
      if (options_.wants(word)) points.push_back(group(name, std::move(measure)));
    };
    add_group("walls", "walls", [&] { walls(); });
    add_group("press", "pressed", [&] { pressed(); });
    add_group("held", "held", [&] { held(); });
    add_group("slide", "slid", [&] { slid(); });
    for (const Disturbance& d : disturbances(options_.quick)) {
      add_group("link", "link " + d.name(), [this, d] {
        begin("link: " + d.name());
        add(disturbance_lines(subject_, d, push_, keep_going_, now_.troubles));
      });
    }
    if (!options_.lockstep) {
      const auto real = [&] { now_.troubles += measure_real_processes(real_run()); };
      if (options_.wants("timing") || options_.wants("held") || options_.wants("released")) {
        points.push_back(group("real processes", real));
      }
      add_group("beside", "beside others",
                [&] { now_.troubles += measure_beside_others(real_run()); });
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
      draw_pictures(tables_, options_.out);
    } catch (const std::runtime_error& error) {
      log_ << error.what() << std::endl;
    }
    write_page(certificate_, subject_, options_.out);
    out_ << fmt::format(
        "{}: {} lines, {} failed, {} not measured; in {}: certificate.html, "
        "certificate.json\n",
        certificate_.complete ? subject_.scene.name + " certified" + in_brackets() : "incomplete",
        certificate_.lines.size(), count(Verdict::kFail), count(Verdict::kNotMeasured),
        options_.out.string());
    return certificate_.passed();
  }

 private:
  static std::string scope_of(const CertifyOptions& options) {
    std::string scope;
    const auto add = [&](const std::string& word) { scope += (scope.empty() ? "" : ", ") + word; };
    if (options.lockstep) add("in lockstep");
    if (options.quick) add("--quick");
    for (const std::string& part : options.only) add("only " + part);
    return scope;
  }
  std::string in_brackets() const {
    return certificate_.scope.empty() ? "" : " (" + certificate_.scope + ")";
  }

  /// What its results depend on.
  static std::string told(const CertifyOptions& options, const Subject& subject) {
    std::string text =
        fmt::format("{} {} depth {} speed {} push {} {} quick {}", runtime::version_text(),
                    scene::scene_digest(subject.scene), options.depth, options.speed, options.push,
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
      take(name, result, is_here);
      return true;
    };
    return {store_.key(name), read, [this, name, measure = std::move(measure)] {
              now_ = {};
              measure();
              if (options_.shard) store_.write(name, now_);
              measured_[name] = std::exchange(now_, {});
            }};
  }

  void take(const std::string& group, const GroupResult& result, bool printed) {
    static const std::map<std::string, std::vector<std::string>> kTables{
        {"organ alone", {"law", "force"}},
        {"pressed", {"press"}},
        {"held", {"held"}},
        {"slid", {"slide"}},
        {"real processes", {"timing"}}};
    const bool timed = group != "real processes" || options_.wants("timing");
    if (const auto own = kTables.find(group); own != kTables.end() && timed) {
      tables_.insert(tables_.end(), own->second.begin(), own->second.end());
    }
    if (result.push > 0 && options_.push == 0) push_ = result.push;
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
  }

  void held() {
    begin("held");
    const auto held = hold(loop_on_organ(subject_, &now_.troubles), subject_, push_, keep_going_);
    write_ticks(held, options_.out / "held.csv");
    add(held_lines("stability", held));
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

  RealRun real_run() {
    certificate_.machine = report::machine_name();
    return {options_,
            subject_,
            push_,
            keep_going_,
            [this](const std::vector<Line>& lines) { add(lines); },
            log_};
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
  std::vector<std::string> tables_;              ///< that are of it
  GroupResult now_;                              ///< of the group that is measured
  std::map<std::string, GroupResult> measured_;  ///< here
  report::Share share_;
  ContactTroubles troubles_;  ///< of all sessions, the real processes' too
  double push_ = 0;           ///< what the organ holds at the depth of presses [N]
};

}  // namespace

int run_certify(const CertifyOptions& options, const std::function<bool()>& stop, std::ostream& out,
                std::ostream& log) {
  for (const char* part : {"timing", "released", "beside"}) {
    if (options.lockstep && std::ranges::find(options.only, part) != options.only.end()) {
      throw InputError(std::string("--only ") + part +
                       ": is of the real processes; without --lockstep");
    }
  }
  if (options.shard && !options.lockstep) {
    throw InputError("--shard needs --lockstep: times are of one machine");
  }
  report::Claims claims(Certifying::shared_folder(options) / "claims", options.shard);
  const KeepGoing keep_going = [&] {
    if (stop()) throw report::Stopped{};
    claims.keep();
  };
  std::optional<Certifying> certifying;
  try {
    Subject subject = load_subject(scene::scene_file(options.scene), keep_going);
    subject.depth = options.depth;
    subject.speed = options.speed;
    report::make_out_folder(options.out);
    certifying.emplace(options, std::move(subject), claims, keep_going, out, log);
    certifying->measure();
  } catch (const report::Stopped&) {
    if (!certifying) log << "stopped" << std::endl;
    if (certifying && !options.shard) certifying->write();
    return kExitStopped;
  }
  if (options.shard) {
    out << report::text_of(certifying->share(), *options.shard);
    return kExitDone;
  }
  return certifying->write() ? kExitDone : kExitFailed;
}

}  // namespace palpate::certify
