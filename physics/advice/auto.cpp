/// The advisor in the program: what `sluice check` says, and `physics: auto`.
#include <fmt/format.h>

#include "core/case/advice.h"
#include "core/simulation/physics_module.h"
#include "physics/advice/advice_case.h"
#include "physics/advice/judgement.h"

namespace sluice::advice {

namespace {

/// Puts the advice in the place of `physics: auto`, before anybody else sees the case.
void complete(Case& definition) {
  read_advice(definition);  // throws where it is wrong, whatever the physics is
  if (definition.physics != "auto") return;
  if (const Node* const formulation = definition.water.find("formulation"))
    throw CaseError(formulation->place, "water.formulation: `physics: auto` chooses it; leave it out");
  const Judgement judgement = judge(definition);
  Case taken = with_choice(definition, judgement.scene, judgement.taken);
  if (!taken.advice) taken.advice = Node::map();
  taken.advice.set("verdict", record(judgement));
  definition = std::move(taken);
}

/// Where nothing is known of water there is nothing to warn of.
std::vector<std::string> warn(const Case& definition) {
  const bool known = definition.physics == "two_phase" || !read_advice(definition).materials.empty();
  if (!known) return {};
  const std::string found = shortcoming(judge(definition));
  return found.empty() ? std::vector<std::string>() : std::vector{found};
}

std::vector<std::string> advise(const Case& definition, const StepCost& cost) {
  if (definition.physics != "total_stress" && definition.physics != "two_phase") return {};
  Judgement judgement = judge(definition);
  if (judgement.scene.any_wet()) measure(judgement, definition, cost);
  return lines(judgement, definition);
}

const char* const summary =
    "Takes the advice of `sluice check`: `two_phase` (u-p or v-w-p) or `total_stress`, whichever is cheapest within "
    "`advice.tolerance`. Materials are written as for `two_phase`, and may say under `undrained` what they are in "
    "undrained total stresses. What was taken, and why, stands in case.resolved.yaml and summary.json.";

std::vector<FieldDoc> keys() {
  return {advice_doc(),
          {.name = "materials.NAME.undrained",
           .type = field_type::section,
           .default_text = "elastic soil and soil without friction get the stiffness of their water",
           .sentence = "The material in undrained total stresses: a whole material, with its model; its density is "
                       "that with water."}};
}

template <int Dim>
bool register_auto() {
  return physics_registry<Dim>().add("auto", {summary, keys}, [](const Case&) -> std::unique_ptr<PhysicsModule<Dim>> {
    throw CaseError("physics: auto is decided when a case is read");
  });
}

const bool registered = register_auto<2>() && register_auto<3>() &&
                        advisor_registry().add("models", {"Which model of water a case needs.", {}},
                                               {.complete = complete, .warn = warn, .advise = advise});

}  // namespace
}  // namespace sluice::advice
