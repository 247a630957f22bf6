/// The keys of a region in a case file.
#pragma once

#include <vector>

#include "core/case/geometry.h"
#include "core/case/schema.h"

namespace sluice {

/// A shape that a region may have.
struct ShapeKey {
  FieldDoc doc;
  void (*read)(Region& region, const Node& node, Problems& problems);
  Node (*write)(const Region& region);
};

const std::vector<ShapeKey>& shape_keys();

/// Reports a section without any of these keys; `what` is its name in messages.
void require_shape(const Node& section, const std::string& what, Problems& problems);

/// Adds the shapes to the schema of something that has a region; `mutable_region` and `constant_region` give it.
template <class T, class Mutable, class Constant>
Schema<T>& with_shapes(Schema<T>& schema, const Mutable& mutable_region, const Constant& constant_region) {
  for (const ShapeKey& key : shape_keys())
    schema.custom(
        key.doc,
        [=, read = key.read](T& object, const Node& node, Problems& problems) {
          read(mutable_region(object), node, problems);
        },
        [=, write = key.write](const T& object) { return write(constant_region(object)); });
  return schema;
}

/// A region that stands alone.
const Schema<Region>& region_schema();

}  // namespace sluice
