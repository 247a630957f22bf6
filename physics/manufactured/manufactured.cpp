/// The manufactured solutions as they were published, by the name that a case file gives.
#include "physics/manufactured/manufactured.h"

namespace sluice {
namespace {

const char* const waves = "Standing waves along the axes: a manufactured solution (Wallstedt & Guilkey 2008).";

const bool registered =
    physics_registry<2>().add("manufactured_waves", {waves, {}}, manufactured<2>(exact::AxisAligned<2>{})) &&
    physics_registry<3>().add("manufactured_waves", {waves, {}}, manufactured<3>(exact::AxisAligned<3>{})) &&
    physics_registry<2>().add("manufactured_vortex",
                              {"Rings that turn: a manufactured solution (Kamojjala et al. 2015).", {}},
                              manufactured<2>(exact::Vortex{}));

}  // namespace
}  // namespace sluice
