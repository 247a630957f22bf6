/// What `sluice check` says: plain lines, each with a word in front.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/simulation/progress.h"
#include "physics/advice/judgement.h"

namespace sluice::advice {

namespace {

/// Cells across a layer below which its deformation is mostly that of the scheme: docs/advisor.md.
constexpr double cells_across = 4;
/// A Poisson ratio from which linear and quadratic functions lock.
constexpr double nearly_incompressible = 0.45;

std::string percent(double share) {
  if (share >= 10) return "beyond 1000 %";
  return share < 5e-5      ? "0 %"
         : share >= 0.0995 ? fmt::format("{:.0f} %", 100 * share)
                           : fmt::format("{:.2g} %", 100 * share);
}

std::string line(const std::string& word, const std::string& text) { return fmt::format("{:<16}{}", word, text); }

std::string where(const Demand& demand) {
  return demand.material.empty() ? "free water" : fmt::format("'{}', {}", demand.material, demand.stage);
}

class Lines {
 public:
  Lines(const Judgement& judgement, const Case& definition)
      : judgement_(judgement), scene_(judgement.scene), case_(definition) {}

  std::vector<std::string> all() {
    say_model();
    say_dimension();
    say_cells();
    say_scheme();
    return std::move(lines_);
  }

 private:
  void add(const std::string& word, const std::string& text) { lines_.push_back(line(word, text)); }

  // ---- the model ----

  void say_model() {
    if (!scene_.any_wet()) {
      say_dry();
      return;
    }
    const double tolerance = scene_.asked.tolerance;
    const auto& choices = judgement_.choices;
    const Choice& best = choices[judgement_.taken];
    const std::size_t own = judgement_.own.value_or(judgement_.taken);
    const std::string inertia = judgement_.inertia_matters ? "" : "; inertia has no part in what the water does";
    if (const std::string too_little = shortcoming(judgement_); !too_little.empty()) {
      add("WARNING", too_little);
    } else if (own != judgement_.taken && choices[own].cost() > 1.1 * best.cost()) {
      add("model", fmt::format("the case models more than it needs: {} is within {}, too (error {}), and takes {:.2g} "
                               "times less time{}",
                               best.name, percent(tolerance), percent(best.demand.error),
                               choices[own].cost() / best.cost(), inertia));
    } else {
      add("model", fmt::format("{} is the right one within {} (error {}){}", choices[own].name, percent(tolerance),
                               percent(choices[own].demand.error), inertia));
    }
    if (case_.physics == "two_phase" && !judgement_.own)
      add("", fmt::format("the explicit formulation is for comparison; v-w-p is the same model in longer steps"));
    say_simpler(own);
    say_numbers(own);
    say_costs();
    say_unknown();
  }

  /// A simpler model within the tolerance, and why it is not the one to take.
  void say_simpler(std::size_t own) {
    const std::size_t s = judgement_.simplest;
    const Choice& simple = judgement_.choices[s];
    if (s >= own || s == judgement_.taken) return;
    const bool same_physics = case_.physics == "total_stress" && s < 2 && own < 2;
    if (same_physics) return;
    if (!simple.trouble.empty())
      add("", fmt::format("{} would do (error {}), but {}", simple.name, percent(simple.demand.error), simple.trouble));
    else
      add("",
          fmt::format("{} would do (error {}), but sound in its water makes {:.2g} times as many steps", simple.name,
                      percent(simple.demand.error), simple.steps / judgement_.choices[judgement_.taken].steps));
  }

  /// Of what the case gets wrong, or else of why nothing simpler will do.
  const Demand& deciding(std::size_t own) const {
    const auto& choices = judgement_.choices;
    if (!judgement_.adequate(own) || own < 2 || judgement_.simplest != own) return choices[own].demand;
    std::size_t nearest = own - 1;
    for (std::size_t c = 0; c < own; ++c)
      if (choices[c].demand.error < choices[nearest].demand.error) nearest = c;
    return choices[nearest].demand;
  }

