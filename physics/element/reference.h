/// Reference: the same path with controlled error, by the explicit Runge-Kutta methods of ARKODE (SUNDIALS).
#pragma once

#include "physics/element/driver.h"

namespace sluice::element {

/// Integrates the rate equations of the material, which are taken from its own update over tiny strains:
/// docs/element.md. Calls `record` for the same rows as `drive`. Throws CaseError as that, and PhysicsError where no
/// strain rate leads to the given stress or ARKODE gives up.
void integrate_reference(const ElementCase& definition, const Material& material,
                         const std::function<void(const Row&)>& record);

}  // namespace sluice::element
