#include "physics/advice/advice_case.h"

#include <fmt/format.h>

#include <algorithm>

namespace sluice::advice {

namespace {

const char* const loading_sentence = "Time within which the load comes, and stays.";
const char* const frequency_sentence = "Frequency at which the load goes to and fro.";

const Schema<StageCase>& stage_schema() {
  static const auto schema =
      Schema<StageCase>("stage")
          .quantity("loading_time", &StageCase::loading_time, unit::time, above(0), loading_sentence)
          .quantity("frequency", &StageCase::frequency, unit::rate, above(0), frequency_sentence);
  return schema;
}

const Schema<PoresCase>& pores_schema() {
  static const auto schema =
      Schema<PoresCase>("pores of a material")
          .quantity("permeability", &PoresCase::permeability, unit::velocity, above(0), "Hydraulic conductivity.")
          .quantity("porosity", &PoresCase::porosity, unit::none, within(0, 1), "Volume of pores per volume.", 0.4)
          .quantity("constrained_modulus", &PoresCase::constrained_modulus, unit::stress, above(0),
                    "Stiffness of the drained soil in confined compression.", Absent{"as in the case"});
  return schema;
}

const Schema<AdviceCase>& schema() {
  using A = AdviceCase;
  static const auto declared =
      Schema<A>("advice")
          .quantity("tolerance", &A::tolerance, unit::none, above_to(0, 0.5),
                    "Error of displacements and pressures that a model may make.", 0.05)
          .quantity("loading_time", &A::loading_time, unit::time, above(0), loading_sentence,
                    Absent{"guessed from the case"})
          .quantity("frequency", &A::frequency, unit::rate, above(0), frequency_sentence,
                    Absent{"guessed from the case"})
          .named_sections("stages", &A::stages, stage_schema(),
                          "Parts of the process, in the place of one loading time or frequency: the most demanding "
                          "one counts.")
          .named_sections("materials", &A::materials, pores_schema(),
                          "What `physics: total_stress` does not know of its saturated materials, by name.")
          .quantity("water_density", &A::water_density, unit::density, above(0),
                    "For the same: density of the water, which is part of that of the material.", 1000.0)
          .quantity("water_bulk_modulus", &A::water_bulk_modulus, unit::stress, above(0),
                    "Bulk modulus of the water where the case gives none.", 2.2e9)
          .kept({.name = "verdict",
                 .type = "map",
                 .default_text = "none",
                 .sentence = "Written by `physics: auto` into the resolved case: what it took, and why."},
                &A::verdict);
  return declared;
}

void check_stages(const AdviceCase& advice, const Node& section, Problems& problems) {
  const auto place = [&](const char* key) { return section.find(key)->place; };
  if (advice.loading_time && advice.frequency)
    problems.add(place("frequency"), "advice: give loading_time or frequency, or stages with one of them each");
  if (!advice.stages.empty() && (advice.loading_time || advice.frequency))
    problems.add(place("stages"), "advice: stages take the place of loading_time and frequency; leave these out");
  for (const StageCase& stage : advice.stages)
    if (stage.loading_time.has_value() == stage.frequency.has_value())
      problems.add(stage.place, fmt::format("advice.stages.{}: give one of loading_time, frequency", stage.name));
}

void check_materials(const AdviceCase& advice, const Case& definition, Problems& problems) {
  std::vector<std::string> names;
  for (const auto& [name, material] : definition.materials) names.push_back(name);
  for (const PoresCase& pores : advice.materials) {
    const auto found = std::ranges::find(names, pores.name);
    if (found == names.end())
      problems.add(pores.place, fmt::format("advice.materials: unknown material '{}'; {}", pores.name,
                                            allowed_words(pores.name, names)));
    else if (definition.physics != "total_stress")
      problems.add(pores.place, fmt::format("advice.materials.{}: the physics {} reads `water` of the material; leave "
                                            "this out",
                                            pores.name, definition.physics));
  }
}

}  // namespace

AdviceCase read_advice(const Case& definition) {
  Problems problems;
  AdviceCase advice = schema().read(definition.advice, {}, problems);
  check_stages(advice, definition.advice, problems);
  check_materials(advice, definition, problems);
  problems.throw_if_any();
  return advice;
}

FieldDoc advice_doc() {
  return {.name = "advice",
          .type = field_type::section,
          .default_text = "guessed from the case",
          .sentence = "Top-level section of the case: what `sluice check` and `physics: auto` judge it by.",
          .nested = schema().docs()};
}

}  // namespace sluice::advice