  void say_numbers(std::size_t own) {
    const Demand& demand = deciding(own);
    if (demand.material.empty()) return;
    const auto soil = std::ranges::find(scene_.soils, demand.material, &SoilNumbers::name);
    std::string length = std::isfinite(demand.drainage_length)
                             ? fmt::format("water drains over {:.3g} m", demand.drainage_length)
                             : "water cannot leave";
    std::string text = fmt::format("{}{}; '{}': k = {:.3g} m/s, M = {:.3g} MPa, {}", demand.stage,
                                   scene_.guessed_stages ? " (guessed; `advice` may say)" : "", demand.material,
                                   soil->soil.conductivity, soil->soil.modulus / 1e6, length);
    add("load", text);
    const HarmonicGroups& g = demand.column.groups;
    text = fmt::format("drainage Pi1 = {:.2g}, inertia Pi2 = {:.2g}, inertia of the water alone Pi3 = {:.2g}", g.pi_1(),
                       g.pi_2(), g.pi_3());
    if (demand.column.time_factor > 0) text += fmt::format(", c_v t / L2 = {:.2g}", demand.column.time_factor);
    add("", text);
  }

  void say_costs() {
    for (std::size_t c = 0; c < judgement_.choices.size(); ++c) {
      const Choice& choice = judgement_.choices[c];
      const bool total = case_.physics == "total_stress" && c < 2;
      if (total && c != *judgement_.own) continue;
      const std::string cost = choice.dt > 0 ? fmt::format(", step {:.2g} s, {:.0f} steps, about {}", choice.dt,
                                                           choice.steps, duration_text(choice.cost()))
                                             : "";
      const std::string error = percent(choice.demand.error);
      add(c == 0 || (total && c == *judgement_.own) ? "models" : "",
          fmt::format("{:<24}error {}{}{}", choice.name, error, cost,
                      judgement_.own && c == *judgement_.own ? " (the case)" : ""));
    }
  }

  void say_unknown() {
    for (const SoilNumbers& soil : scene_.soils) {
      if (case_.physics != "total_stress" || !soil.wet) continue;
      const double poisson = soil.elasticity.poisson_ratio();
      if (*judgement_.own != 1 || poisson > nearly_incompressible) continue;
      add("", fmt::format("undrained soil keeps its volume; with a Poisson ratio of {:.2g} '{}' does not quite (0.49 "
                          "would)",
                          poisson, soil.name));
      return;
    }
  }

  void say_dry() {
    if (scene_.any_liquid()) return;
    if (case_.physics == "two_phase")
      add("model", "the case models more than it needs: nothing holds water; take `physics: total_stress`");
    else if (scene_.asked.verdict)
      say_verdict();
    else if (scene_.any_unknown() && case_.physics == "total_stress")
      add("model", "total stresses; with advice.materials.NAME.permeability it is judged whether its water may drain");
  }

  /// Of `physics: auto`, where it has made total stresses of the case, which say nothing of water any more.
  void say_verdict() {
    const Node& verdict = scene_.asked.verdict;
    const auto error_of = [&](const std::string& model) {
      const Node* const found = verdict.find(error_key(model));
      return found == nullptr ? "unknown" : percent(std::strtod(found->scalar.c_str(), nullptr));
    };
    const Node* const model = verdict.find("model");
    const std::string taken = model == nullptr ? "" : model->scalar;
    std::string others;
    for (const Choice& choice : judgement_.choices)
      if (choice.name != taken)
        others += fmt::format("{}{} {}", others.empty() ? "" : ", ", choice.name, error_of(choice.name));
    add("model", fmt::format("{} was taken by `physics: auto`: the cheapest within {} (error {})", taken,
                             percent(scene_.asked.tolerance), error_of(taken)));
    add("", "errors of the others: " + others);
  }

  // ---- dimension, cells, scheme ----

  void say_dimension() {
    for (std::size_t i = 0; i < scene_.same_along.size(); ++i) {
      const double cells = scene_.cells_along[i];
      if (case_.dimension() == 3)
        add("dimension", fmt::format("nothing varies along {}: plane strain gives the same with {:.0f} times fewer "
                                     "particles",
                                     scene_.same_along[i], 2 * cells));
      else if (cells > 1.5)
        add("dimension", fmt::format("nothing varies along {}: one cell across gives the same {:.0f} times cheaper",
                                     scene_.same_along[i], cells));
    }
  }

