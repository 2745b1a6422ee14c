#include "studies/stability/maps.h"

#include "modules/core/error.h"
#include "modules/scene/models.h"
#include "studies/stability/haptic_loop.h"

namespace palpate::stability {
namespace {

constexpr double kPrecision = 0.01, kQuickPrecision = 0.05;
constexpr double kFineStep = 1e-3;  // of the squeeze whose end is looked at [s]

std::vector<std::string> names_of(bool quick, bool surfaces_alone) {
  std::vector<std::string> names;
  for (const Scheme& scheme : schemes()) {
    if (quick && !scheme.quick) continue;
    if (surfaces_alone && scene::is_solid(scheme.model)) continue;
    names.emplace_back(scheme.name);
  }
  return names;
}

double precision(bool quick) { return quick ? kQuickPrecision : kPrecision; }

Map step_stiffness(bool quick) {
  const auto shapes = std::make_shared<Shapes>();
  Map map{"step_stiffness", names_of(quick, false), {}, {}, 0, {}, {}};
  map.xs = quick ? geometric(1e3, 1e6, 3) : geometric(1e3, 1e7, 9);
  map.ys = geometric(1e-5, 0.1, quick ? 9 : 17);
  map.precision = precision(quick);
  map.attempt = [shapes](const std::string& name, double x, double y, const KeepGoing& keep_going) {
    const Scheme& scheme = scheme_named(name);
    return swing(scheme, shapes->shape_for(scheme), x, y, keep_going);
  };
  map.predict = [shapes](const std::string& name, double x) {
    const Scheme& scheme = scheme_named(name);
    TestBody body(organ_of(scheme, x), shapes->shape_for(scheme));
    return predict(scheme, body);
  };
  return map;
}

Map squeezes(bool quick) {
  const auto shapes = std::make_shared<Shapes>();
  Map map{"squeeze", names_of(quick, false), {0, 0.3, 0.6}, {}, 0, {}, {}};
  if (!quick) map.xs = {0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9};
  map.ys = quick ? geometric(1e-3, 0.03, 4) : geometric(2.5e-4, 0.032, 8);
  map.precision = precision(quick);
  map.attempt = [shapes](const std::string& name, double x, double y, const KeepGoing& keep_going) {
    const Scheme& scheme = scheme_named(name);
    return squeeze(scheme, shapes->shape_for(scheme), x, y, keep_going);
  };
  // From the springs as they are at the end of a fine squeeze; pressure is not counted, nor that
  // plates hold nodes.
  map.predict = [shapes](const std::string& name, double x) {
    const Scheme& scheme = scheme_named(name);
    std::unique_ptr<TestBody> end;
    squeeze(
        scheme, shapes->shape_for(scheme), x, kFineStep, [] {}, &end);
    Prediction prediction = predict(scheme, *end);
    prediction.exact = false;
    return prediction;
  };
  return map;
}

Map probe_speeds(bool quick) {
  const auto shapes = std::make_shared<Shapes>();
  Map map{"probe_speed", names_of(quick, false), {0.1, 0.5, 3}, {}, 0, {}, {}};
  if (!quick) map.xs = geometric(0.01, 3, 7);
  map.ys = quick ? geometric(1e-3, 0.03, 4) : geometric(5e-4, 0.032, 7);
  map.precision = precision(quick);
  map.attempt = [shapes](const std::string& name, double x, double y, const KeepGoing& keep_going) {
    const Scheme& scheme = scheme_named(name);
    return poke(scheme, shapes->shape_for(scheme), x, y, keep_going);
  };
  map.predict = [shapes](const std::string& name, double) {  // before anything touches
    const Scheme& scheme = scheme_named(name);
    TestBody body(poked_ball(scheme), shapes->shape_for(scheme));
    Prediction prediction = predict(scheme, body);
    prediction.exact = false;
    return prediction;
  };
  return map;
}

Map mesh_quality(bool quick) {
  Map map{"mesh_quality", names_of(quick, true), {4, 60, 1000}, {}, 0, {}, {}};
  if (!quick) map.xs = geometric(4, 1000, 7);
  map.ys = geometric(1e-5, 0.03, quick ? 8 : 15);
  map.precision = precision(quick);
  map.attempt = [](const std::string& name, double x, double y, const KeepGoing& keep_going) {
    return swing(scheme_named(name), ball_with_sliver(x), kYoungsModulus, y, keep_going);
  };
  map.predict = [](const std::string& name, double x) {
    const Scheme& scheme = scheme_named(name);
    TestBody body(organ_of(scheme, kYoungsModulus), ball_with_sliver(x));
    return predict(scheme, body);
  };
  return map;
}

struct NamedLoop {
  const char* name;
  Loop loop;
};

const std::vector<NamedLoop>& loops() {
  static const std::vector<NamedLoop> kLoops{
      {"force_1000Hz", {1000, false, false}},        {"force_500Hz", {500, false, false}},
      {"force_1000Hz_passive", {1000, false, true}}, {"force_500Hz_passive", {500, false, true}},
      {"law_1000Hz", {1000, true, false}},           {"law_500Hz", {500, true, false}},
      {"law_1000Hz_passive", {1000, true, true}},    {"law_500Hz_passive", {500, true, true}}};
  return kLoops;
}

const Loop& loop_named(const std::string& name) {
  for (const NamedLoop& each : loops()) {
    if (name == each.name) return each.loop;
  }
  PALPATE_DEMAND(false);
  return loops().front().loop;
}

Map haptic_loop(bool quick) {
  Map map{"haptic_loop", {}, {0.002, 0.01, 0.04}, {}, 0, {}, {}};
  for (const NamedLoop& each : loops()) {
    if (!quick || each.loop.rate == 1000) map.series.emplace_back(each.name);
  }
  if (!quick) map.xs = {0.002, 0.004, 0.01, 0.02, 0.04};
  map.ys = geometric(1, 1e4, quick ? 5 : 13);
  map.precision = precision(quick);
  map.attempt = [](const std::string& name, double x, double y, const KeepGoing& keep_going) {
    return close_loop(loop_named(name), x, y, keep_going);
  };
  map.predict = [](const std::string& name, double x) {
    const Loop& loop = loop_named(name);
    Prediction prediction;
    prediction.value = critical_stiffness(loop, x);
    prediction.exact = !loop.passivity;  // limits and passivity are more than the formula knows
    return prediction;
  };
  return map;
}

}  // namespace

std::vector<Map> maps(bool quick) {
  return {step_stiffness(quick), squeezes(quick), probe_speeds(quick), mesh_quality(quick),
          haptic_loop(quick)};
}

}  // namespace palpate::stability
