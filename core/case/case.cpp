#include "core/case/case.h"

#include "core/case/advice.h"
#include "core/case/case_schema.h"
#include "core/case/case_tree.h"
#include "core/case/consistency.h"
#include "core/case/presets.h"

namespace sluice {

namespace {

Case case_of(Node tree, const std::string& file, const std::vector<Override>& overrides) {
  Problems problems;
  Node source = extended(std::move(tree), file);
  apply_overrides(overrides, source, problems);
  Node whole = source;
  apply_preset(whole);
  resolve_files(whole, file, problems);
  Case definition = case_schema().read(whole, {"extends"}, problems);
  definition.file = file;
  definition.source = std::move(source);
  complete_and_check(definition, problems);
  problems.throw_if_any();
  for (const auto& [name, entry] : advisor_registry().entries()) advisor_registry().find(name, {}).complete(definition);
  return definition;
}

}  // namespace

Case load_case(const std::string& file, const std::vector<Override>& overrides) {
  return case_of(read_yaml_file(file), file, overrides);
}

Case parse_case(const std::string& text, const std::string& name, const std::vector<Override>& overrides) {
  return case_of(read_yaml_text(text, name), name, overrides);
}

}  // namespace sluice
