#include "physics/materials/softening.h"

namespace sluice {

void check_softening(const SofteningKeys& keys) {
  if (!keys.strain && !keys.start)
    throw CaseError(keys.place,
                    "softening: says neither with what strain nor when the strength falls; give `strain`, or `start` "
                    "(with `ramp`), or both");
  if (!keys.strain && keys.reference_width)
    throw CaseError(keys.place, "softening: `reference_width` scales `strain`, which is missing");
  if (!keys.start && keys.ramp > 0)
    throw CaseError(keys.place, "softening: `ramp` begins at `start`, which is missing");
}

Softening::Softening(const SofteningKeys& keys) : reference_width_(keys.reference_width.value_or(0)) {
  if (keys.strain) strain_ = *keys.strain;
  if (keys.start) start_ = *keys.start;
  ramp_ = keys.ramp;
  inverse_strain_ = 1 / strain_;
}

void Softening::set_cell_size(double h) {
  if (reference_width_ > 0) inverse_strain_ = h / (strain_ * reference_width_);
}

double Softening::left_at(double time) const {
  if (time < start_) return 1;
  return ramp_ > 0 ? std::max(0.0, 1 - (time - start_) / ramp_) : 0;
}

}  // namespace sluice