  void say_cells() {
    const Layer* thinnest = nullptr;
    for (const Layer& layer : scene_.layers)
      if (std::isfinite(layer.thickness) && (!thinnest || layer.thickness < thinnest->thickness)) thinnest = &layer;
    if (thinnest == nullptr) return;
    const double cell = *std::ranges::max_element(case_.grid.cell), cells = thinnest->thickness / cell;
    const std::string layer = fmt::format("the thinnest layer, '{}', is {:.3g} m thick: {:.2g} cells",
                                          thinnest->material, thinnest->thickness, cells);
    if (cells > cells_across * 0.99)
      add("cells", fmt::format("{}; cells of {:.2g} m would do", layer, thinnest->thickness / cells_across));
    else
      add("cells", fmt::format("{}, where {:g} are wanted: cells of {:.2g} m", layer, cells_across,
                               thinnest->thickness / cells_across));
  }

  void say_scheme() {
    const SchemeCase& scheme = case_.scheme;
    const std::size_t before = lines_.size();
    const double cell = *std::ranges::min_element(case_.grid.cell);
    const bool crosses = scene_.expected_strain * scene_.height > 0.5 * cell;
    if (scheme.shape == "linear" && crosses)
      add("scheme",
          "linear functions: stresses jump when points cross cells, and here they will; take quadratic_bspline (1.4 "
          "times the time)");
    if (scheme.shape == "linear" && scheme.transfer == "apic")
      add("scheme", "linear functions with APIC are not to be recommended; take flip or tpic, or quadratic_bspline");
    // B-splines carry 5 to 9 % too much (docs/charts, strip_footing), others up to three times the exact load.
    const bool splines = scheme.shape == "quadratic_bspline" || scheme.shape == "cubic_bspline";
    if (!scheme.f_bar && !splines) say_locking();
    if (lines_.size() == before)
      add("scheme", fmt::format("{}, {}, {} suit the case", scheme.shape, scheme.transfer, scheme.stress_update));
  }

  void say_locking() {
    std::string names;
    int count = 0;
    for (const SoilNumbers& soil : scene_.soils) {
      if (soil.liquid) continue;
      const double poisson = soil.elasticity.poisson_ratio();
      const bool flows = soil.strength == Strength::constant && scene_.expected_strain > 1;
      if (poisson > nearly_incompressible || flows) names += fmt::format("{}'{}'", count++ > 0 ? ", " : "", soil.name);
    }
    if (count > 0)
      add("scheme",
          fmt::format("{} {} volume where {} flow{}: `f_bar: true` against locking", names,
                      count == 1 ? "keeps its" : "keep their", count == 1 ? "it" : "they", count == 1 ? "s" : ""));
  }

  const Judgement& judgement_;
  const SceneNumbers& scene_;
  const Case& case_;
  std::vector<std::string> lines_;
};

}  // namespace

std::string shortcoming(const Judgement& judgement) {
  if (!judgement.own || !judgement.scene.any_wet()) return "";
  const Choice& own = judgement.choices[*judgement.own];
  const std::string remedy = judgement.taken != *judgement.own
                                 ? "take " + judgement.choices[judgement.taken].name
                                 : "no other model of the program can take the case: " + judgement.choices[3].trouble;
  if (!own.trouble.empty()) return fmt::format("the case models too little: {}; {}", own.trouble, remedy);
  if (judgement.adequate(*judgement.own)) return "";
  return fmt::format("the case models too little: {} is {} off where {} is asked ({}); {}", own.name,
                     percent(own.demand.error), percent(judgement.scene.asked.tolerance), where(own.demand), remedy);
}

std::vector<std::string> lines(const Judgement& judgement, const Case& definition) {
  return Lines(judgement, definition).all();
}

}  // namespace sluice::advice
