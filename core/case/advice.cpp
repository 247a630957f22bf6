#include "core/case/advice.h"

namespace sluice {

Registry<Advisor>& advisor_registry() {
  static Registry<Advisor> registry("advisor", "");  // no plural: nothing that a case file could name
  return registry;
}

}  // namespace sluice
