#include "physics/initial_stress/initial_stress.h"

#include "core/case/schema.h"

namespace sluice {

namespace {

const Schema<InitialStress>& schema() {
  using enum InitialStress::Method;
  static const auto declared =
      Schema<InitialStress>("initial_stress")
          .choice("method", &InitialStress::method,
                  {{"none", none}, {"uniform", uniform}, {"elastic_equilibrium", elastic_equilibrium}},
                  "How the stress before the first step is found: none; the same everywhere; or linear-elastic "
                  "equilibrium under "
                  "gravity, stresses kept and displacements dropped.",
                  none)
          .quantities("stress", &InitialStress::stress, unit::stress, any_number, {{4, 6}},
                      "For `uniform`: xx yy zz xy in 2-D, xx yy zz xy yz xz in 3-D, tension positive.", Absent{"none"});
  return declared;
}

}  // namespace

InitialStress read_initial_stress(const Node& section) {
  InitialStress initial = schema().read(section);
  const bool uniform = initial.method == InitialStress::Method::uniform;
  if (uniform && initial.stress.empty())
    throw CaseError(section.place, "initial_stress: `method: uniform` needs `stress: [xx, yy, zz, xy]`");
  if (!uniform && !initial.stress.empty())
    throw CaseError(section.place, "initial_stress: `stress` is for `method: uniform` only");
  return initial;
}

Node resolved(const InitialStress& initial_stress) { return schema().write(initial_stress); }

std::vector<FieldDoc> initial_stress_docs() { return schema().docs(); }

template <int Dim>
void apply_initial_stress(const InitialStress& initial_stress, Scene<Dim>& scene, const Materials<Dim>& materials,
                          const SkeletonLoads<Dim>& loads) {
  switch (initial_stress.method) {
    case InitialStress::Method::none:
      return;
    case InitialStress::Method::elastic_equilibrium:
      elastic_equilibrium(scene, materials, loads);
      return;
    case InitialStress::Method::uniform:
      break;
  }
  if (initial_stress.stress.size() != symmetric_components<Dim>)
    throw CaseError("initial_stress.stress: expected " + std::to_string(symmetric_components<Dim>) + " components in " +
                    std::to_string(Dim) + "-D");
  for (int c = 0; c < symmetric_components<Dim>; ++c)
    for (double& value : scene.particles.columns.values(scene.particles.stress, c))
      value = initial_stress.stress[static_cast<std::size_t>(c)];
}

template void apply_initial_stress<2>(const InitialStress&, Scene<2>&, const Materials<2>&, const SkeletonLoads<2>&);
template void apply_initial_stress<3>(const InitialStress&, Scene<3>&, const Materials<3>&, const SkeletonLoads<3>&);

}  // namespace sluice
